"""Where a body hangs and how it is turned, as expressions."""

from math import pi

import pytest
from robots import joint, link, robot

from symhyb.imports.declare import declare
from symhyb.imports.draft import drafted
from symhyb.imports.hanging import across, hung, position
from symhyb.imports.reduction import reduced
from symhyb.imports.urdf import parse_urdf
from symhyb.model.turned import Rotations
from symhyb.model.types import Body, Model


def model(text: str) -> Model:
    read = parse_urdf(text.encode())
    return declare(read, reduced(read)).model


def bodies(text: str) -> tuple[Body, ...]:
    return model(text).bodies


def hinge(
    axis: tuple[float, ...], rpy: tuple[float, ...] = (0, 0, 0), kind: str = "revolute"
) -> str:
    return robot(link("a"), link("b"), joint("j", kind, "a", "b", (0, 0, 0.5), rpy, axis))


def turns(body: Body) -> list[tuple[str, str]]:
    assert isinstance(body.turned, Rotations)
    return [(axis, angle.text) for axis, angle in body.turned.steps]


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ((0, 0, 1), [("z", "j")]),
        ((0, -2, 0), [("y", "-j")]),
        ((1, 1, 0), [("z", "j_turn"), ("x", "j"), ("z", "-j_turn")]),
        ((1, 0, 1), [("y", "j_turn"), ("z", "j"), ("y", "-j_turn")]),
        ((0, 1, 1), [("x", "j_turn"), ("y", "j"), ("x", "-j_turn")]),
        (
            (1, 1, 1),
            [("z", "j_turn"), ("y", "j_tilt"), ("z", "j"), ("y", "-j_tilt"), ("z", "-j_turn")],
        ),
    ],
)
def test_axes_are_laid_on_x_y_or_z(
    axis: tuple[float, ...], expected: list[tuple[str, str]]
) -> None:
    assert turns(bodies(hinge(axis))[0]) == expected


def test_the_frame_of_a_joint_is_turned_by_yaw_pitch_and_roll() -> None:
    (body,) = bodies(hinge((0, 0, 1), (0.3, -pi / 2, 3.14159265359)))
    assert turns(body) == [("z", "pi"), ("y", "-pi/2"), ("x", "j_roll"), ("z", "j")]
    assert [part.text for part in body.joint or ()] == ["0", "0", "j_oz"]


def test_travel_is_along_an_axis_or_a_unit_vector() -> None:
    (body,) = bodies(hinge((0, 0, -1), kind="prismatic"))
    assert [part.text for part in body.joint or ()] == ["0", "0", "j_oz -j"]
    assert body.turned is None
    assert body.inertia is None
    assert body.tensor == ()  # it never turns
    found = model(hinge((0, 3, 4), kind="prismatic"))
    (body,) = found.bodies
    assert [part.text for part in body.joint or ()] == ["0", "j_dy*j", "j_oz + j_dz*j"]
    values = {one.name: one.value for one in found.parameters}
    assert (values["j_dy"], values["j_dz"]) == pytest.approx((0.6, 0.8))


def test_followers_are_expressions_with_units() -> None:
    def follow(numbers: str) -> str:
        return f'<mimic joint="j" {numbers}/>'

    text = robot(
        *(link(name) for name in "abcde"),
        joint("j", "revolute", "a", "b"),
        joint("k", "revolute", "a", "c", more=follow('multiplier="-1"')),
        joint("m", "revolute", "a", "d", more=follow('multiplier="2" offset="0.5"')),
        joint("s", "prismatic", "a", "e", axis=(0, 0, -1), more=follow('multiplier="0.02"')),
    )
    robot_ = parse_urdf(text.encode())
    moving = reduced(robot_).bodies
    draft = drafted(moving)
    assert [position(draft, body) for body in moving] == [
        "j",
        "-j",
        "m_ratio*j + m_offset",
        "s_ratio*j",
    ]
    units = {one.name: str(one.unit) for one in draft.parameters}
    assert units == {"m_ratio": "1", "m_offset": "rad", "s_ratio": "m/rad"}
    assert hung(draft, moving[3]).at == ["0", "0", "-s_ratio*j"]


def test_two_directions_across_an_axis() -> None:
    first, second = across((0, 0, 1))
    assert (first.tolist(), second.tolist()) == ([1, 0, 0], [0, 1, 0])
    first, second = across((0.6, 0, 0.8))
    assert first @ second == pytest.approx(0)
    assert first @ [0.6, 0, 0.8] == pytest.approx(0)
