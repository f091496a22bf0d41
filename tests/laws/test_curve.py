"""The law of a curve: over the stretch it stores energy, over the rate it loses it."""

import numpy as np
import pytest

from symhyb.laws.characteristic import through
from symhyb.laws.curve import LAW
from symhyb.laws.maths import NUMPY, Action, Motion

X, F = [-2.0, -1.0, -0.2, 0.0, 0.3, 1.2], [-3.0, -2.5, -1.0, 0.0, 0.5, 0.7]
CURVE = through("c", X, F)


def acts(over: str, s: np.ndarray, r: np.ndarray, **values: float) -> Action:
    assert LAW.action is not None
    motion = Motion(s, r, (), 0.0)
    return LAW.action(NUMPY, motion, {"curve": CURVE, **values}, {"over": over})


def test_over_the_stretch_the_force_is_the_slope_of_what_is_stored() -> None:
    s = np.linspace(-3, 2, 1001)
    does, ahead = acts("stretch", s, 0 * s, scale=2.0), acts("stretch", s + 1e-6, 0 * s, scale=2.0)
    assert does.force == pytest.approx(2 * CURVE(s))
    assert (ahead.stored - does.stored) / 1e-6 == pytest.approx(does.force, abs=1e-5)
    assert acts("stretch", np.zeros(1), np.zeros(1)).stored == pytest.approx(0.0, abs=1e-15)
    assert np.all(does.stored >= -1e-15)  # the curve resists on both sides of 0


def test_over_the_rate_nothing_is_stored_and_the_force_resists() -> None:
    r = np.linspace(-3, 2, 1001)
    does = acts("rate", 0 * r + 0.7, r)
    assert does.force == pytest.approx(CURVE(r))
    assert does.stored == 0
    assert np.all(does.force * r >= 0)


@pytest.mark.parametrize(
    ("times", "factor"), [("rate", lambda r: r), ("square", lambda r: r * abs(r))]
)
def test_a_factor_of_the_speed_stores_nothing(times, factor) -> None:
    s, r = np.linspace(-3, 2, 101), np.linspace(2, -1, 101)
    assert LAW.action is not None
    options = {"over": "stretch", "times": times}
    does = LAW.action(NUMPY, Motion(s, r, (), 0.0), {"curve": CURVE, "scale": 2.0}, options)
    assert does.force == pytest.approx(2 * CURVE(s) * factor(r))
    assert does.stored == 0


def test_the_text_says_over_what_it_goes() -> None:
    assert LAW.text(["scale"], {"over": "rate"}) == "scale*curve(s')"
    assert LAW.text([], {"over": "stretch"}) == "curve(s)"
    assert LAW.text([], {"over": "stretch", "times": "rate"}) == "curve(s)*s'"
    assert LAW.text([], {"over": "stretch", "times": "square"}) == "curve(s)*abs(s')*s'"
