"""The page without a browser: what is clicked is computed and shown."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from bokeh.document import Document

from symhyb.workbench.bench import open_bench
from symhyb.workbench.page import Page
from symhyb.workbench.shared import Shared


class Turns(Document):
    """A document whose turns are taken when a test says so."""

    def __init__(self) -> None:
        super().__init__()
        self.waiting: list[Callable[[], None]] = []

    def add_next_tick_callback(self, callback: Callable[[], None]) -> None:  # type: ignore[override]
        self.waiting.append(callback)


def until(document: Turns, holds: Callable[[], bool], most: float = 60.0) -> None:
    """Take turns until something holds."""
    end = time.monotonic() + most
    while not holds():
        assert time.monotonic() < end
        while document.waiting:
            document.waiting.pop(0)()
        time.sleep(0.01)


@pytest.fixture
def opened(rig: dict[str, Path], tmp_path: Path) -> tuple[Page, Turns]:
    """A page of the rig, with the recording that calls its sensor otherwise shown second."""
    bench = open_bench(rig["model"], [rig["first"], rig["second"]])
    document = Turns()
    page = Page(document, Shared(bench, (), tmp_path))
    page.begin()
    until(document, lambda: "Errors (NRMSE)" in page._simulation._said.text)
    return page, document


def test_moving_switching_and_going_back(opened: tuple[Page, Turns]) -> None:
    page, document = opened
    first = page._simulation._said.text.split("Simulated")[0]

    def shown() -> str:
        return page._simulation._said.text.split("Simulated")[0]

    page._side._parameters["k"]._number.value = 150.0
    until(document, lambda: shown() != first)
    moved = shown()
    page._side._elements.active = [0, 2]
    until(document, lambda: shown() not in (first, moved))
    page._tabs.active = page._force_at
    until(document, lambda: "within the whole recording" in page._force._said.text)
    page._reset()
    until(document, lambda: shown() == first)
    assert not page._said.visible


def test_what_is_wrong_is_said_in_the_page_and_mended_there(opened: tuple[Page, Turns]) -> None:
    page, document = opened
    page._chosen(1)
    until(document, lambda: page._said.visible)
    assert "laser" in page._said.text
    page._columns._selects.children[2].value = "way [mm]"
    until(document, lambda: "Errors (NRMSE)" in page._simulation._said.text)
    assert not page._said.visible
    page._close()
    page._moved("k", 120.0)
    time.sleep(0.1)
    assert document.waiting == []


def test_results_alone_need_no_bench(tmp_path: Path) -> None:
    document = Turns()
    Page(document, Shared(None, (), tmp_path)).begin()
    assert [root.name for root in document.roots] == ["main"]
