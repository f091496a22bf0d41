"""How long a report takes in a browser until it can be used, and how large it is."""

import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from timing import Row, milliseconds

DEMO = Path(__file__).parents[1] / "oscillator" / "study.toml"
NEXT_FRAME = "() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)))"
"""Resolves once scripts that were waiting have run and a frame is drawn: input is answered then."""


def rows(repeats: int = 7) -> list[Row]:
    """The page of the demonstration in Chromium; needs Playwright and a Chromium on the PATH.

    Raises:
        FileNotFoundError: no Chromium.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "symhyb", "run", str(DEMO), "-o", folder]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        if ended.returncode not in (0, 1):  # 1: a mismatch was found
            raise RuntimeError(ended.stderr)
        page = Path(folder) / "report.html"
        empty = Path(folder) / "empty.html"
        empty.write_text("<!doctype html><title>empty</title>", encoding="utf-8")
        taken, nothing = opened(page, repeats), opened(empty, repeats)
        size = page.stat().st_size / 1e6
    part = "report of the demonstration"
    note = f"median of {repeats}, each in a new tab; an empty page {milliseconds(nothing)}"
    return [
        Row(part, "time in Chromium until it answers", taken, 2.0, False, " s", note),
        Row(part, "its size", size, 6.0, False, " MB"),
    ]


def opened(page: Path, repeats: int) -> float:
    """Median time in s from the address to the first frame after everything has loaded."""
    from playwright.sync_api import sync_playwright

    program = next(
        filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None
    )
    if program is None:
        raise FileNotFoundError("a Chromium is needed on the PATH")
    times = []
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        for _ in range(repeats):
            tab = browser.new_page(viewport={"width": 1280, "height": 900})
            start = time.perf_counter()
            tab.goto(page.as_uri(), wait_until="load")
            tab.evaluate(NEXT_FRAME)
            times.append(time.perf_counter() - start)
            tab.close()
        browser.close()
    return statistics.median(times)
