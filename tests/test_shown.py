"""What values look like: one line for a prompt, a short escaped card for a notebook, frames."""

import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from builders import DRIVEN_MASS
from fakes import friction, verdict

import symhyb as sh
from symhyb.discrepancy.results import Measurement, Reestimated
from symhyb.shown import MOST_ROWS, card, counted, safe
from symhyb.units import parse_unit

T = np.linspace(0.0, 1.0, 50)
EVIL = "<script>alert(1)</script>\u001b[31m\u202e"
MODEL = sh.parse_model(DRIVEN_MASS.replace("symhyb = 1", 'symhyb = 1\ntitle = "Driven mass"'))
MACHINE = sh.build(MODEL)
RUN = sh.Recording.from_frame({"t": T, "f": T, "laser": 1 - T}, MODEL, name="run")


class Tags(HTMLParser):
    """The tags of a text that are open, and all that came."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()
        self.cells: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)
        self.seen.add(tag)
        assert {name for name, _ in attrs} <= {"style"}

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.cells.append(data)


def read(html: str) -> Tags:
    """The tags and texts of HTML that is well formed and holds nothing that runs."""
    tags = Tags()
    tags.feed(html)
    assert not tags.open
    assert not tags.seen & {"script", "img", "a", "iframe", "svg"}
    return tags


def test_values_are_one_line_at_a_prompt() -> None:
    assert repr(MODEL) == (
        "<Model 'Driven mass': 1 coordinate (x), 1 input (f), 3 parameters (m, k, d), "
        "3 elements (spring, damper, push), 1 sensor (laser)>"
    )
    damper = "<Element damper: damper on x, damping = d>"
    assert repr(MODEL.elements["damper"]) == damper
    assert repr(MACHINE) == "<Machine 'Driven mass': 1 coordinate, 3 parameters>"
    assert repr(RUN) == "<Recording 'run': 50 samples, 0 … 1 s, 1 input (f), 1 sensor (laser)>"
    assert repr(MODEL.parameters["k"].unit) == "<Unit N/m>"
    assert repr(friction(0.5)) == "<Diagnosis: missing physics; 1 element (found_friction) found>"
    (found,) = friction(0.5).found
    assert repr(found) == "<Found found_friction: friction on q, coulomb = 0.5 ± 0.006 N>"
    assert repr(verdict()).startswith("<Verdict: The windows carry the verdict. 1 unseen recording")
    run = sh.simulate(MODEL, end=1)
    assert repr(run).startswith("<Trajectory of 'Driven mass': 1001 samples, 0 … 1 s, ")
    assert repr(sh.Diagnosis("nothing missing", "")) == "<Diagnosis: nothing missing>"
    gap = sh.compare(MODEL, RUN)
    size = math.sqrt(np.mean(gap.force**2))
    assert repr(gap) == f"<Discrepancy of 'run': 50 samples, RMS of x {size:.4g} N>"


@pytest.mark.parametrize("value", [MODEL, MACHINE, RUN, friction(0.5), verdict()])
def test_cards_are_well_formed_and_short(value: object) -> None:
    html = value._repr_html_()
    assert read(html).cells
    assert len(html) < 10_000


def test_a_card_says_what_the_value_holds() -> None:
    model = read(MODEL._repr_html_()).cells
    assert "spring on x: stiffness = k" in model
    assert "25 ± 0.5 N/m" in model
    machine = read(MACHINE._repr_html_()).cells
    assert "q, v, z, u, t, p" in machine
    record = read(RUN._repr_html_()).cells
    assert record[record.index("laser") :][:4] == ["laser", "m", "0", "1"]
    causes = read(friction(0.5)._repr_html_()).cells
    assert "0.5 ± 0.006 N" in causes
    assert "40 %" in causes
    assert "0.0074" in read(verdict()._repr_html_()).cells


def test_names_of_strangers_are_shown_and_not_obeyed() -> None:
    values = (
        replace(MODEL, title=EVIL, about=EVIL),
        replace(MACHINE, model=replace(MODEL, title=EVIL)),
        sh.Recording(EVIL, T, {}, {EVIL: T}, (EVIL,)),
        replace(friction(), sentence=EVIL, notes=(EVIL,), record_next=EVIL),
        replace(verdict(), carries=EVIL),
        sh.compare(MODEL, replace(RUN, name=EVIL)),
        replace(sh.simulate(MODEL, end=1), reason=EVIL, model=replace(MODEL, title=EVIL)),
    )
    for value in values:
        html = value._repr_html_()
        read(html)
        assert "alert(1)" in html
        assert "\u001b" not in html
        assert "\u202e" not in html


def test_long_things_are_cut_and_counted() -> None:
    html = card("many", rows=[(i,) for i in range(100)], head=("number",), notes=["n"] * 40)
    assert html.count("<tr>") == 1 + MOST_ROWS
    assert "… and 70 more" in html
    assert "40 notes" in html
    assert len(safe("a" * 10_000)) == 300
    assert counted("sensor", []) == "no sensor"
    assert counted("sensor", list("abcdefgh")) == "8 sensors (a, b, c, d, e, f, …)"


def test_a_diagnosis_is_a_table_of_all_that_it_claims() -> None:
    answer = replace(
        friction(0.5),
        parameters=(Reestimated("k", 25.0, 27.0, 0.1, "N/m"),),
        measurement=(Measurement("laser", "gain", 1.02, 0.001, "1"),),
    )
    table = answer.to_frame()
    assert table.shape == (3, 10)
    assert table["what"].tolist() == ["found_friction", "k", "laser"]
    assert table["kind"].tolist() == ["friction", "parameter", "gain"]
    assert table["term"].tolist() == ["coulomb", "k", "gain"]
    assert table["value"].tolist() == [0.5, 27.0, 1.02]
    assert table["sd"].tolist() == [0.006, 0.1, 0.001]
    assert table["unit"].tolist() == ["N", "N/m", "1"]
    assert table["where"].tolist() == ["on q", "", "laser"]
    assert table["was"].tolist()[1] == 25.0
    assert table["share"].tolist()[0] == 0.4
    assert list(sh.Diagnosis("nothing missing", "").to_frame()) == list(table)
    assert answer.measurement["laser"].value == answer.measurement["laser.gain"].value == 1.02
    assert answer.parameters["k"].was == 25.0


def test_a_verdict_is_a_table_of_its_scores() -> None:
    said = verdict(0.05, 0.0074)
    mm = parse_unit("mm")
    said = replace(said, traces=(replace(said.traces[0], units={"position": mm}),))
    table = said.to_frame().set_index(["recordings", "score", "of"])
    assert len(table) == 2 * (2 * 1 + 4 * 2)
    row = table.loc[("holdout", "window_rmse", "position")]
    assert (row["before"], row["after"], row["unit"]) == (0.05, 0.0074, "mm")
    assert table.loc[("train", "force_residual", "q")]["unit"] == "1"
    unknown = replace(said.train, after=replace(said.train.after, free_run_nrmse={}))
    gone = replace(said, train=unknown, holdout=None).to_frame()
    assert gone["after"].dtype == float
    assert gone[gone["score"] == "free_run_nrmse"]["after"].isna().all()


def test_a_trace_is_a_frame_in_the_units_of_its_sensors() -> None:
    trace = replace(verdict().traces[0], units={"position": parse_unit("mm")})
    shown = trace.to_frame()
    names = [f"{s}_{m}" for s in ("position", "speed") for m in ("measured", "before", "after")]
    assert list(shown) == names
    np.testing.assert_allclose(shown["position_before"], 1000 * trace.before["position"])
    np.testing.assert_array_equal(shown["speed_after"], trace.after["speed"])
    assert shown.attrs["units"]["position_after"] == "mm"
    assert shown.attrs["role"] == "holdout"
    assert re.match(r"<Trace 'holdout.csv' \(holdout\): 50 samples, 0 … 1 s", repr(trace))
