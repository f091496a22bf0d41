"""Model files in space: what is read and written, and every mistake with its cure."""

import re

import pytest

from symhyb.errors import InputError
from symhyb.limits import HANGING_DEEP
from symhyb.model.diff import changes
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.space import dimension
from symhyb.model.turned import Quaternion, Rotations
from symhyb.numeric.lowered.machine import build

TOP = """symhyb = 1
title = "top"
gravity = ["0", "0", "-g"]
[coordinates]
psi = { unit = "rad" }
theta = { unit = "rad", start = 0.5 }
phi = { unit = "deg" }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 0.5, unit = "kg" }
l = { value = 0.1, unit = "m" }
A = { value = 1e-3, unit = "kg*m^2" }
C = { value = 5e-4, unit = "kg*m^2" }
[points]
foot = ["0", "0", "0"]
tip = { body = "top", at = ["0", "0", "2*l"] }
[bodies.top]
joint = "foot"
mass = "m"
at = ["0", "0", "l"]
inertia = ["A", "A", "C"]
rotations = [["z", "psi"], ["x", "theta"], ["z", "phi"]]
[elements.hand]
kind = "force"
at = "tip"
force = ["m*g", "0", "0"]
axes = "top"
[elements.motor]
kind = "torque"
at = "tip"
torque = ["0", "0", "m*g*l"]
[sensors]
w = { measures = "gyroscope_z(top)", unit = "rad/s" }
a = { measures = "accelerometer_z(tip, top)", unit = "m/s^2" }
"""
BIRD = """symhyb = 1
title = "a body that tumbles"
[coordinates]
qw = { unit = "1", start = 0.6 }
qx = { unit = "1", start = 0.8 }
qy = { unit = "1" }
qz = { unit = "1" }
[parameters]
m = { value = 0.5, unit = "kg" }
J = { value = 1e-3, unit = "kg*m^2" }
[bodies.bird]
mass = "m"
at = ["0", "0", "0"]
inertia = ["J", "J", "J", "J/4", "0", "0"]
quaternion = ["qw", "qx", "qy", "qz"]
[sensors]
w = { measures = "gyroscope_z(bird)", unit = "rad/s" }
"""


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(text, "file")
    return [str(problem) for problem in caught.value.problems]


@pytest.mark.parametrize("text", [TOP, BIRD], ids=["top", "bird"])
def test_a_model_in_space_is_read_and_written(text: str) -> None:
    model = parse_model(text)
    again = parse_model(render(model))
    assert dimension(model) == 3
    assert (again.bodies, again.points) == (model.bodies, model.points)
    assert (again.elements, again.gravity) == (model.elements, model.gravity)
    assert changes(model, again) == ()


def test_how_a_body_is_turned_is_kept() -> None:
    (top,), (bird,) = parse_model(TOP).bodies, parse_model(BIRD).bodies
    assert isinstance(top.turned, Rotations)
    assert [(axis, str(angle)) for axis, angle in top.turned.steps] == [
        ("z", "psi"),
        ("x", "theta"),
        ("z", "phi"),
    ]
    assert bird.turned == Quaternion(("qw", "qx", "qy", "qz"))
    assert [str(part) for part in bird.tensor] == ["J", "J", "J", "J/4", "0", "0"]
    assert [str(part) for part in top.tensor] == ["A", "A", "C"]


def test_a_difference_is_said_in_words() -> None:
    other = TOP.replace('["x", "theta"]', '["y", "theta"]').replace(
        '"A", "A", "C"', '"1.2*A", "A", "C"'
    )
    assert changes(parse_model(TOP), parse_model(other)) == (
        "~ body top: inertia (A, A, C) -> (1.2*A, A, C)",
        "~ body top: rotations z by psi, x by theta, z by phi -> z by psi, y by theta, z by phi",
    )


ONE_FAULT = {
    "mixture": (
        TOP,
        'foot = ["0", "0", "0"]',
        'foot = ["0", "0"]',
        "points.foot: has two components, but gravity has three; a model is in the plane (two)",
    ),
    "mixed force": (
        TOP,
        '["m*g", "0", "0"]',
        '["m*g", "0"]',
        "has two components; the vectors of this model",
    ),
    "four": (TOP, '["0", "0", "l"]', '["0", "0", "0", "l"]', "a list of two expressions"),
    "units": (TOP, '["0", "0", "l"]', '["0", "m", "l"]', "its three components differ: kg and m"),
    "angle": (TOP, "rotations = [", 'angle = "psi"\nrotations = [', "turns a body in the plane"),
    "axis": (TOP, '["x", "theta"]', '["w", "theta"]', "turns about 'x', 'y' or 'z'"),
    "step": (TOP, '["x", "theta"]', '["x"]', "one of its items is a list of 1"),
    "no list": (
        TOP,
        'rotations = [["z", "psi"], ["x", "theta"], ["z", "phi"]]',
        'rotations = "psi"',
        "must be a list of [axis, angle]",
    ),
    "angle unit": (TOP, '["x", "theta"]', '["x", "l*theta"]', "'l*theta' is m*rad, needs 1"),
    "rough": (TOP, '["x", "theta"]', '["x", "abs(theta)"]', "has no smooth speed"),
    "both": (
        TOP,
        "rotations = [",
        'quaternion = ["a", "b", "c", "d"]\nrotations = [',
        "is turned by 'rotations' and by 'quaternion'",
    ),
    "no turn": (
        TOP.replace("gyroscope_z(top)", "psi'"),
        'rotations = [["z", "psi"], ["x", "theta"], ["z", "phi"]]\n',
        "",
        "has 'inertia' but no 'rotations' or 'quaternion'",
    ),
    "no inertia": (
        BIRD,
        'inertia = ["J", "J", "J", "J/4", "0", "0"]\n',
        "",
        "has 'quaternion' but no 'inertia'",
    ),
    "two inertias": (TOP, '["A", "A", "C"]', '["A", "C"]', "one value, three principal"),
    "negative": (TOP, '["A", "A", "C"]', '["A", "-A/10", "C"]', "is not positive definite"),
    "product": (BIRD, '"J/4"', '"1.01*J"', "the principal values are -1e-05"),
    "triangle": (TOP, '["A", "A", "C"]', '["A", "4*A", "C"]', "(triangle inequality)"),
    "inertia unit": (TOP, '["A", "A", "C"]', '["A", "m", "C"]', "'m' is kg, needs kg*m^2"),
    "part": (BIRD, '["qw", "qx"', '["w", "qx"', "'w' is not a coordinate"),
    "twice": (BIRD, '"qy", "qz"]', '"qy", "qy"]', "'qy' is used twice"),
    "three": (BIRD, '["qw", "qx", "qy", "qz"]', '["qx", "qy", "qz"]', "a list of four coordinates"),
    "part unit": (BIRD, 'qy = { unit = "1" }', 'qy = { unit = "m" }', "'qy' is in m, needs 1"),
    "length": (
        BIRD,
        "start = 0.6",
        "start = 1.5",
        "begins at (1.5, 0.8, 0, 0), whose length is 1.7; it must be 1: divide each start",
    ),
    "length beyond what squares hold": (
        BIRD,
        "start = 0.6",
        "start = 1e308",
        "whose length is 1e+308; it must be 1: divide each start by 1e+308",
    ),
    "no length": (
        BIRD.replace("start = 0.8", "start = 0"),
        "start = 0.6",
        "start = 0",
        "start = 1.0 of the first part means: not turned",
    ),
    "axes": (TOP, 'axes = "top"', 'axes = "tip"', "'tip' is not a known body; did you mean 'top'?"),
    "no body": (
        TOP,
        'kind = "torque"\nat = "tip"',
        'kind = "torque"\nat = "foot"',
        "is fixed to no body, so a torque there turns nothing",
    ),
    "torque unit": (TOP, '"m*g*l"]', '"m*g"]', "needs N*m"),
    "gyroscope": (TOP, "gyroscope_z(top)", "gyroscope(top)", "in space it has three axes"),
    "orientation": (TOP, "gyroscope_z(top)", "orientation(top)", "no single angle tells it"),
    "direction": (TOP, "gyroscope_z(top)", "direction(foot, tip)", "in space a direction is"),
}


@pytest.mark.parametrize(("text", "old", "new", "sentence"), ONE_FAULT.values(), ids=ONE_FAULT)
def test_one_fault_in_space_is_one_problem(text: str, old: str, new: str, sentence: str) -> None:
    assert text.count(old) == 1
    (problem,) = problems(text.replace(old, new))
    assert sentence in problem


PLANE = """symhyb = 1
title = "plane"
[coordinates]
x = { unit = "m" }
phi = { unit = "rad" }
[parameters]
m = { value = 0.5, unit = "kg" }
J = { value = 1e-3, unit = "kg*m^2" }
[points]
tip = ["x", "0"]
[bodies.block]
mass = "m"
at = ["x", "0"]
inertia = "J"
angle = "phi"
[elements.hand]
kind = "force"
at = "tip"
force = ["0*m*x/t**2", "0"]
[sensors]
w = { measures = "gyroscope(block)", unit = "rad/s" }
"""
IN_PLANE = {
    "turned": ('angle = "phi"', 'rotations = [["z", "phi"]]', "is for a body in space"),
    "tensor": ('inertia = "J"', 'inertia = ["J", "J", "J"]', "is for a body in space"),
    "torque": (
        'kind = "force"\nat = "tip"\nforce',
        'kind = "torque"\nat = "tip"\ntorque',
        "kind 'torque' cannot stand 'at'; it needs 'on'",
    ),
    "axes": ('at = "tip"', 'at = "tip"\naxes = "block"', "is for forces in space"),
    "gyroscope": ("gyroscope(block)", "gyroscope_z(block)", "in the plane write gyroscope(body)"),
    "three": ('at = ["x", "0"]', 'at = ["x", "0", "0"]', "has three components, but"),
}


@pytest.mark.parametrize(("old", "new", "sentence"), IN_PLANE.values(), ids=IN_PLANE)
def test_what_is_for_space_is_refused_in_the_plane(old: str, new: str, sentence: str) -> None:
    assert any(sentence in problem for problem in problems(PLANE.replace(old, new)))
    assert len(problems(PLANE.replace(old, new))) == 1


def test_gimbal_lock_at_the_start_names_the_angle_and_a_cure() -> None:
    upright = TOP.replace("start = 0.5", "start = 0.0")
    with pytest.raises(InputError) as caught:
        build(parse_model(upright), keep=False)
    (problem,) = caught.value.problems
    assert re.search(r"body 'top' is at gimbal lock: at theta = 0 deg .* psi and phi", str(problem))
    assert "quaternion" in str(problem)
    other = upright.replace('["z", "phi"]', '["y", "phi"]')
    assert build(parse_model(other), keep=False).n == 3
    tilted = other.replace("start = 0.0", "start = 1.5707963267948966")
    with pytest.raises(InputError, match=r"gimbal lock: at theta = 90 deg"):
        build(parse_model(tilted), keep=False)


@pytest.mark.parametrize(("deep", "problems"), [(HANGING_DEEP, 0), (HANGING_DEEP + 5, 1)])
def test_bodies_hang_so_deep_and_no_deeper(deep: int, problems: int) -> None:
    """Declared from the last to the first, so that no order helps."""
    text = 'symhyb = 1\n[coordinates]\na = { unit = "rad" }\n'
    text += '[parameters]\nm = { value = 1, unit = "kg" }\n'
    for k in range(deep, 0, -1):
        parent = f'parent = "b{k - 1}"\n' if k > 1 else ""
        turned = 'mass = "m"\nat = ["0", "0", "0"]\nrotations = [["x", "a"]]\n'
        text += f'[bodies.b{k}]\n{parent}joint = ["0", "0", "0"]\n{turned}'
    if not problems:
        parse_model(text)
        return
    with pytest.raises(InputError, match=f"at most {HANGING_DEEP - 1} are computed") as error:
        parse_model(text)
    assert len(error.value.problems) == problems
