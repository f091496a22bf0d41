"""Breakaway level and Stribeck speed are known no better than the smoothed sign allows."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from symhyb.laws.friction import widened

FRICTION = {
    "coulomb": (2.0, 0.01),
    "static": (3.0, 0.01),
    "stribeck": (0.02, 1e-4),
    "transition": (5e-4, float("nan")),
}


def test_the_level_is_open_by_what_the_peak_lacks() -> None:
    def law(v: float) -> float:
        return (2.0 + np.exp(-((v / 0.02) ** 2))) * np.tanh(v / 5e-4)

    peak = -minimize_scalar(lambda v: -law(v), bounds=(0, 0.01), method="bounded").fun
    reported = widened(FRICTION)
    assert reported["static"] == (3.0, pytest.approx(np.hypot(0.01, 3.0 - peak), rel=1e-3))
    assert reported["stribeck"] == (0.02, pytest.approx(np.hypot(1e-4, 5e-4)))
    assert reported["coulomb"] == FRICTION["coulomb"]


def test_a_narrow_transition_leaves_the_deviations() -> None:
    reported = widened(FRICTION | {"transition": (1e-9, float("nan"))})
    assert reported["static"][1] == pytest.approx(0.01, rel=1e-3)
    assert reported["stribeck"][1] == pytest.approx(1e-4, rel=1e-3)


def test_plain_friction_is_left_as_it_is() -> None:
    plain = {key: FRICTION[key] for key in ("coulomb", "transition")}
    assert widened(plain) == plain


def test_a_number_that_is_held_gets_no_deviation() -> None:
    reported = widened(FRICTION | {"stribeck": (0.02, float("nan"))})
    assert np.isnan(reported["stribeck"][1])
    assert np.isfinite(reported["static"][1])
