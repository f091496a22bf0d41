"""Windows of closed loops: initial states move along the constraints, and with what shapes them."""

from pathlib import Path

import numpy as np
from mechanisms import slider_crank

from symhyb.model.read import read_model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.manifold import gaps_of
from symhyb.numeric.runs.windows import Block, WindowModel

MACHINE = build(read_model(Path(__file__).parents[2] / "models" / "slider_crank.toml"))
LENGTH, STEP = 12, 0.01


def block() -> Block:
    t = STEP * np.arange(LENGTH)[None]
    d = 0.3 * np.sin(20 * t)[..., None]
    y = np.full((1, LENGTH, 2), np.nan)
    return Block(t, d, y, np.full((1, LENGTH - 1), 4))


def start(angle: float, rate: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    by_hand = slider_crank(angle)
    return np.concatenate([by_hand.q, rate * by_hand.slope])[None]


def test_a_start_beside_the_constraints_is_moved_onto_them() -> None:
    model = WindowModel(MACHINE)
    x = model.closed(block(), start(0.8, 4.0) + 1e-3, MACHINE.values)
    gaps = gaps_of(MACHINE, x[:, :3], x[:, 3:], x[:, 3:], np.zeros(1), MACHINE.values)
    assert np.abs(gaps.gap).max() < 1e-12
    assert np.abs(gaps.rate).max() < 1e-12
    assert np.array_equal(model.closed(block(), x, MACHINE.values)[0, :3], x[0, :3])


def test_slopes_by_free_starts_agree_with_differences() -> None:
    model, p = WindowModel(MACHINE), MACHINE.values
    begin = start(0.8, 4.0)
    linear = model.differentiate(block(), begin, p)
    assert linear.begin is not None
    slopes = linear.from_start()
    assert slopes.shape == (1, LENGTH, 2, 2) == (1, LENGTH, 2, model.form.moving)
    step = 1e-6
    for i, direction in enumerate(linear.begin[0].T):
        ends = [
            model.simulate(block(), model.closed(block(), begin + s * direction, p), p)[1]
            for s in (step, -step)
        ]
        difference = (ends[0] - ends[1]) / (2 * step)
        assert np.abs(difference - slopes[..., i]).max() < 1e-6 * np.abs(slopes).max()


def test_slopes_by_a_length_move_the_start_with_the_loop() -> None:
    columns = (MACHINE.column("l"), MACHINE.column("k"))
    model, p, begin = WindowModel(MACHINE, columns), MACHINE.values, start(0.8, 4.0)
    slopes = model.differentiate(block(), begin, p).from_free()
    for i, column in enumerate(columns):
        step, ends = 1e-6 * p[column], []
        for s in (step, -step):
            other = p.copy()
            other[column] += s
            ends.append(model.simulate(block(), model.closed(block(), begin, other), other)[1])
        difference = (ends[0] - ends[1]) / (2 * step)
        assert np.abs(difference - slopes[..., i]).max() < 1e-6 * np.abs(slopes[..., i]).max()


def test_one_pass_gives_both_slopes() -> None:
    model = WindowModel(MACHINE, (MACHINE.column("l"), MACHINE.column("k")))
    linear = model.differentiate(block(), start(0.8, 4.0), MACHINE.values)
    by_start, by_free = linear.from_start_and_free()
    assert np.allclose(by_start, linear.from_start(), rtol=1e-12, atol=0)
    assert np.allclose(by_free, linear.from_free(), rtol=1e-12, atol=1e-15)


def test_errors_of_single_states_are_those_that_the_loop_allows() -> None:
    model, begin = WindowModel(MACHINE), start(0.8, 4.0)
    linear = model.differentiate(block(), begin, MACHINE.values)
    assert linear.begin is not None
    found = linear.from_states()
    assert found.shape == (1, LENGTH, 2, 6)
    # along a free direction nothing is lost
    direction = linear.begin[0][:, 0]
    assert np.allclose(found @ direction, linear.from_start()[..., 0])
