"""The population of a fleet: the likelihood's own maximum, and the truth where it is known."""

import numpy as np
import pytest
from fleets import drawn
from scipy.optimize import minimize_scalar

from symhyb.fleet.means import Unit
from symhyb.fleet.population import chosen_population, population_of

# Trials of a vaccine (Colditz et al., JAMA 271, 1994): log risk ratio and its variance, and the
# latitude, as Viechtbauer, Journal of Statistical Software 36, 2010, lists them
TRIALS = """\
-0.8893 0.3256 44
-1.5854 0.1946 55
-1.3481 0.4154 42
-1.4416 0.0200 52
-0.2175 0.0512 13
-0.7861 0.0069 44
-1.6209 0.2230 19
0.0120 0.0040 13
-0.4694 0.0564 27
-1.3713 0.0730 42
-0.3394 0.0124 18
0.4459 0.5325 33
-0.0173 0.0714 33
"""
EFFECTS, VARIANCES, LATITUDES = np.loadtxt(TRIALS.splitlines()).T


def restricted(spread: float, x: np.ndarray) -> float:
    """ln of the restricted likelihood of one number, written out."""
    weight = 1 / (VARIANCES + spread)
    gram = x.T @ (weight[:, None] * x)
    rest = EFFECTS - x @ np.linalg.solve(gram, x.T @ (weight * EFFECTS))
    logdet = -np.log(weight).sum() + np.linalg.slogdet(gram)[1]
    return float(-0.5 * (logdet + rest @ (weight * rest)))


def trials(x: np.ndarray) -> list[Unit]:
    rows = zip(EFFECTS, VARIANCES, x, strict=True)
    return [Unit(np.array([[y]]), np.array([[[v]]]), row[None]) for y, v, row in rows]


@pytest.mark.parametrize("condition", [False, True])
def test_a_single_number_is_the_maximum_of_its_restricted_likelihood(condition: bool) -> None:
    ones = np.ones((EFFECTS.size, 1))
    x = np.column_stack([ones, LATITUDES - 33]) if condition else ones
    found = population_of(trials(x))
    best = minimize_scalar(lambda v: -restricted(v, x), bounds=(1e-6, 2), method="bounded")
    assert found.between[0, 0] == pytest.approx(best.x, rel=0.02)
    assert found.logl == pytest.approx(-best.fun, abs=1e-3)
    weight = 1 / (VARIANCES + best.x)
    gram = x.T @ (weight[:, None] * x)
    beta = np.linalg.solve(gram, x.T @ (weight * EFFECTS))
    assert found.beta[:, 0] == pytest.approx(beta, rel=0.02)
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(
        np.sqrt(np.diag(np.linalg.inv(gram))), rel=0.02
    )


def test_published_values_of_the_vaccine_trials() -> None:
    """Viechtbauer 2010: −0.7145 ± 0.1798 with a variance between trials of 0.3132 ± 0.1664; with
    the latitude 0.0764, and −0.0291 ± 0.0072 a degree."""
    ones = np.ones((EFFECTS.size, 1))
    found = population_of(trials(ones))
    assert found.beta[0, 0] == pytest.approx(-0.7145, abs=5e-4)
    assert np.sqrt(found.covariance[0, 0]) == pytest.approx(0.1798, abs=5e-4)
    assert found.between[0, 0] == pytest.approx(0.3132, abs=2e-3)
    assert 2 * found.spread_sd[0] * np.sqrt(0.3132) == pytest.approx(0.1664, rel=0.02)
    found = population_of(trials(np.column_stack([ones, LATITUDES])))
    assert found.between[0, 0] == pytest.approx(0.0764, abs=2e-3)
    assert found.beta[1, 0] == pytest.approx(-0.0291, abs=1e-4)
    assert np.sqrt(found.covariance[1, 1]) == pytest.approx(0.0072, abs=1e-4)


def test_spreads_between_and_within_units_are_told_apart() -> None:
    between, within = np.diag([0.04, 0.09]), np.diag([0.01, 0.0025])
    units = drawn(1, 150, np.array([1.0, -2.0]), between, np.diag([0.01, 0.01]), 4, within)
    found = population_of(units)
    assert np.diag(found.between) == pytest.approx(np.diag(between), rel=0.3)
    assert np.diag(found.within) == pytest.approx(np.diag(within), rel=0.3)
    assert found.beta[0] == pytest.approx([1.0, -2.0], abs=0.08)


def test_numbers_that_vary_together_are_seen_to() -> None:
    between = np.array([[0.04, 0.054], [0.054, 0.09]])
    units = drawn(2, 200, np.zeros(2), between, np.diag([0.01, 0.01]))
    found = chosen_population(units)
    assert found.between == pytest.approx(between, rel=0.3)
    alone = chosen_population(drawn(3, 200, np.zeros(2), np.diag([0.04, 0.09]), 0.01 * np.eye(2)))
    assert alone.between[0, 1] == 0.0  # which costs a number and gains nothing
    for one in (found, alone):  # (τ² + σ²)/τ/√(2N)
        assert one.spread_sd == pytest.approx([0.05 / 0.2 / 20, 0.1 / 0.3 / 20], rel=0.25)


def test_the_spread_of_few_units_is_badly_known() -> None:
    between = np.array([[0.04, 0.0599], [0.0599, 0.09]])
    found = population_of(drawn(6, 8, np.zeros(2), between, 1e-4 * np.eye(2), 4, 1e-4 * np.eye(2)))
    assert found.spread_sd == pytest.approx(np.sqrt(np.diag(found.between) / 14), rel=0.05)


def test_where_all_units_are_the_same_there_is_no_spread() -> None:
    found = population_of(drawn(4, 60, np.zeros(2), np.zeros((2, 2)), np.eye(2)))
    assert np.diag(found.between).max() < 0.15
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(2 * [1 / np.sqrt(60)], rel=0.1)


def test_a_unit_with_more_recordings_has_more_weight() -> None:
    many = Unit(np.full((4, 1), 1.0), np.full((4, 1, 1), 1.0), np.ones((4, 1)))
    one = Unit(np.array([[0.0]]), np.array([[[1.0]]]), np.ones((1, 1)))
    other = Unit(np.array([[0.1]]), np.array([[[1.0]]]), np.ones((1, 1)))
    found = population_of([many, one, other])
    assert found.beta[0, 0] == pytest.approx((4 * 1.0 + 0.0 + 0.1) / 6, abs=0.06)


def test_a_slope_is_found() -> None:
    slope = np.array([0.5, 0.0])
    units = drawn(5, 120, np.ones(2), 0.01 * np.eye(2), 0.001 * np.eye(2), 2, None, slope)
    found = population_of(units)
    sd = np.sqrt(np.diag(found.covariance)).reshape(2, 2)
    assert abs(found.beta[1] - slope) == pytest.approx([0, 0], abs=4 * sd[1].max())
    assert sd[1].max() < 0.01
