"""The page in a browser: it draws, zooms, switches, follows the scheme, prints, runs nothing else.

Needs Playwright and a Chromium. `make browser` runs these alone: a browser beside other tests keeps
no time.
"""

import re
import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from made_results import hostile, missing
from moved import moved

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.report import render_page

pytestmark = pytest.mark.browser

SIZE_MOST = 6_000_000  # bytes of a page
PHONE, DESK = {"width": 390, "height": 844}, {"width": 1000, "height": 900}

Open = Callable[..., Any]


def small(case: tuple[Diagnosis, Verdict]) -> tuple[Diagnosis, Verdict]:
    """The same with the first two recordings alone."""
    diagnosis, verdict = case
    return diagnosis, replace(verdict, traces=verdict.traces[:2])


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A sound page, one of hostile names and one with a machine that moves, as files."""
    folder = tmp_path_factory.mktemp("pages")
    written = {}
    for name, case in (("sound", missing()), ("hostile", hostile())):
        written[name] = folder / f"{name}.html"
        written[name].write_text(render_page("Slide & rail", *small(case)), encoding="utf-8")
    diagnosis, verdict, model = moved()
    written["moving"] = folder / "moving.html"
    moving = render_page("Oscillator", diagnosis, verdict, model=model)
    written["moving"].write_text(moving, encoding="utf-8")
    return written


@pytest.fixture
def opened(browser: Any, pages: dict[str, Path]) -> Iterator[Open]:
    """Opens a page, with everything that went wrong in it under ``wrong``."""
    contexts = []

    def begin(name: str, **options: Any) -> tuple[Any, list[str]]:
        context = browser.new_context(**{"viewport": DESK, **options})
        contexts.append(context)
        page, wrong = context.new_page(), []
        page.set_default_timeout(300_000)
        page.on("console", lambda said: wrong.append(said.text) if said.type != "info" else None)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
        page.on(
            "request",
            lambda asked: (
                None if asked.url.startswith(("file:", "data:")) else wrong.append(asked.url)
            ),
        )
        page.goto(pages[name].as_uri(), timeout=300_000)
        return page, wrong

    yield begin
    for context in contexts:
        context.close()


def drawn(page: Any) -> Any:
    """The page when the figures of the first recording are drawn."""
    page.locator(".plots").first.scroll_into_view_if_needed()
    page.wait_for_selector(".recording[data-drawn]")
    return page


def ends(page: Any) -> set[tuple[float, float]]:
    """The ends of the time axes of the first recording."""
    found = page.evaluate(
        "() => [...Bokeh.documents[0].roots()[0].references()]"
        ".filter((one) => one.type === 'Figure')"
        ".map((one) => [one.x_range.start, one.x_range.end])"
    )
    return {(start, end) for start, end in found}


def until(page: Any, holds: Callable[[], bool]) -> None:
    """Wait until something holds. (Playwright's own waiting evaluates text, which pages forbid.)"""
    for _ in range(2400):
        if holds():
            return
        page.wait_for_timeout(50)
    raise AssertionError("it never came")


def test_figures_zoom_together_and_lines_are_switched(opened: Open, pages: dict[str, Path]) -> None:
    assert pages["sound"].stat().st_size < SIZE_MOST
    page, wrong = opened("sound")
    drawn(page)
    assert ends(page) == {(0.0, 24.0)}
    page.locator("[data-zoom=in]").first.click()
    assert ends(page) == {(6.0, 18.0)}
    assert page.locator(".span").first.inner_text() == "6 to 18 s"
    page.locator("[data-zoom=on]").first.click()
    assert ends(page) == {(12.0, 24.0)}
    page.locator("[data-zoom=all]").first.click()
    assert ends(page) == {(0.0, 24.0)}
    box = page.locator(".plots").first.bounding_box()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 90)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 90, steps=4)
    page.mouse.up()
    until(page, lambda: ends(page) != {(0.0, 24.0)})
    ((start, end),) = ends(page)
    assert 6.0 < start < end < 18.0
    shown = (
        "() => [...Bokeh.documents[0].roots()[0].references()].filter((one) =>"
        " one.type === 'GlyphRenderer' && one.name === 'before').map((one) => one.visible)"
    )
    assert set(page.evaluate(shown)) == {True}
    page.locator("[data-line=before]").first.uncheck()
    assert set(page.evaluate(shown)) == {False}
    assert wrong == []


def test_the_page_follows_the_scheme_and_fits_a_phone(opened: Open) -> None:
    page, wrong = opened("sound", viewport=PHONE, color_scheme="dark")
    drawn(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    title = (
        "() => [...Bokeh.documents[0].roots()[0].references()]"
        ".find((one) => one.type === 'Title').text_color"
    )
    line = (
        "() => [...Bokeh.documents[0].roots()[0].references()].find((one) =>"
        " one.type === 'GlyphRenderer' && one.name === 'after').glyph.line_color.value"
    )
    assert (page.evaluate(title), page.evaluate(line)) == ("#e8eaed", "#56b4e9")
    page.emulate_media(color_scheme="light")
    until(page, lambda: page.evaluate(title) == "#1f2933")
    assert page.evaluate(line) == "#0072b2"
    assert wrong == []


def test_print_and_readers_without_scripts_get_still_figures(opened: Open) -> None:
    page, _ = opened("sound", java_script_enabled=False)
    stills = page.locator("figure.still")
    assert stills.count() > 0
    assert all(still.is_visible() for still in stills.all())
    assert not any(plots.is_visible() for plots in page.locator(".plots").all())
    page, wrong = opened("sound")
    drawn(page)
    assert not page.locator("figure.still").first.is_visible()
    sheets = sheets_of(page.pdf(format="A4", print_background=True))
    assert 1 < len(sheets) <= 14
    assert all(re.search(rb"\b(TJ|Tj|Do)\b", sheet) for sheet in sheets)  # text, or a figure
    assert wrong == []


def sheets_of(pdf: bytes) -> list[bytes]:
    """What each sheet of a PDF by Chromium draws."""
    objects = dict(re.findall(rb"\n(\d+) 0 obj\s(.*?)endobj", pdf, re.DOTALL))
    drawn = []
    for text in objects.values():
        if re.search(rb"/Type\s*/Page\b", text):
            number = re.search(rb"/Contents (\d+) 0 R", text)
            assert number is not None
            packed = objects[number[1]].split(b"stream", 1)[1].strip(b"\r\n")
            drawn.append(zlib.decompressobj().decompress(packed))
    return drawn


def test_hostile_names_run_nothing(opened: Open) -> None:
    page, wrong = opened("hostile")
    drawn(page)
    page.evaluate(
        "() => { const s = document.createElement('script'); s.text = 'window.ran = 1';"
        " document.body.append(s); }"
    )
    assert page.evaluate("window.ran") is None
    assert len(wrong) == 1  # the policy refused that script, and nothing else happened
    assert "Content Security Policy" in wrong[0]


def mass(page: Any) -> float:
    """Where the left side of the mass is on the screen."""
    return float(page.locator(".motion svg > polygon.body").first.bounding_box()["x"])


def test_the_machine_is_played_and_stopped_and_moved_by_hand(
    opened: Open, pages: dict[str, Path]
) -> None:
    assert pages["moving"].stat().st_size < SIZE_MOST
    page, wrong = opened("moving", reduced_motion="reduce")
    button, slider = page.locator(".motion button"), page.locator(".motion input")
    clock, ghost = page.locator(".clock"), page.locator(".motion .ghost")
    button.scroll_into_view_if_needed()
    assert (clock.inner_text(), button.inner_text()) == ("0.000 s", "▶ play")
    start = mass(page)
    page.wait_for_timeout(300)
    assert mass(page) == start  # it does not begin by itself
    button.click()
    until(page, lambda: mass(page) != start)
    button.click()
    assert button.inner_text() == "▶ play"
    stopped = clock.inner_text()
    page.wait_for_timeout(200)
    assert clock.inner_text() == stopped
    slider.evaluate("(one) => { one.value = 99.5; one.dispatchEvent(new Event('input')); }")
    assert clock.inner_text() == "5.000 s"
    assert slider.get_attribute("aria-valuetext") == "5.000 s"
    assert mass(page) == pytest.approx(start, abs=1.0)  # after two and a half cycles
    assert ghost.get_attribute("visibility") == "visible"
    slider.press("End")
    assert clock.inner_text() == "10.00 s"
    assert ghost.get_attribute("visibility") == "hidden"  # it stopped before
    button.click()  # from the beginning
    until(page, lambda: 0 < float(clock.inner_text().split()[0]) < 5)
    assert button.inner_text() == "❚❚ pause"
    assert wrong == []


def test_what_moves_has_the_colours_of_the_scheme_and_fits_a_phone(opened: Open) -> None:
    page, wrong = opened("moving", viewport=PHONE, color_scheme="dark")
    page.locator(".motion").scroll_into_view_if_needed()
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    shown = "() => getComputedStyle(document.querySelector('.motion svg > polyline.shown')).stroke"
    assert page.evaluate(shown) == "rgb(231, 154, 194)"
    page.emulate_media(color_scheme="light")
    until(page, lambda: page.evaluate(shown) == "rgb(176, 65, 124)")
    assert wrong == []


def test_print_and_readers_without_scripts_get_the_machine_as_it_stands(opened: Open) -> None:
    page, _ = opened("moving", java_script_enabled=False)
    assert page.locator("figure.motionless").is_visible()
    assert not page.locator("figure.motion").is_visible()
    page, wrong = opened("moving")
    assert page.locator("figure.motion").is_visible()
    assert not page.locator("figure.motionless").is_visible()
    page.emulate_media(media="print")
    assert page.locator("figure.motionless").is_visible()
    assert not page.locator("figure.motion").is_visible()
    assert wrong == []
