"""Residuals that are noise, and residuals that are not."""

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.discrepancy.evidence import Residuals, Whiteness
from symhyb.discrepancy.fitting.whiteness import correlation, whiteness

Array = NDArray[np.float64]
W, L, STEP = 20, 100, 0.01


def smooth(random: np.random.Generator, pole: float) -> Array:
    """A series that forgets slowly, in windows (W, L)."""
    shocks = random.normal(size=W * L)
    for i in range(1, shocks.size):
        shocks[i] += pole * shocks[i - 1]
    return shocks.reshape(W, L)


def told(e: Array, u: Array) -> Whiteness:
    left = Residuals(e[:, :, None], u[:, :, None], STEP)
    (one,) = whiteness("a.csv", left, ["laser"], ["f"])
    return one


def test_white_noise_is_noise_and_independent_of_a_slow_input() -> None:
    random = np.random.default_rng(0)
    one = told(random.normal(size=(W, L)), smooth(random, 0.95))
    assert one.noise()
    assert one.noise("f")
    assert one.auto[one.lags == 0] == pytest.approx(1.0)
    assert one.lags[-1] == pytest.approx(25 * STEP)


def test_what_is_correlated_in_time_is_no_noise() -> None:
    random = np.random.default_rng(1)
    one = told(smooth(random, 0.6), smooth(random, 0.9))
    assert not one.noise()
    assert one.largest() == pytest.approx(0.6, abs=0.06)
    assert one.noise("f")


def test_what_follows_an_input_is_seen_at_its_delay() -> None:
    random = np.random.default_rng(2)
    u = random.normal(size=(W, L))
    e = random.normal(size=(W, L))
    e[:, 3:] += 0.5 * u[:, :-3]
    one = told(e, u)
    assert one.noise()
    assert not one.noise("f")
    assert one.lags[np.argmax(np.abs(one.cross["f"]))] == pytest.approx(3 * STEP)


def test_bounds_hold_what_they_say() -> None:
    """99 % of the correlations of independent series, though both are correlated in time."""
    random = np.random.default_rng(3)
    beyond = []
    for _ in range(60):
        one = told(smooth(random, 0.5), smooth(random, 0.8))
        beyond.append(np.mean(np.abs(one.cross["f"]) > one.bounds["f"]))
    assert 0.002 < np.mean(beyond) < 0.03


def test_a_correlation_is_that_of_numpy_and_leaves_out_what_is_missing() -> None:
    random = np.random.default_rng(4)
    e, u = random.normal(size=(1, 500)), random.normal(size=(1, 500))
    e, u = e - e.mean(), u - u.mean()
    assert correlation(e, u, 2)[2] == pytest.approx(np.corrcoef(e[0], u[0])[0, 1])
    left = Residuals(np.full((W, L, 2), np.nan), np.zeros((W, L, 1)), STEP)
    left.left[:, :, 1] = 1e200 * random.normal(size=(W, L))
    assert whiteness("a.csv", left, ["dead", "away"], ["f"]) == ()
