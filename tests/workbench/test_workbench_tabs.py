"""What the tabs say, without a browser."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.workbench.bench import Bench, open_bench, with_column, with_elements, with_value
from symhyb.workbench.job import Progress
from symhyb.workbench.lacking import lacking
from symhyb.workbench.results import read_result
from symhyb.workbench.side import Side
from symhyb.workbench.simulated import Prepared, begin, shown_run
from symhyb.workbench.tabs.columns import ColumnsTab
from symhyb.workbench.tabs.diagnosis import DiagnosisTab, asked_sentence, progress_html
from symhyb.workbench.tabs.force import ForceTab, range_table
from symhyb.workbench.tabs.recording import RecordingTab, look_of, look_table
from symhyb.workbench.tabs.results import ResultsTab, result_html
from symhyb.workbench.tabs.simulation import SimulationTab, error_table

Write = Callable[..., Path]


def test_a_recording_is_looked_at_in_its_own_units(rig: dict[str, Path]) -> None:
    bench = open_bench(rig["model"], [rig["second"]])
    look, left = look_of(bench)
    rows = {row[0]: row for row in look_table(look).rows}
    assert set(rows) == {"f", "way [mm]"}
    assert rows["f"][5] == "200 Hz"
    assert left == ()
    tab = RecordingTab()
    tab.show(look, left)
    assert "1000 samples from 0 to 4.995\u00a0s, 200\u00a0Hz, evenly sampled" in tab._said.text
    assert tab._figures.children == []  # nobody looks at it
    tab.draw(True)
    assert len(tab._figures.children) == 1
    tab.clear()
    assert tab._figures.children == []
    with pytest.raises(InputError):
        look_of(with_column(bench, "t", "nothing"))


def test_selects_give_a_channel_its_column(rig: dict[str, Path]) -> None:
    chosen: list[tuple[str, str]] = []
    tab = ColumnsTab(lambda channel, column: chosen.append((channel, column)))
    bench = open_bench(rig["model"], [rig["second"]])
    tab.show(bench)
    laser = tab._selects.children[2]
    assert laser.title == "sensor laser [m]"
    laser.value = "way [mm]"
    assert chosen == [("laser", "way [mm]")]
    tab.show_lines(with_column(bench, "laser", "way [mm]"))
    assert "laser = &#34;way [mm]&#34;" in tab._lines.text


def test_errors_of_the_file_and_as_set(bench: Bench, prepared: Prepared) -> None:
    begun = begin(prepared, bench.model)
    filed = shown_run(prepared, bench.model, begun)
    table = error_table(filed, filed)
    (row,) = table.rows
    assert row[0] == "laser [m]"
    assert row[1] == row[2] != ""
    tab = SimulationTab()
    tab.show(filed, filed, False, 0.0123)
    assert "Simulated in 0.01\u00a0s" in tab._said.text
    assert tab._drawn is not None
    assert np.isnan(tab._drawn.sources[0].data["file"]).all()


def test_a_range_that_is_brushed_is_summed_up(bench: Bench, prepared: Prepared) -> None:
    found = lacking(prepared, bench.model)
    assert range_table(found, None).caption == "ΔF within the whole recording"
    tab = ForceTab()
    tab.show(found)
    tab._select((1.0, 2.0))
    assert "ΔF within 1 … 2 s" in tab._said.text
    assert tab._drawn is not None
    assert len(tab._drawn.sources[0].selected.indices) > 10
    tab._select((98.0, 99.0))
    assert "the whole recording" in tab._said.text
    assert tab._drawn.sources[0].selected.indices == []


def test_the_side_tells_what_was_switched_and_moved(bench: Bench) -> None:
    told: list[object] = []
    side = Side(
        bench,
        lambda number: told.append(number),
        lambda names: told.append(list(names)),
        lambda path, value: told.append((path, value)),
        lambda: told.append("reset"),
        lambda: told.append("fit"),
    )
    side._elements.active = [0, 2]
    k = side._parameters["k"]
    assert k._number.title == "k [N/m]"
    k._slider.value = 180.123456789
    k._number.value = 300.0
    assert told == [["spring", "shaker"], ("k", 180.123), ("k", 300.0)]
    k._slider.update(start=150.0, end=300.0)
    k._slider.value = 299.9  # the step next to what was typed
    assert len(told) == 3
    side.show(with_value(bench, "k", 300.0))
    assert (k._number.value, k._slider.end) == (300.0, 300.0)
    assert not side._reset.disabled
    side.show(bench)
    assert (k._number.value, k._slider.end, side._reset.disabled) == (200.0, 250.0, True)
    assert len(told) == 4  # showing the elements again switches them; values are told nobody


def test_a_diagnosis_says_what_it_would_be_asked(rig: dict[str, Path]) -> None:
    bench = open_bench(rig["model"], [rig["first"], rig["second"]])
    assert asked_sentence(bench, 0) == (
        "Diagnoses the model on 2 recordings; none is left out for a proof."
    )
    changed = with_value(with_elements(bench, ["spring", "shaker"]), "k", 180.0)
    assert asked_sentence(changed, 1) == (
        "Diagnoses the model without damper, with k as set on 1 recording, proven on 1 unseen."
    )


def test_progress_and_ends_are_shown() -> None:
    running = Progress(Path("out"), words="0:03  trying", steps=("0:01  <reading>",))
    assert "0:03  trying" in progress_html(running)
    assert "&lt;reading&gt;" in progress_html(running)
    failed = Progress(Path("out"), "failed", problems=("no such file",))
    assert "no such file" in progress_html(failed)
    tab = DiagnosisTab(lambda unseen: None, lambda: None)
    tab.follow(running)
    assert (tab._start.disabled, tab._stop.disabled) == (True, False)
    tab.follow(failed)
    assert (tab._start.disabled, tab._stop.disabled) == (False, True)


def test_results_are_shown_alone_and_beside_each_other(write_result: Write) -> None:
    one, two = (read_result(write_result(name, friction=f)) for name, f in (("1", 1.5), ("2", 2.5)))
    html = result_html(one, lambda folder: "/secret")
    assert "&lt;b&gt;friction" in html
    assert "Open the report" not in html
    (one.folder / "report.html").write_text("<p>", encoding="utf-8")
    assert 'href="/secret"' in result_html(one, lambda folder: "/secret")
    tab = ResultsTab(lambda folder: "/secret")
    assert not tab._first.visible
    tab.show([one])
    assert "What was found" in tab._tables.text
    tab.show([one, two])
    assert "apart by" in tab._tables.text
    assert tab._right.visible
    tab._second.value = ""
    assert "What was found" in tab._tables.text
    assert not tab._right.visible
