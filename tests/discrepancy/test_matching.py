"""Trajectory matching: planted parameters under noise come back with honest deviations."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import damper, oscillator, push, recording, spring
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.discrepancy.fitting.matching import ROUGHLY, fit
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import Cut, lay
from symhyb.judgement import UNEXPLAINED
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

Array = NDArray[np.float64]

M, K, D, B = 1.2, 300.0, 1.5, 2.5
T = np.arange(500) / 100
F = 3 * np.sin(11 * T) + 2 * np.sin(17 * T + 1)
SD = 2e-4  # 1.5 % of the largest place


@cache
def truth() -> Array:
    """The place of a mass on a spring with damping and drag quadratic in speed, by SciPy."""

    def rate(t: float, x: Array) -> list[float]:
        force = np.interp(t, T, F) - K * x[0] - D * x[1] - B * abs(x[1]) * x[1]
        return [x[1], force / M]

    done = solve_ivp(
        rate, (0, T[-1]), [0.01, 0.1], "DOP853", T, rtol=1e-9, atol=1e-11, max_step=0.01
    )
    return np.asarray(done.y[0])


@cache
def rig(*free: str) -> tuple[Machine, WindowModel]:
    model = oscillator(
        {
            "hold": spring("k"),
            "oil": damper("d"),
            "air": {"kind": "drag", "on": "x", "drag": "b"},
            "motor": push("gain*f"),
        },
        {"k": (320.0, "N/m"), "d": (1.0, "N*s/m"), "b": (2.0, "N*s^2/m^2"), "gain": (1.0, "1")},
        inputs={"f": {"unit": "N"}},
    )
    machine = build(model)
    return machine, WindowModel(machine, tuple(machine.column(name) for name in free))


def cut(seed: int, sd: float = SD, length_s: float = 0.8, coloured: float = 0.0) -> Cut:
    noise = sd * np.random.default_rng(seed).normal(size=T.size)
    for i in range(1, T.size):
        noise[i] = coloured * noise[i - 1] + np.sqrt(1 - coloured**2) * noise[i]
    machine, _ = rig("k", "d", "b")
    run = recording(T, {"f": F}, place=truth() + noise)
    windows = lay(run, machine, motion_of(run, machine), length_s)
    assert windows is not None
    return windows


def task(windows: Cut, size: int, **more: object) -> Task:
    unbounded = {
        "lower": np.full(size, -np.inf),
        "upper": np.full(size, np.inf),
        "mean": np.zeros(size),
        "spread": np.full(size, np.inf),
    }
    return Task((windows,), **{"sd": np.array([SD]), **unbounded, **more})  # type: ignore[arg-type]


def fitted(windows: Cut, start: Mapping[str, float] | None = None, **more: object) -> Fit:
    """Fit k, d and b from 320, 1 and 2, or from ``start``."""
    machine, model = rig("k", "d", "b")
    p = machine.values.copy()
    for name, value in (start or {}).items():
        p[machine.column(name)] = value
    return fit(model, task(windows, 3, **more), p)


@cache
def scattered() -> tuple[Array, Array]:
    """Twenty repetitions with new noise: (estimate − truth)/sd and sd, (20, 3)."""
    misses, deviations = [], []
    for seed in range(20):
        found = fitted(cut(seed))
        sd = np.sqrt(np.diag(found.covariance))
        misses.append((found.values - [K, D, B]) / sd)
        deviations.append(sd)
    return np.array(misses), np.array(deviations)


@pytest.mark.slow
def test_planted_values_come_back_within_their_deviations() -> None:
    misses, sd = scattered()
    assert np.mean(np.abs(misses) < 3) > 0.95
    assert np.abs(misses).max() < 4
    assert (sd.mean(axis=0) / [K, D, B]).max() < 0.25


def test_deviations_are_calibrated() -> None:
    misses, _ = scattered()
    scatter = np.sqrt(np.mean(misses**2, axis=0))
    assert np.all((scatter > 0.6) & (scatter < 1.6))


def test_without_noise_the_truth_is_met() -> None:
    """What is left is the error of the steps of the window and of the input between samples."""
    found = fitted(cut(0, sd=0.0), decrease=1e-9)
    assert found.values == pytest.approx([K, D, B], rel=2e-3)
    assert found.reason == ""


def test_the_fit_does_not_depend_on_where_it_starts() -> None:
    windows = cut(1)
    near = fitted(windows, decrease=1e-8)
    far = fitted(windows, {"k": 200.0, "d": 6.0, "b": 0.0}, decrease=1e-8, iterations=40)
    sd = np.sqrt(np.diag(near.covariance))
    assert (far.values - near.values) / sd == pytest.approx(np.zeros(3), abs=0.02)


@pytest.mark.parametrize("k", [50.0, 500.0, 1000.0])
def test_a_start_far_from_the_truth_is_no_obstacle_over_short_windows(k: float) -> None:
    found = fitted(cut(1), {"k": k, "d": 0.0, "b": 0.0}, iterations=40)
    assert found.values[0] == pytest.approx(K, rel=0.01)


def test_chi_squared_of_a_true_model_is_the_number_of_samples() -> None:
    found = fitted(cut(2))
    assert found.count.tolist() == [79, 79, 79, 79, 79, 79]
    assert found.held.tolist() == [False, False, True, False, False, True]
    assert found.train == pytest.approx(4 * 79, rel=0.25)
    assert found.validation == pytest.approx(2 * 79, rel=0.3)
    assert found.scale == pytest.approx(1.0, abs=0.25)
    assert found.correlation < 1.5


def test_a_missing_law_shows_in_chi_squared_on_held_windows_too() -> None:
    machine, model = rig("k", "d")
    p = machine.values.copy()
    p[machine.column("b")] = 0.0
    windows = cut(3)
    without = fit(model, task(windows, 2), p)
    found = fitted(windows)
    assert without.train > found.train + 20
    assert without.validation > found.validation + 5


def test_held_windows_do_not_move_the_values() -> None:
    """They are to judge what the others found; here they show another machine altogether."""
    windows = cut(4)
    y = windows.block.y.copy()
    y[windows.held] *= 1.3
    spoilt = replace(windows, block=replace(windows.block, y=y))
    start = {"k": 200.0, "d": 6.0, "b": 0.0}
    found, other = (fitted(w, start, decrease=1e-8, iterations=40) for w in (windows, spoilt))
    assert other.validation > 10 * found.validation
    sd = np.sqrt(np.diag(found.covariance))
    assert (other.values - found.values) / sd == pytest.approx(np.zeros(3), abs=0.05)


def test_everything_uses_the_held_windows() -> None:
    windows = cut(5)
    some, every = fitted(windows), fitted(windows, everything=True)
    assert not every.held.any()
    assert np.all(np.diag(every.covariance) < np.diag(some.covariance))


def test_initial_states_are_fitted_on_held_windows_too() -> None:
    """χ² of a held window falls to the noise although its start was far off."""
    windows = cut(6)
    off = replace(windows, start=windows.start + np.array([2e-3, 0.05]))
    found = fitted(off)
    assert found.validation == pytest.approx(fitted(windows).validation, rel=0.05)
    (starts,) = found.starts
    assert starts.shape == windows.start.shape
    rows = np.searchsorted(T, windows.block.t[:, 0])
    assert starts[:, 0] == pytest.approx(truth()[rows], abs=4 * SD)


def test_a_held_window_that_was_thrown_off_begins_anew_at_the_measured_motion() -> None:
    """From a start where drag is all that counts, whole steps lead nowhere."""
    windows = cut(6)
    machine, model = rig("k", "d", "b")
    thrown = windows.start + np.outer(windows.held, [5.0, 3e3])
    found = fit(model, task(windows, 3), machine.values, [thrown])
    assert found.validation == pytest.approx(fitted(windows).validation, rel=1e-3)


def test_missing_samples_are_left_out() -> None:
    windows = cut(7)
    y = windows.block.y.copy()
    y[:, 20:40] = np.nan
    holed = replace(windows, block=replace(windows.block, y=y))
    found = fitted(holed)
    assert found.count.tolist() == [59] * 6
    miss = (found.values - [K, D, B]) / np.sqrt(np.diag(found.covariance))
    assert np.abs(miss).max() < 4


def test_bounds_are_kept_and_the_rest_is_fitted() -> None:
    windows = cut(8)
    lower, upper = np.array([0.0, 0.0, 0.0]), np.array([280.0, 10.0, 10.0])
    found = fitted(windows, lower=lower, upper=upper)
    assert found.values[0] == pytest.approx(280.0)
    assert np.all((found.values >= lower) & (found.values <= upper))
    assert not found.reason


def test_a_prior_pulls_and_narrows() -> None:
    windows = cut(9)
    free = fitted(windows, decrease=1e-8)
    sd = np.sqrt(np.diag(free.covariance))
    prior = {"mean": free.values + sd, "spread": np.array([np.inf, sd[1], np.inf])}
    held = fitted(windows, **prior, decrease=1e-8)
    assert 0.3 < (held.values[1] - free.values[1]) / sd[1] < 0.7
    assert np.sqrt(held.covariance[1, 1]) < 0.85 * sd[1]


def test_coloured_residuals_widen_the_deviations() -> None:
    white, red = fitted(cut(10)), fitted(cut(10, coloured=0.8))
    assert red.correlation > 3
    assert red.covariance[0, 0] > 2 * white.covariance[0, 0]


def test_a_sensor_that_is_noisier_than_stated_widens_the_deviations() -> None:
    honest, proud = (fitted(cut(11, sd=4 * SD), sd=np.array([sd])) for sd in (4 * SD, SD))
    assert proud.scale == pytest.approx(16, rel=0.3)
    ratio = np.sqrt(np.diag(proud.covariance) / np.diag(honest.covariance))
    assert ratio == pytest.approx(np.ones(3), rel=0.25)


def test_numbers_that_the_data_cannot_tell_apart_are_uncertain() -> None:
    """Mass, stiffness, damping, drag and gain of the motor may all be multiplied by one number."""
    machine, model = rig("m", "k", "d", "b", "gain")
    found = fit(model, task(cut(12), 5), machine.values)
    sd = np.sqrt(np.diag(found.covariance))
    assert np.all(sd > found.values)


def test_what_the_data_do_tell_is_found_beside_what_they_cannot() -> None:
    machine, model = rig("m", "k", "d", "b", "gain")
    m, k, d, _, gain = fit(model, task(cut(12), 5), machine.values).values
    assert k / m == pytest.approx(K / M, rel=0.005)
    assert d / m == pytest.approx(D / M, rel=0.2)
    assert gain / m == pytest.approx(1 / M, rel=0.01)


def test_a_machine_without_free_parameters_fits_only_its_states() -> None:
    machine, model = rig()
    p = machine.values.copy()
    for name, value in (("k", K), ("d", D), ("b", B)):
        p[machine.column(name)] = value
    found = fit(model, task(cut(13), 0), p)
    assert found.values.shape == (0,)
    assert found.covariance.shape == (0, 0)
    assert found.train == pytest.approx(4 * 79, rel=0.25)


def test_several_recordings_are_fitted_together() -> None:
    machine, model = rig("k", "d", "b")
    one, two = cut(14), cut(15)
    both = fit(model, replace(task(one, 3), cuts=(one, two)), machine.values)
    assert len(both.starts) == 2
    assert both.chi2.shape == (12,)
    single = fit(model, task(one, 3), machine.values)
    assert np.diag(both.covariance) / np.diag(single.covariance) == pytest.approx(
        np.full(3, 0.5), rel=0.3
    )


def test_a_start_from_which_the_simulation_explodes_fails_with_a_reason() -> None:
    windows = cut(16)
    machine, model = rig("k", "d", "b")
    found = fit(model, task(windows, 3), machine.values, [np.full((6, 2), 1e200)])
    assert "without bound" in found.reason
    assert np.isinf(found.chi2).all()
    assert np.isinf(found.covariance).all()
    assert found.count.shape == found.held.shape == (6,)


def test_a_rough_fit_ends_where_a_tenth_of_a_piece_is_left_and_no_sooner_at_the_noise() -> None:
    """Without drag the fit leaves far more than noise; with it nothing is rough."""
    windows = cut(3)
    for free in (("k",), ("k", "d", "b")):
        machine, model = rig(*free)
        p = machine.values.copy()
        if "b" not in free:
            p[machine.column("b")] = 0.0
        careful = fit(model, task(windows, len(free)), p)
        rough = fit(model, task(windows, len(free), rough=True), p)
        if "b" in free:
            np.testing.assert_array_equal(rough.values, careful.values)
        else:
            assert careful.scale > 2 * UNEXPLAINED
            assert careful.train <= rough.train <= (1 + 2 * ROUGHLY) * careful.train
