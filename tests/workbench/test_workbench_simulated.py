"""The simulation beside a recording: its errors, its start, and what is not computed anew."""

import numpy as np
import pytest

from symhyb.running import simulate as simulate_script
from symhyb.workbench.bench import Bench, current, with_elements, with_value
from symhyb.workbench.simulated import Prepared, begin, fit_start, nrmse, shown_run


def test_the_error_is_that_of_the_definition() -> None:
    recorded = np.array([0.0, 1.0, 2.0, np.nan])
    run = np.array([0.5, 1.5, 2.5, 9.0])
    assert nrmse(recorded, run) == pytest.approx(0.5 / 2.0)
    assert nrmse(recorded, np.array([0.5, 1.5, np.nan, 0.0])) is None
    assert nrmse(np.ones(3), np.ones(3)) is None


def test_a_moved_parameter_is_what_a_model_with_that_value_does(
    bench: Bench, prepared: Prepared
) -> None:
    begun = begin(prepared, bench.model)
    moved = current(with_value(bench, "k", 150.0))
    assert begin(prepared, moved, begun) is begun  # nothing is lowered anew
    shown = shown_run(prepared, moved, begun)
    scenario = begun.scenario
    start = {"x": float(scenario.q[0]), "x'": float(scenario.v[0])}
    run = simulate_script(moved, prepared.recording, start=start)
    (laser,) = shown.sensors
    assert np.allclose(laser.simulated, run.y[:, 0], atol=1e-6 * np.ptp(run.y))
    assert shown.reason == ""


def test_an_element_that_is_off_changes_the_run_and_the_start_stays(
    bench: Bench, prepared: Prepared
) -> None:
    begun = begin(prepared, bench.model)
    off = current(with_elements(bench, ["damper", "shaker"]))
    other = begin(prepared, off, begun)
    assert other is not begun
    shown, filed = shown_run(prepared, off, other), shown_run(prepared, bench.model, begun)
    assert shown.nrmse()["laser"] != pytest.approx(filed.nrmse()["laser"])


def test_a_fitted_start_meets_the_recording_no_worse(bench: Bench, prepared: Prepared) -> None:
    rough = shown_run(prepared, bench.model, begin(prepared, bench.model)).nrmse()["laser"]
    begun = fit_start(prepared, bench.model)
    fitted = shown_run(prepared, bench.model, begun).nrmse()["laser"]
    assert begun.fitted
    assert fitted is not None
    assert rough is not None
    assert fitted <= rough * (1 + 1e-6)
    moved = begin(prepared, current(with_elements(bench, ["spring", "shaker"])), begun)
    assert moved.fitted
    assert np.array_equal(moved.scenario.q, begun.scenario.q)
