"""Stretch, rate and direction of places, against differences of numbers."""

import numpy as np
import pytest
import sympy as sp
from builders import cart_pole, model_of

from symhyb.mechanics.kinematics import generalized, gradient, pathway, position, rate_of
from symhyb.mechanics.symbols import symbols_of
from symhyb.model.types import At, Between, On

STEP = 1e-6


def test_stretch_between_points_and_its_slopes() -> None:
    model = cart_pole()
    s = symbols_of(model)
    length = sp.Symbol("length", real=True)
    path = pathway(model, Between("post", "tip"), length, s)
    lowered = sp.lambdify([s.q, s.v, s.p, length], [path.stretch, path.rate, *path.direction])
    p = [item.si for item in model.all_parameters()]
    a = p[3]
    rng = np.random.default_rng(2)
    for _ in range(5):
        q, v = rng.normal(size=(2, 2))
        stretch, rate, *direction = lowered(q, v, p, 0.35)
        tip = [q[0] + 2 * a * np.sin(q[1]), -2 * a * np.cos(q[1])]
        assert stretch == pytest.approx(np.hypot(tip[0] - 1.5 * a, tip[1] + 2 * a) - 0.35)
        ahead, behind = (lowered(q + sign * STEP * v, v, p, 0.35)[0] for sign in (1, -1))
        assert rate == pytest.approx((ahead - behind) / (2 * STEP), abs=1e-8)
        assert rate == pytest.approx(np.dot(direction, v))


def test_stretch_on_a_coordinate_is_the_coordinate() -> None:
    model = cart_pole()
    s = symbols_of(model)
    path = pathway(model, On("phi"), sp.Integer(0), s)
    assert (path.stretch, path.rate, path.direction) == (s.q[1], s.v[1], (0, 1))


def test_a_place_at_a_point_has_no_stretch() -> None:
    model = cart_pole()
    with pytest.raises(TypeError, match="no stretch"):
        pathway(model, At("tip"), sp.Integer(0), symbols_of(model))


def test_the_rate_of_a_moving_point_counts_time_itself() -> None:
    """x = q·cos(w t):  x' = q' cos(w t) − w q sin(w t)."""
    model = model_of(
        coordinates={"q": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "w": (2.0, "1/s")},
        points={"end": ["q*cos(w*t)", "0"]},
        bodies={"ball": {"mass": "m", "at": "end"}},
    )
    s = symbols_of(model)
    x, _ = position(model, "end", s)
    w = s.p[1]
    expected = s.v[0] * sp.cos(w * s.t) - w * s.q[0] * sp.sin(w * s.t)
    assert sp.expand(rate_of(x, s) - expected) == 0


def test_a_force_at_a_point_does_the_same_work_on_coordinates_and_in_the_plane() -> None:
    """Q·q' = F·r' for any speed."""
    model = cart_pole()
    s = symbols_of(model)
    where = position(model, "tip", s)
    force = sp.symbols("Fx Fy", real=True)
    on_coordinates = sum(Q * v for Q, v in zip(generalized(force, where, s), s.v, strict=True))
    in_the_plane = sum(f * rate_of(r, s) for f, r in zip(force, where, strict=True))
    assert sp.expand(on_coordinates - in_the_plane) == 0
    assert gradient(where[0], s)[0] == 1
