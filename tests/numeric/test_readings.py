"""What instruments show, against closed forms."""

from collections.abc import Mapping

import numpy as np
import pytest
from builders import Entries, model_of, value

from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build

G = 9.81
LENGTH, OFFSET = 0.5, 0.1


def arm(sensors: Mapping[str, Entries], gravity: bool = True) -> Model:
    r"""An arm on a moving pivot, phi counter-clockwise from the horizontal:

              o tip, ``LENGTH`` along x' and ``OFFSET`` along y'
             /
    pivot   o -->      at (x, 0)
    """
    return model_of(
        gravity=["0", "-g"] if gravity else None,
        coordinates={"x": {"unit": "m"}, "phi": {"unit": "rad"}},
        parameters={
            "m": (0.8, "kg"),
            "J": (0.02, "kg*m^2"),
            "l": (LENGTH, "m"),
            "o": (OFFSET, "m"),
            "g": (G, "m/s^2"),
            "k": (30.0, "N/m"),
            "d": (2.0, "N*s/m"),
        },
        points={
            "pivot": ["x", "0"],
            "tip": {"body": "arm", "at": ["l", "o"]},
            "post": ["2*l", "3*l"],
        },
        bodies={
            "arm": {
                "joint": "pivot",
                "angle": "phi",
                "mass": "m",
                "inertia": "J",
                "at": ["l/2", "0"],
            }
        },
        elements={
            "band": {"kind": "spring", "between": ["post", "tip"], "stiffness": "k", "length": "l"},
            "oil": {"kind": "damper", "on": "x", "damping": "d"},
            "motor": {"kind": "force", "on": "x", "force": "3*k*l"},
            "fluid": {"kind": "added_mass", "on": "x", "mass": "m/4"},
        },
        sensors=sensors,
    )


ACCELERATION = {
    "ax": {"measures": "accelerometer_x(tip, arm)", "unit": "m/s^2"},
    "ay": {"measures": "accelerometer_y(tip, arm)", "unit": "m/s^2"},
}
Motion = tuple[list[float], list[float], list[float]]


def shown(model: Model, motion: Motion) -> np.ndarray:
    machine = build(model)
    return np.atleast_1d(value(machine.outputs, *motion, [], [], 0, machine.values))


@pytest.mark.parametrize(
    ("phi", "expected"),
    [
        (0.0, (0, G)),
        (np.pi / 2, (G, 0)),
        (np.pi, (0, -G)),
        (0.3, (G * np.sin(0.3), G * np.cos(0.3))),
    ],
)
def test_an_accelerometer_at_rest_shows_g_upwards(phi: float, expected: tuple[float, ...]) -> None:
    """It is held up against falling: with x' up it shows +g along x'."""
    found = shown(arm(ACCELERATION), ([0.2, phi], [0, 0], [0, 0]))
    assert found == pytest.approx(expected, abs=1e-12)


def test_an_accelerometer_that_falls_shows_nothing() -> None:
    """A body that falls freely: y'' = −g."""
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"y": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "g": (G, "m/s^2")},
        points={"centre": ["0*y", "y"]},
        bodies={"stone": {"mass": "m", "at": "centre"}},
        sensors={"a": {"measures": "accelerometer_y(centre, stone)", "unit": "m/s^2"}},
    )
    assert shown(model, ([3.0], [-2.0], [-G])) == pytest.approx([0], abs=1e-12)
    assert shown(model, ([3.0], [-2.0], [0.0])) == pytest.approx([G])


def test_an_accelerometer_on_a_rotating_arm_shows_what_pulls_it_inwards() -> None:
    """In the axes of the arm a point (l, o) has the acceleration
    (−ω² l − α o, −ω² o + α l)."""
    w, alpha = 4.0, -7.0
    found = shown(arm(ACCELERATION, gravity=False), ([0, 0.9], [0, w], [0, alpha]))
    expected = [-(w**2) * LENGTH - alpha * OFFSET, -(w**2) * OFFSET + alpha * LENGTH]
    assert found == pytest.approx(expected)


def test_an_accelerometer_turns_with_the_body_whose_axes_it_has() -> None:
    """A pivot that is pushed along x by 2 m/s², seen in the axes of an arm turned by phi."""
    sensors = {
        "ax": {"measures": "accelerometer_x(pivot, arm)", "unit": "m/s^2"},
        "ay": {"measures": "accelerometer_y(pivot, arm)", "unit": "m/s^2"},
    }
    found = shown(arm(sensors), ([0, 0.4], [1, 3], [2, 5]))
    c, s = np.cos(0.4), np.sin(0.4)
    assert found == pytest.approx([2 * c + G * s, -2 * s + G * c])


def test_orientation_turning_rate_and_places() -> None:
    names = (
        "orientation(arm)",
        "gyroscope(arm)",
        "position_x(tip)",
        "position_y(tip)",
        "distance(post, tip)",
        "direction(post, tip)",
        "direction(tip, post)",
    )
    units = ("rad", "rad/s", "m", "m", "m", "rad", "rad")
    sensors = {
        f"s{i}": {"measures": name, "unit": unit}
        for i, (name, unit) in enumerate(zip(names, units, strict=True))
    }
    x, phi, c, s = 0.3, 2.1, np.cos(2.1), np.sin(2.1)
    tip = np.array([x + LENGTH * c - OFFSET * s, LENGTH * s + OFFSET * c])
    way = tip - [2 * LENGTH, 3 * LENGTH]
    found = shown(arm(sensors), ([x, phi], [0.5, -1.5], [0, 0]))
    expected = [
        phi,
        -1.5,
        *tip,
        np.hypot(*way),
        np.arctan2(way[1], way[0]),
        np.arctan2(-way[1], -way[0]),
    ]
    assert found == pytest.approx(expected)


def test_the_angle_of_a_hanging_body_adds_up_along_its_chain() -> None:
    hinged = {"mass": "m", "inertia": "J"}
    model = model_of(
        coordinates={"a": {"unit": "rad"}, "b": {"unit": "rad"}},
        parameters={"m": (1.0, "kg"), "J": (0.1, "kg*m^2"), "l": (1.0, "m")},
        bodies={
            "upper": {"joint": ["0", "0"], "angle": "a", "at": ["l", "0"], **hinged},
            "lower": {
                "parent": "upper",
                "joint": ["l", "0"],
                "angle": "b",
                "at": ["l", "0"],
                **hinged,
            },
        },
        sensors={
            "o": {"measures": "orientation(lower)", "unit": "rad"},
            "g": {"measures": "gyroscope(lower)", "unit": "rad/s"},
        },
    )
    assert shown(model, ([0.3, 0.5], [2, -3], [0, 0])) == pytest.approx([0.8, -1.0])


def test_a_force_cell_shows_the_force_of_its_element() -> None:
    """Of passive elements the one that resists (a tension is positive), of active ones the push."""
    sensors = {
        name: {"measures": f"force({name})", "unit": "N"}
        for name in ("band", "oil", "motor", "fluid")
    }
    found = shown(arm(sensors), ([0.3, 0.0], [0.7, 0], [4.0, 0]))
    reach = np.hypot(0.3 + LENGTH - 2 * LENGTH, OFFSET - 3 * LENGTH) - LENGTH
    assert found == pytest.approx([30 * reach, 2 * 0.7, 3 * 30 * LENGTH, 0.2 * 4.0])


def test_readings_enter_expressions_with_gain_and_offset() -> None:
    sensors = {
        "a": {
            "measures": "2*gyroscope(arm) + phi'",
            "unit": "rad/s",
            "gain": 0.5,
            "offset": {"value": 0.25, "unit": "rad/s"},
        },
    }
    assert shown(arm(sensors), ([0, 0], [0, 1.5], [0, 0])) == pytest.approx([0.5 * 4.5 + 0.25])


def test_a_force_from_outside_is_no_part_of_a_reaction() -> None:
    """sensed(w): a test force takes over what the rig would have to do."""
    model = model_of(
        coordinates={"x": {"unit": "m", "imposed": True}},
        parameters={"m": (2.0, "kg")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        sensors={"cell": {"measures": "reaction(x)", "unit": "N"}},
    )
    machine = build(model)
    arguments = (0.1, 0.2, 3.0, [], [], 0, machine.values)
    assert value(machine.outputs, *arguments) == pytest.approx([6.0])
    assert value(machine.sensed, *arguments, 1.5) == pytest.approx([4.5])
