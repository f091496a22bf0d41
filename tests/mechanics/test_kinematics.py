"""Where points are, stretches of places and their slopes, against differences of numbers."""

import numpy as np
import pytest
import sympy as sp
from builders import cart_pole, model_of

from symhyb.mechanics.kinematics import (
    GROUND,
    Frame,
    Geometry,
    distance,
    geometry,
    gradient,
    rate_of,
    stretch_of,
)
from symhyb.mechanics.symbols import Symbols, symbols_of
from symhyb.model.types import At, Between, Model, On, Place

STEP = 1e-6


def placed(model: Model) -> tuple[Symbols, Geometry]:
    symbols = symbols_of(model)
    return symbols, geometry(model, symbols)


def stretch(model: Model, place: Place) -> tuple[Symbols, sp.Expr]:
    symbols, places = placed(model)
    return symbols, stretch_of(model, place, places, symbols)


def test_stretch_between_points_and_its_slopes() -> None:
    model = cart_pole()
    s, path = stretch(model, Between("post", "tip"))
    lowered = sp.lambdify([s.q, s.v, s.p], [path, rate_of(path, s), *gradient(path, s)])
    p = [item.si for item in model.all_parameters()]
    a = p[3]
    rng = np.random.default_rng(2)
    for _ in range(5):
        q, v = rng.normal(size=(2, 2))
        length, rate, *direction = lowered(q, v, p)
        tip = [q[0] + 2 * a * np.sin(q[1]), -2 * a * np.cos(q[1])]
        assert length == pytest.approx(np.hypot(tip[0] - 1.5 * a, tip[1] + 2 * a))
        ahead, behind = (lowered(q + sign * STEP * v, v, p)[0] for sign in (1, -1))
        assert rate == pytest.approx((ahead - behind) / (2 * STEP), abs=1e-8)
        assert rate == pytest.approx(np.dot(direction, v))


def test_stretch_on_a_coordinate_is_the_coordinate() -> None:
    s, path = stretch(cart_pole(), On("phi"))
    assert (path, rate_of(path, s), gradient(path, s)) == (s.q[1], s.v[1], (0, 1))


def test_a_place_at_a_point_has_no_stretch() -> None:
    with pytest.raises(TypeError, match="no stretch"):
        stretch(cart_pole(), At("tip"))


def test_the_rate_of_a_moving_point_counts_time_itself() -> None:
    """x = q·cos(w t):  x' = q' cos(w t) − w q sin(w t)."""
    model = model_of(
        coordinates={"q": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "w": (2.0, "1/s")},
        points={"end": ["q*cos(w*t)", "0"]},
        bodies={"ball": {"mass": "m", "at": "end"}},
    )
    s, places = placed(model)
    x, _ = places.points["end"]
    w = s.p[1]
    expected = s.v[0] * sp.cos(w * s.t) - w * s.q[0] * sp.sin(w * s.t)
    assert sp.expand(rate_of(x, s) - expected) == 0


def test_the_gradient_of_a_position_is_what_its_speed_multiplies() -> None:
    """r' = (∂r/∂q) q', so a force F at r has Q = (∂r/∂q)ᵀ F and the same power F·r'."""
    s, places = placed(cart_pole())
    for part in places.points["tip"]:
        power = sum(g * v for g, v in zip(gradient(part, s), s.v, strict=True))
        assert sp.expand(power - rate_of(part, s)) == 0
    assert gradient(places.points["tip"][0], s)[0] == 1


def test_distance_is_pythagoras() -> None:
    assert distance((sp.Integer(1), sp.Integer(1)), (sp.Integer(4), sp.Integer(5))) == 5


def test_a_frame_turns_counter_clockwise() -> None:
    r"""A point 2 m along y' of a frame at (1, 0) turned by 90° lies at (−1, 0)."""
    local = (sp.Integer(0), sp.Integer(2))
    assert Frame((sp.Integer(1), sp.Integer(0)), sp.pi / 2).place(local) == (-1, 0)
    assert GROUND.place(local) == local


def arm(parent: str = "upper") -> Model:
    """Two links of which the lower hangs on the end of the upper one, each with its centre ahead of
    its joint, and a point beside the axis of the lower one. Angles: alpha, and beta relative."""
    return model_of(
        coordinates={"alpha": {"unit": "rad"}, "beta": {"unit": "rad"}},
        parameters={"m": (1.0, "kg"), "J": (0.1, "kg*m^2"), "l": (0.5, "m"), "o": (0.2, "m")},
        points={
            "elbow": {"body": "upper", "at": ["l", "0"]},
            "hand": {"body": "lower", "at": ["l", "o"]},
        },
        bodies={
            "lower": {
                "parent": parent,
                "joint": "elbow",
                "angle": "beta",
                "mass": "m",
                "inertia": "J",
                "at": ["o", "0"],
            },
            "upper": {
                "joint": ["o", "-o"],
                "angle": "alpha",
                "mass": "m",
                "inertia": "J",
                "at": ["o", "0"],
            },
        },
    )


def turned(angle: float, x: float, y: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ [x, y]


def test_a_chain_of_bodies_is_the_product_of_its_turns() -> None:
    """Declared out of order: the lower link stands in the file before what it hangs on."""
    model = arm()
    s, places = placed(model)
    p = [item.si for item in model.all_parameters()]
    alpha, beta, length, off = 0.4, -1.3, 0.5, 0.2
    found = sp.lambdify(
        [s.q, s.p],
        [
            places.points["hand"],
            places.centres["lower"],
            places.centres["upper"],
            places.frames["lower"].angle,
        ],
    )([alpha, beta], p)
    elbow = np.array([off, -off]) + turned(alpha, length, 0)
    assert found[0] == pytest.approx(elbow + turned(alpha + beta, length, off))
    assert found[1] == pytest.approx(elbow + turned(alpha + beta, off, 0))
    assert found[2] == pytest.approx(np.array([off, -off]) + turned(alpha, off, 0))
    assert found[3] == pytest.approx(alpha + beta)
