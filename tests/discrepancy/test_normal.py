"""Normal equations of a few numbers: steps within bounds, inverses, and no step from nonsense."""

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.discrepancy.fitting.normal import bounded_step, inverse_of

Array = NDArray[np.float64]
WIDE = np.full(2, np.inf)


def test_a_step_solves_the_problem_whatever_the_units() -> None:
    gram, right = np.array([[4e12, 1e3], [1e3, 1e-6]]), np.array([2e12, 3e2])
    expected = np.linalg.solve(gram, right)
    assert bounded_step(gram, right, 0.0, -WIDE, WIDE) == pytest.approx(expected, rel=1e-6)


def test_a_step_stays_within_bounds() -> None:
    gram, right = np.eye(2), np.array([3.0, -1.0])
    assert bounded_step(gram, right, 0.0, -WIDE, np.array([2.0, 5.0])) == pytest.approx([2.0, -1.0])


def best_of_all(gram: Array, right: Array, low: Array, high: Array) -> Array:
    """The least of ½ xᵀ G x − rᵀ x within bounds, by trying each number free or on either bound."""
    found: list[tuple[float, Array]] = []
    for held in product((None, low, high), repeat=right.size):
        x = np.array([0.0 if at is None else at[i] for i, at in enumerate(held)])
        free = [i for i, at in enumerate(held) if at is None]
        rest = right - gram @ x
        x[free] = np.linalg.solve(gram[np.ix_(free, free)], rest[free])
        if np.all(x >= low - 1e-9) and np.all(x <= high + 1e-9):
            found.append((float(x @ gram @ x / 2 - right @ x), x))
    return min(found, key=lambda one: one[0])[1]


@pytest.mark.parametrize("seed", range(5))
def test_a_step_within_bounds_is_the_best_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(9, 4)) * 10.0 ** rng.integers(-6, 7, 4)
    gram, right = rows.T @ rows, rows.T @ rng.normal(size=9)
    whole = np.linalg.solve(gram, right)
    low, high = np.sort([whole * rng.uniform(-1, 2, 4), whole * rng.uniform(-1, 2, 4)], axis=0)
    expected = best_of_all(gram, right, low, high)
    step = bounded_step(gram, right, 0.0, low, high)
    assert step / np.abs(whole) == pytest.approx(expected / np.abs(whole), abs=1e-6)


@pytest.mark.parametrize("at", [0.0, 1e-3, 5.0, 1e14])
def test_bounds_without_room_are_where_the_step_ends(at: float) -> None:
    """One number cannot move, and the others go where that leaves them."""
    gram, right = np.array([[2.0, 0.5], [0.5, 1.0]]), np.array([1e3, 2.0])
    low, high = np.array([-at, -np.inf]), np.array([-at, np.inf])
    step = bounded_step(gram, right, 0.0, low, high)
    assert step[0] == pytest.approx(-at, rel=1e-12)
    assert step[1] == pytest.approx(2.0 + 0.5 * at, rel=1e-9)


def test_bounds_out_of_reach_are_none() -> None:
    gram, right = np.eye(2), np.array([3.0, -1.0])
    high = np.array([1e200, -2.0])
    assert bounded_step(gram, right, 0.0, -WIDE, high) == pytest.approx([3.0, -2.0])


@pytest.mark.parametrize("size", [np.nan, np.inf, 1e308])
def test_a_run_away_gives_no_step(size: float) -> None:
    gram = np.diag([1.0, size])
    right = np.array([1.0, size])
    step = bounded_step(gram, right, 0.0, -WIDE, WIDE)
    assert np.isfinite(step).all()
    if not np.isfinite(size):
        assert not np.any(step)


def test_nothing_to_fit_gives_no_step() -> None:
    assert bounded_step(np.zeros((0, 0)), np.zeros(0), 0.0, np.zeros(0), np.zeros(0)).size == 0
    assert inverse_of(np.zeros((0, 0))).size == 0


def test_the_inverse_holds_over_units() -> None:
    gram = np.array([[4e12, 1e3], [1e3, 1e-6]])
    assert inverse_of(gram) @ gram == pytest.approx(np.eye(2), abs=1e-6)
