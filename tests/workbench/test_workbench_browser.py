"""The workbench in a browser: moved, brushed, diagnosed; dark, narrow, and with hostile names.

Needs Playwright and a Chromium; `make browser` runs these.
"""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.browser

DESK, PHONE = {"width": 1300, "height": 900}, {"width": 390, "height": 844}
SAID = (
    "() => Bokeh.documents[0].roots().flatMap((root) => [...root.references()])"
    ".filter((one) => one.type === 'Div' && one.visible).map((one) => one.text).join(' ')"
)
EVIL = "<img src=x onerror=alert(1)><script>alert(2)</script>$$x$$"

Open = Callable[..., Any]
Write = Callable[..., Path]


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Open]:
    """Opens a workbench, with everything that went wrong in it under ``wrong``."""
    ends: list[Callable[[], object]] = []

    def begin(*given: object, **options: Any) -> tuple[Any, list[str]]:
        command = [sys.executable, "-m", "symhyb", "view", *map(str, given)]
        server = subprocess.Popen(
            [*command, "-o", str(tmp_path / "out")], stdout=subprocess.PIPE, text=True
        )
        ends.append(lambda: (server.terminate(), server.communicate(timeout=60)))
        assert server.stdout is not None
        address = server.stdout.readline().strip()
        context = browser.new_context(**{"viewport": DESK, **options})
        ends.append(context.close)
        page, wrong = context.new_page(), []
        page.set_default_timeout(300_000)
        page.on(
            "console",
            lambda said: wrong.append(said.text) if said.type in ("error", "warning") else None,
        )
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
        own = address.split("/")[2]
        allowed = (f"http://{own}/", f"ws://{own}/", "data:", "blob:")
        page.on(
            "request",
            lambda asked: None if asked.url.startswith(allowed) else wrong.append(asked.url),
        )
        page.goto(address, timeout=300_000)
        page.wait_for_selector("[data-drawn]", state="attached")
        return page, wrong

    yield begin
    for end in reversed(ends):
        end()


def until(page: Any, holds: Callable[[], bool], most: float = 300.0) -> None:
    """Wait until something holds."""
    end = time.monotonic() + most
    while not holds():
        assert time.monotonic() < end, page.evaluate(SAID)
        page.wait_for_timeout(50)


def says(page: Any, words: str) -> bool:
    return words in page.evaluate(SAID)


def tab(page: Any, name: str) -> None:
    page.locator(".bk-tab", has_text=name).first.click()


def canvas(page: Any) -> dict[str, float]:
    """Where the first figure is that is seen."""
    return next(
        one for one in page.locator(".part-main canvas").all() if one.is_visible()
    ).bounding_box()


def test_a_model_is_moved_switched_and_brushed(opened: Open, rig: dict[str, Path]) -> None:
    page, wrong = opened(rig["model"], rig["first"])
    until(page, lambda: says(page, "Errors (NRMSE)"))
    filed = page.evaluate(SAID)
    number = page.locator(".part-side input[type=text]").nth(1)
    number.fill("150")
    number.press("Enter")
    until(page, lambda: page.evaluate(SAID) != filed)
    handle = page.locator(".noUi-handle").nth(1).bounding_box()
    before = page.evaluate(SAID)
    page.mouse.move(handle["x"] + 7, handle["y"] + 7)
    page.mouse.down()
    page.mouse.move(handle["x"] + 60, handle["y"] + 7, steps=3)
    page.mouse.up()
    until(page, lambda: page.evaluate(SAID) != before)
    page.locator(".part-side input[type=checkbox]").nth(1).uncheck()
    tab(page, "Missing force")
    until(page, lambda: says(page, "within the whole recording"))
    until(page, lambda: page.evaluate("() => true") and canvas(page)["width"] > 300)
    box = canvas(page)
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 90)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 90, steps=4)
    page.mouse.up()
    until(page, lambda: not says(page, "within the whole recording"))
    page.get_by_role("button", name="Whole recording").click()
    until(page, lambda: says(page, "within the whole recording"))
    page.get_by_role("button", name="As in the file").click()
    assert wrong == []


def test_a_diagnosis_is_stopped_and_another_ends_with_a_report(
    opened: Open, rig: dict[str, Path], tmp_path: Path
) -> None:
    page, wrong = opened(rig["model"], rig["first"])
    tab(page, "Diagnosis")
    page.get_by_role("button", name="Diagnose").click()
    until(page, lambda: says(page, "reading the model"))
    page.get_by_role("button", name="Stop").click()
    until(page, lambda: says(page, "Stopped"))
    page.get_by_role("button", name="Diagnose").click()
    until(page, lambda: says(page, "Open the report"), 600.0)
    assert (tmp_path / "out" / "1" / "diagnosis.json").is_file()
    with page.context.expect_page() as other:
        page.locator("a", has_text="Open the report").first.click()
    report = other.value
    report.wait_for_selector(".recording[data-drawn]", timeout=300_000)
    assert report.locator("h1").inner_text() != ""
    assert wrong == []


def test_it_is_dark_and_fits_a_phone(opened: Open, rig: dict[str, Path]) -> None:
    page, wrong = opened(rig["model"], rig["first"], viewport=PHONE, color_scheme="dark")
    until(page, lambda: says(page, "Errors (NRMSE)"))
    color = (
        "() => Bokeh.documents[0].roots().flatMap((root) => [...root.references()])"
        ".find((one) => one.type === 'Title')?.text_color"
    )
    until(page, lambda: page.evaluate(color) == "#e8eaed")
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(22, 25, 29)"
    assert wrong == []


def test_hostile_names_run_nothing(
    opened: Open, rig: dict[str, Path], write_result: Write, tmp_path: Path
) -> None:
    text = rig["model"].read_text(encoding="utf-8")
    model = tmp_path / "evil.toml"
    model.write_text(text.replace("mass on a spring, driven", EVIL), encoding="utf-8")
    rows = rig["first"].read_text(encoding="utf-8").splitlines()
    evil = tmp_path / "evil.csv"
    table = [f"{rows[0]},{EVIL}", *(f"{row},1" for row in rows[1:])]
    evil.write_text("\n".join(table) + "\n", encoding="utf-8")
    page, wrong = opened(model, evil)
    until(page, lambda: says(page, "Errors (NRMSE)"))
    for name in ("Missing force", "Recording", "Columns", "Diagnosis", "Results"):
        tab(page, name)
        page.wait_for_timeout(1000)
    assert wrong == []
    folder = write_result("evil", sentence=EVIL, verdict=EVIL, record_next=EVIL)
    steal = "<script>document.title = 'ran'; fetch('http://127.0.0.1:9/')</script>"
    (folder / "report.html").write_text(steal, encoding="utf-8")
    page, wrong = opened(folder)
    until(page, lambda: says(page, "What was found"))
    assert wrong == []
    with page.context.expect_page() as other:
        page.locator("a", has_text="Open the report").first.click()
    other.value.wait_for_load_state()
    address = page.url
    reached = other.value.evaluate(
        "(address) => fetch(address).then(() => 'reached', () => 'refused')", address
    )
    assert reached == "refused"
