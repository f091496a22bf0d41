"""The report page: parses, needs nothing from outside, escapes names, says things in order."""

import re
from base64 import b64encode
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from hashlib import sha256
from html.parser import HTMLParser

import pytest
from made_results import ALL_VERDICTS, CASES

from symhyb.discrepancy.results import Diagnosis, Estimate, Verdict
from symhyb.model.types import Between, Model, On
from symhyb.report import render_page
from symhyb.report.embed import library
from symhyb.report.tables import place_units

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
PageOf = Callable[[str], tuple[str, "Page"]]
VOID = frozenset({"meta", "img", "br", "input"})
DIFFERENCE = "--- a.toml\n+++ b.toml\n [elements.motor]\n+[elements.found_drag]\n-k = 980\n"


class Page(HTMLParser):
    """What a browser sees: text, headings, images; fails where tags do not match."""

    def __init__(self, html: str):
        super().__init__()
        self.open: list[str] = []
        self.seen: list[str] = []
        self.attributes: list[tuple[str, str, str | None]] = []
        self.texts: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)
        self.attributes += [(tag, name, value) for name, value in attrs]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"style", "script"} & {*self.open}:
            self.texts.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.texts).replace("\u00a0", " ").split())

    def values(self, tag: str, name: str) -> list[str | None]:
        return [value for at, key, value in self.attributes if (at, key) == (tag, name)]


def rendered(case: tuple[Diagnosis, Verdict], model: Model | None) -> tuple[str, Page]:
    made_from = {"model": "emps.toml", "SHA-256": "ab" * 32}
    html = render_page("Slide & rail", *case, DIFFERENCE, made_from, model)
    return html, Page(html)


@pytest.fixture(scope="module")
def page_of(model: Model) -> PageOf:
    """The page of each synthetic result, rendered once."""
    return cache(lambda name: rendered(CASES[name](), model))


@pytest.mark.parametrize("name", ALL_VERDICTS)
def test_every_verdict_makes_a_page_that_needs_nothing_else(name: str, page_of: PageOf) -> None:
    html, page = page_of(name)
    assert "link" not in page.seen
    assert not page.values("script", "src")
    html = html.replace(library(), "")  # which the policy keeps from all other places
    assert "http://" not in html
    assert "https://" not in html
    assert "url(" not in html
    assert "@import" not in html
    assert all(value and value.startswith("data:image/") for value in page.values("img", "src"))
    assert not page.values("a", "href")


@pytest.mark.parametrize("name", ALL_VERDICTS)
def test_every_verdict_is_accessible(name: str, page_of: PageOf) -> None:
    _, page = page_of(name)
    assert page.seen.count("h1") == 1
    assert all(len(alternative or "") > 20 for alternative in page.values("img", "alt"))
    assert len(page.values("img", "alt")) == page.seen.count("img")
    assert page.values("html", "lang") == ["en"]
    assert set(page.values("th", "scope")) <= {"col"}


def test_sentences_come_first_then_pictures_then_tables(page_of: PageOf) -> None:
    html, page = page_of("missing")
    order = [
        "Missing physics",
        "On q the model lacks",
        "What was found",
        "cannot tell apart",
        "Record next",
        "How well the model simulates",
        "What is left",
        "Measured and simulated",
        "The force that the model leaves over",
        "Numbers",
        "Found effects",
        "Scores before and after",
        "Map of the mismatch",
        "What changes in the model file",
        "What was handled",
        "How it was decided",
        "Made from",
    ]
    text = page.text[page.text.index("Slide & rail", 20) :]
    positions = [text.index(words) for words in order]
    assert positions == sorted(positions)
    assert html.index("<img") < html.index("<table")


def test_values_are_given_with_deviation_and_unit(page_of: PageOf) -> None:
    _, page = page_of("missing")
    assert "20.41 ± 0.12 N" in page.text
    assert "203.4 ± 1.3 N·s/m" in page.text
    assert "0.0123 mm" in page.text  # noise in the unit of the sensor
    assert "0.02 to 0.24 m" in page.text
    assert "carry the verdict" in page.text


def test_lines_of_the_difference_are_marked(page_of: PageOf) -> None:
    html, _ = page_of("missing")
    assert '<span class="plus">+[elements.found_drag]</span>' in html
    assert '<span class="minus">-k = 980</span>' in html
    assert '<span class="place">--- a.toml</span>' in html


def test_hostile_names_stay_text(page_of: PageOf) -> None:
    html, page = page_of("hostile")
    assert "<script>alert" not in html
    assert page.seen.count("script") == 3
    assert "<script>alert('x')</script>" in page.text


def test_nothing_runs_but_the_scripts_of_the_page(page_of: PageOf) -> None:
    html, page = page_of("hostile")
    (policy,) = [one for one in page.values("meta", "content") if one and "default-src" in one]
    held = policy.split("script-src ")[1].split()
    bodies = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    hashes = [b64encode(sha256(body.encode()).digest()).decode() for body in bodies]
    assert held == [f"'sha256-{one}'" for one in hashes]
    assert len(held) == 2
    assert "default-src 'none'" in policy
    assert not [name for _, name, _ in page.attributes if name.startswith("on")]


def test_a_page_without_figures_over_time_has_no_script(cases: Cases, model: Model) -> None:
    diagnosis, verdict = cases["undecided"]()
    html, page = rendered((diagnosis, replace(verdict, traces=())), model)
    assert "script" not in page.seen
    assert "script-src &#39;none&#39;" in html


def test_every_figure_over_time_is_there_without_scripts_too(page_of: PageOf) -> None:
    _, page = page_of("missing")
    kinds = page.values("figure", "class")
    assert kinds.count("still") == 2
    assert kinds.count("also") == 1


def test_nothing_missing_makes_a_short_page(page_of: PageOf) -> None:
    _, page = page_of("null")
    assert "What was found" not in page.text
    assert "unexplained" not in page.text
    assert "No recording was held out" in page.text
    assert "Before is the model as given" not in page.text


def test_failures_are_said(page_of: PageOf) -> None:
    _, page = page_of("failed")
    assert "It stopped at 12 s" in page.text
    assert "could not be computed" in page.text
    assert "in simulation.csv: 1 more measured signals" in page.text
    assert "nan" not in page.text.lower().split()


@pytest.mark.slow
def test_many_signals_are_not_all_drawn_and_that_is_said(cases: Cases, model: Model) -> None:
    diagnosis, verdict = cases["null"]()
    trace = verdict.traces[0]
    many = {f"s{index}": trace.measured["encoder"][:50] for index in range(20)}
    full = replace(trace, t=trace.t[:50], measured=many, before=many, after=many)
    _, page = rendered((replace(diagnosis, clouds=()), replace(verdict, traces=(full,))), model)
    assert "in simulation.csv: 8 more measured signals" in page.text


def test_without_a_model_units_are_said_to_be_si(cases: Cases) -> None:
    _, page = rendered(cases["missing"](), None)
    assert "0.02 to 0.24 SI" in page.text


@pytest.mark.parametrize(
    ("place", "units"),
    [
        (On("q"), ("m", "m/s", "N")),
        (On("phi"), ("rad", "rad/s", "N*m")),
        (Between("anchor", "tip"), ("m", "m/s", "N")),
    ],
)
def test_places_have_the_units_of_their_coordinate(
    place: On | Between, units: tuple[str, str, str], model: Model
) -> None:
    shown = place_units(model, place)
    assert (shown.stretch.text, shown.rate.text, shown.force.text) == units


def test_a_force_of_time_alone_is_drawn_over_time_alone(
    cases: Cases, model: Model, page_of: PageOf
) -> None:
    diagnosis, verdict = cases["missing"]()
    _, page = page_of("missing")
    assert "ΔF on q, over rate and stretch (DATA_EMPS.mat)" in page.text
    assert "The same over time" in page.text
    kinds = {"harmonic": False, "hysteresis": True}
    for kind, over_motion in kinds.items():
        effect = replace(diagnosis.found[0], element=replace(diagnosis.found[0].element, kind=kind))
        bare = replace(verdict, traces=())
        _, page = rendered((replace(diagnosis, found=(effect,)), bare), model)
        assert ("over rate and stretch (DATA_EMPS.mat)" in page.text) == over_motion
        assert ("ΔF on q, over time (DATA_EMPS.mat)" in page.text) != over_motion
    assert "a few cycles" not in page.text  # said in the picture, not beside it


def test_numbers_of_found_effects_are_in_units_that_people_say(cases: Cases, model: Model) -> None:
    diagnosis, verdict = cases["missing"]()
    sine = (
        Estimate("F_a", 1.2, 0.01, "N", "amplitude"),
        Estimate("f_0", 3.7, 0.007, "1/s", "frequency"),
        Estimate("phi_0", 0.6, 0.03, "1", "phase"),
    )
    element = replace(diagnosis.found[0].element, kind="harmonic")
    effect = replace(diagnosis.found[0], element=element, estimates=sine)
    bare = replace(diagnosis, found=(effect,), clouds=())
    _, page = rendered((bare, replace(verdict, traces=())), model)
    assert "3.700 ± 0.007 Hz" in page.text
    assert "0.60 ± 0.03 rad" in page.text
