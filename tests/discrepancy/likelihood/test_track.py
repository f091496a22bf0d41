"""A recording linearised along a trajectory: exact where the machine is linear."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import (
    Extra,
    Track,
    effective,
    log_likelihood,
    showing,
    smoothed,
    track,
    white_forces,
    white_problem,
)
from symhyb.numeric.runs.windows import WindowModel
from tests.pushed import NOISE, STEP, lowered, pushed, task_of

MACHINE = lowered()
NOISY = NoiseModel(np.array([0.3]), 0.2, np.array([NOISE]), np.array([NOISE]), 0.5)
SAMPLES = 120
(ITEM,) = task_of(MACHINE, pushed(1, samples=SAMPLES)).items
STATES = ITEM.states[0]


def test_a_linear_machine_is_as_likely_along_any_trajectory() -> None:
    model = WindowModel(MACHINE)
    measured = log_likelihood(track(model, ITEM, STATES, MACHINE.values), NOISY)
    elsewhere = STATES + np.random.default_rng(2).standard_normal(STATES.shape)
    for states in (np.zeros_like(STATES), elsewhere):
        one = track(model, ITEM, states, MACHINE.values)
        one = replace(one, P0=track(model, ITEM, STATES, MACHINE.values).P0)
        assert log_likelihood(one, NOISY) == pytest.approx(measured, rel=1e-9)


def test_the_columns_tell_what_a_change_of_the_numbers_leaves() -> None:
    """Exactly where the machine is linear in a number (an offset), to second order elsewhere."""
    for path, change, error in (("f.offset", 0.7, 1e-9), ("k", 0.02, 1e-2)):
        column = MACHINE.column(path)
        model = WindowModel(MACHINE, (column,))
        moved = MACHINE.values.copy()
        moved[column] += change
        residual, columns, logs = white_problem(track(model, ITEM, STATES, MACHINE.values), NOISY)
        there, _, as_large = white_problem(track(model, ITEM, STATES, moved), NOISY)
        size = np.abs(there - residual).max()
        assert size > 1e-3
        np.testing.assert_allclose(residual + columns[:, 0] * change, there, atol=error * size)
        assert logs == pytest.approx(as_large, rel=1e-4)


def test_a_force_beside_the_model_is_what_the_input_would_do() -> None:
    model = WindowModel(MACHINE, (MACHINE.column("f.offset"),))
    one = track(model, ITEM, STATES, MACHINE.values)
    _, columns, _ = white_problem(one, NOISY)
    constant = white_forces(one, NOISY, np.ones((SAMPLES, 1, 1)))
    np.testing.assert_allclose(constant, columns, atol=1e-9 * np.abs(columns).max())


def test_extra_columns_act_with_their_sizes() -> None:
    random = np.random.default_rng(4)
    extra = Extra(random.standard_normal((SAMPLES, 1, 2)), random.standard_normal((SAMPLES, 1, 2)))
    model, sizes = WindowModel(MACHINE), np.array([0.4, -2e-3])
    none = track(model, ITEM, STATES, MACHINE.values, extra, np.zeros(2))
    some = track(model, ITEM, STATES, MACHINE.values, extra, sizes)
    residual, columns, _ = white_problem(none, NOISY)
    there, _, _ = white_problem(some, NOISY)
    assert columns.shape == (SAMPLES, 2)
    np.testing.assert_allclose(residual + columns @ sizes, there, atol=1e-9)
    assert np.abs(there - residual).max() > 1.0


def test_a_smoothed_trajectory_needs_no_smoothing_again() -> None:
    model, change = WindowModel(MACHINE), np.zeros(0)
    one = track(model, ITEM, STATES, MACHINE.values)
    first = smoothed(one, NOISY, change)
    assert np.abs(first.state).max() > 1e-4
    again = replace(track(model, ITEM, STATES + first.state, MACHINE.values), P0=one.P0)
    second = smoothed(again, NOISY, change)
    assert np.abs(second.state).max() < 1e-9
    assert second.logl == pytest.approx(first.logl, rel=1e-9)
    np.testing.assert_allclose(second.force, first.force, atol=1e-9)


def test_smoothing_with_changed_numbers_is_smoothing_of_the_changed_machine() -> None:
    column = MACHINE.column("f.offset")
    model, moved = WindowModel(MACHINE, (column,)), MACHINE.values.copy()
    moved[column] += 0.7
    here = smoothed(track(model, ITEM, STATES, MACHINE.values), NOISY, np.array([0.7]))
    there = smoothed(track(model, ITEM, STATES, moved), NOISY, np.zeros(1))
    assert here.logl == pytest.approx(there.logl, rel=1e-9)
    np.testing.assert_allclose(here.state, there.state, atol=1e-9)


def test_missing_samples_are_left_out() -> None:
    random = np.random.default_rng(5)
    y = ITEM.block.y.copy()
    gone = random.random(y.shape) < 0.3
    y[gone] = np.nan
    item = replace(ITEM, block=replace(ITEM.block, y=y))
    one = track(WindowModel(MACHINE), item, STATES, MACHINE.values)
    assert one.count == SAMPLES - gone.sum()
    residual, _, _ = white_problem(one, NOISY)
    assert np.all(residual[gone.ravel()] == 0.0)
    assert np.isfinite(log_likelihood(one, NOISY))


def test_a_run_that_grows_without_bound_is_infinitely_unlikely() -> None:
    one = track(WindowModel(MACHINE), ITEM, STATES, MACHINE.values)
    far = replace(one, residual=1e200 + one.residual)
    assert log_likelihood(far, NOISY) == -np.inf


def test_a_force_is_effective_where_the_machine_answers_it() -> None:
    one = track(WindowModel(MACHINE), ITEM, STATES, MACHINE.values)
    assert effective([one]).tolist() == [True]
    deaf = replace(one.linear, left=0 * one.linear.left, by_force=0 * one.linear.by_force)
    assert effective([replace(one, linear=deaf)]).tolist() == [False]
    assert one.step_s == pytest.approx(STEP)


def wide() -> Track:
    """The track with three sensors of the place, and three forces that push it."""
    one = track(WindowModel(MACHINE), ITEM, STATES, MACHINE.values)
    linear, pushes = one.linear, np.array([1.0, 0.5, -0.3])
    chance = np.random.default_rng(4)
    return replace(
        one,
        linear=replace(
            linear,
            left=linear.left * pushes,
            right=linear.right * pushes,
            by_force=np.repeat(np.repeat(linear.by_force, 3, axis=2), 3, axis=3),
            by_state=linear.by_state * np.array([1.0, 2.0, 0.7])[:, None],
            direct=np.repeat(linear.direct, 3, axis=2),
        ),
        residual=NOISE * chance.standard_normal((SAMPLES, 3)),
        seen=chance.random((SAMPLES, 3)) > 0.1,
    )


def test_forces_and_colours_without_a_size_are_those_of_next_to_none() -> None:
    """The filter has no states for them; what comes out stands sensor by sensor all the same."""
    one, force, colour = wide(), np.array([0.3, 0.0, 0.2]), NOISE * np.array([0.0, 2.0, 1.0])
    some = NoiseModel(force, 0.2, NOISE * np.array([1.0, 0.5, 2.0]), colour, 0.5)
    every = replace(some, force=np.fmax(force, 1e-9), colour=np.fmax(colour, 1e-12))
    assert log_likelihood(one, some) == pytest.approx(log_likelihood(one, every), rel=1e-9)
    change = np.array([0.4, -0.1])[: one.linear.by_free.shape[3]]
    mine, theirs = (smoothed(one, noise, change) for noise in (some, every))
    assert mine.logl == pytest.approx(theirs.logl, rel=1e-9)
    for name in ("state", "force", "force_sd", "colour", "by_white", "by_times"):
        first, second = getattr(mine, name), getattr(theirs, name)
        assert first.shape == second.shape
        assert np.abs(first - second).max() < 1e-6 * np.abs(second).max(), name
    assert mine.by_force[[0, 2]] == pytest.approx(theirs.by_force[[0, 2]], rel=1e-6)
    assert mine.by_colour[1:] == pytest.approx(theirs.by_colour[1:], rel=1e-6)
    white = [white_problem(one, noise)[0] for noise in (some, every)]
    assert white[0] == pytest.approx(white[1], abs=1e-6)


def test_a_sensor_of_given_motion_shows_nothing_of_the_machine() -> None:
    one = wide()
    given = np.array([1.0, 0.0, 1.0])
    linear = replace(
        one.linear,
        by_state=one.linear.by_state * given[:, None],
        by_force=one.linear.by_force * given[:, None],
        direct=one.linear.direct * given[:, None],
    )
    assert showing([replace(one, linear=linear)]).tolist() == [True, False, True]
