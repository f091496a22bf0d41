"""Normal equations of a few numbers: steps within bounds, inverses, and no step from nonsense."""

import numpy as np
import pytest

from symhyb.discrepancy.fitting.normal import bounded_step, inverse_of

WIDE = np.full(2, np.inf)


def test_a_step_solves_the_problem_whatever_the_units() -> None:
    gram, right = np.array([[4e12, 1e3], [1e3, 1e-6]]), np.array([2e12, 3e2])
    expected = np.linalg.solve(gram, right)
    assert bounded_step(gram, right, 0.0, -WIDE, WIDE) == pytest.approx(expected, rel=1e-6)


def test_a_step_stays_within_bounds() -> None:
    gram, right = np.eye(2), np.array([3.0, -1.0])
    assert bounded_step(gram, right, 0.0, -WIDE, np.array([2.0, 5.0])) == pytest.approx([2.0, -1.0])


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
