"""What the figures of the workbench hold."""

import numpy as np
import pytest

from symhyb.data.look import look_at
from symhyb.data.recording import Recording
from symhyb.workbench.bench import Bench, current, with_value
from symhyb.workbench.figures import (
    CLOUD,
    brushed,
    force_data,
    force_figures,
    recording_figures,
    simulation_data,
    simulation_figures,
    thinned_rows,
)
from symhyb.workbench.lacking import lacking
from symhyb.workbench.simulated import Prepared, begin, shown_run


def test_every_channel_has_its_course_and_its_spectrum() -> None:
    t = np.arange(0.0, 4.0, 0.01)
    sensors = {"$a$": np.sin(2 * np.pi * 5 * t), "still": np.ones(t.size)}
    layout = recording_figures(look_at(Recording("r", t, {}, sensors), {"$a$": "mm"}))
    figures = [figure for row in layout.children for figure in row.children]
    assert [figure.title.text.text for figure in figures] == [
        "$a$ [mm]",
        "power of $a$ [(mm)²]",
        "still",
    ]
    (spectrum,) = figures[1].renderers
    data = spectrum.data_source.data
    assert data["x"][np.argmax(data["y"])] == pytest.approx(5.0, abs=0.5)


def test_a_sensor_is_drawn_measured_simulated_and_apart(bench: Bench, prepared: Prepared) -> None:
    begun = begin(prepared, bench.model)
    filed = shown_run(prepared, bench.model, begun)
    shown = shown_run(prepared, current(with_value(bench, "k", 150.0)), begun)
    drawn = simulation_figures(shown)
    (scale,) = drawn.scales
    (now,), (before,) = shown.sensors, filed.sensors
    data = simulation_data(shown.t, now, before, scale)
    assert np.allclose(data["less"], data["shown"] - data["measured"], atol=1e-5)
    assert np.isfinite(data["file"]).all()
    assert data["t"][0] == shown.t[0]
    assert data["t"][-1] == shown.t[-1]
    assert np.isnan(simulation_data(shown.t, now, None, scale)["file"]).all()


def test_a_brushed_range_marks_its_samples(bench: Bench, prepared: Prepared) -> None:
    (found,) = lacking(prepared, bench.model)
    drawn = force_figures((found,), found.t)
    data = force_data(found, drawn.scales[0])
    marked = brushed(found, (1.0, 2.0))
    assert len(marked) > 10
    assert all(1.0 <= data["t"][i] <= 2.0 for i in marked)
    assert brushed(found, None) == []


def test_clouds_are_thinned_evenly() -> None:
    rows = thinned_rows(100 * CLOUD)
    assert rows.size == CLOUD
    assert (rows[0], rows[-1]) == (0, 100 * CLOUD - 1)
    assert np.ptp(np.diff(rows)) <= 1
    assert thinned_rows(7).tolist() == list(range(7))
