"""Noise of a measured input in windows: the filter whitens R + J Q Jᵀ, and what is known of the
errors is put right in the input and in what is held against it."""

from dataclasses import replace

import numpy as np
import pytest
from builders import oscillator, push, recording
from numpy.typing import NDArray

from symhyb.discrepancy.likelihood.input_noise import InputNoise
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import Cut, lay
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel

Array = NDArray[np.float64]
N, X, M, K = 30, 2, 2, 1
SD = np.array([0.5, 2.0])
ROWS = np.array([[0, 1, 2, 3, 4, 5], [12, 13, 14, 15, 16, 17]])


def noise(size: float = 0.7) -> InputNoise:
    rng = np.random.default_rng(3)
    return InputNoise(
        (0,),
        np.array([size]),
        rng.normal(size=(N - 1, X, X)) / 2,
        rng.normal(size=(N - 1, X, K)),
        rng.normal(size=(N - 1, X, K)),
        rng.normal(size=(N, M, X)),
        rng.normal(size=(N, M, K)),
        rng.normal(size=(N, K)),
    )


def replies(of: InputNoise, rows: NDArray[np.int64]) -> Array:
    """J (L·m, L): what the sensors of one window show of an error of each sample of the input."""
    columns = []
    for at in rows:
        known = np.zeros((N, K))
        known[at] = 1.0
        columns.append(replace(of, known=known).shown(rows[None])[0].ravel())
    return np.stack(columns, axis=1)


def test_what_errors_do_follows_the_dynamics() -> None:
    one = noise()
    got, rows = one.shown(ROWS)[1], ROWS[1]
    state = np.zeros(X)
    for i, at in enumerate(rows):
        if i:
            before = rows[i - 1]
            state = one.transition[before] @ state + one.left[before] @ one.known[before]
            state = state + one.right[before] @ one.known[at]
        assert got[i] == pytest.approx(one.by_state[at] @ state + one.by_input[at] @ one.known[at])


def test_the_covariance_of_windows_becomes_that_of_white_noise() -> None:
    one, seen = noise(), np.ones((2, 6, M), bool)
    for w, rows in enumerate(ROWS):
        J = replies(one, rows)
        covariance = np.diag(np.tile(SD**2, 6)) + 0.7**2 * J @ J.T
        factor = np.linalg.cholesky(covariance)
        columns = np.random.default_rng(w).normal(size=(2, 6, M, 3))
        white = one.whitened(ROWS, columns, seen, SD)[w].reshape(6 * M, 3)
        assert white == pytest.approx(np.linalg.solve(factor, columns[w].reshape(6 * M, 3)))


def test_without_noise_of_the_input_every_sensor_is_weighed_by_itself() -> None:
    columns = np.random.default_rng(5).normal(size=(2, 6, M, 3))
    seen = np.ones((2, 6, M), bool)
    seen[0, 2, 1] = False
    white = noise(0.0).whitened(ROWS, columns, seen, SD)
    assert white == pytest.approx(np.where(seen[..., None], columns / SD[:, None], 0.0))


def windows() -> tuple[WindowModel, Cut, Array]:
    """An oscillator under a force whose record is wrong by known errors, N."""
    t = np.arange(400) / 100
    model = oscillator({"motor": push("f")}, inputs={"f": {"unit": "N"}})
    machine = build(model)
    errors = np.random.default_rng(7).normal(size=t.size) * 0.1
    run = recording(t, {"f": 3 * np.cos(2 * t) - errors}, place=np.sin(2 * t) / 10)
    item = lay(run, machine, motion_of(run, machine), 0.5)
    assert item is not None
    return WindowModel(machine), item, errors


def test_inputs_that_are_put_right_leave_the_residuals_of_a_linear_machine() -> None:
    model, item, errors = windows()
    t = item.source[0].t
    linear = model.along(item.block, item.states, model.machine.values)
    size = t.size
    one = InputNoise(
        (0,),
        np.array([0.1]),
        np.zeros((size - 1, 2, 2)),
        np.zeros((size - 1, 2, 1)),
        np.zeros((size - 1, 2, 1)),
        np.zeros((size, 1, 2)),
        np.zeros((size, 1, 1)),
        errors[:, None],
    )
    for w, rows in enumerate(item.rows):
        one.transition[rows[:-1]] = linear.transition[w]
        one.left[rows[:-1]], one.right[rows[:-1]] = linear.left[w], linear.right[w]
        one.by_state[rows], one.by_input[rows] = linear.by_state[w], linear.by_force[w]
    right = one.put_right(item)
    p = model.machine.values
    before = item.block.y - model.simulate(item.block, item.start, p)[1]
    after = right.block.y - model.simulate(right.block, item.start, p)[1]
    moved = (
        model.simulate(right.block, item.start, p)[1] - model.simulate(item.block, item.start, p)[1]
    )
    assert np.abs(after - before).max() < 2e-3 * np.abs(moved).max()
    assert right.block.d[..., 0] == pytest.approx(item.block.d[..., 0] + errors[item.rows])
    assert right.noise is one
