"""An inertia that turns with a body: it is that of a ball fixed to the body, in the plane, about
axes in space, and by a quaternion."""

import re

import numpy as np
import pytest

from symhyb.discrepancy.places.points import point_hypotheses
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.types import At
from symhyb.numeric.lowered.machine import Machine, build

PLANE = """symhyb = 1
[coordinates]
a = { unit = "rad" }
b = { unit = "rad" }
[parameters]
m = { value = 1.3, unit = "kg" }
l = { value = 0.7, unit = "m" }
J = { value = 0.05, unit = "kg*m^2" }
[bodies.upper]
mass = "m"
at = ["l*sin(a)", "-l*cos(a)"]
inertia = "J"
angle = "a"
[bodies.fore]
mass = "m"
at = ["l*sin(a) + l*sin(a + b)", "-l*cos(a) - l*cos(a + b)"]
inertia = "J"
angle = "a + b"
[points]
hand = { body = "fore", at = ["0.2 m", "0.1 m"] }
[sensors]
sa = { measures = "a", unit = "rad" }
sb = { measures = "b", unit = "rad" }
"""
SPACE = """symhyb = 1
gravity = ["0", "0", "-9.81 m/s^2"]
[coordinates]
a = { unit = "rad" }
b = { unit = "rad" }
c = { unit = "rad" }
[parameters]
m = { value = 1.3, unit = "kg" }
l = { value = 0.4, unit = "m" }
J = { value = 0.03, unit = "kg*m^2" }
K = { value = 0.05, unit = "kg*m^2" }
[bodies.column]
joint = ["0", "0", "0"]
mass = "m"
at = ["0", "0", "l"]
inertia = ["J", "J", "J"]
rotations = [["z", "a"]]
[bodies.upper]
parent = "column"
joint = ["0", "0", "l"]
mass = "m"
at = ["l", "0", "0"]
inertia = ["J", "K", "K"]
rotations = [["y", "b"]]
[bodies.fore]
parent = "upper"
joint = ["l", "0", "0"]
mass = "m"
at = ["0", "l", "0"]
inertia = ["J", "K", "K"]
rotations = [["x", "c"]]
[points]
hand = { body = "fore", at = ["0.2 m", "0.1 m", "0"] }
[sensors]
sa = { measures = "a", unit = "rad" }
sb = { measures = "b", unit = "rad" }
sc = { measures = "c", unit = "rad" }
"""
MORE = """
[elements.more]
kind = "added_inertia"
at = "hand"
inertia = "0.02 kg*m^2"
"""


def with_a_ball(text: str) -> str:
    """The same tensor on the body itself."""
    head, _, tail = text.partition("[bodies.fore]")
    larger = re.sub(r'inertia = ".*"|inertia = \[.*\]', _plus, tail, count=1)
    return f"{head}[bodies.fore]{larger}"


def _plus(found: re.Match[str]) -> str:
    return re.sub(r'"([JK])"', r'"\1 + 0.02 kg*m^2"', found.group())


def accelerations(machine: Machine, seed: int) -> np.ndarray:
    """M⁻¹(k_e − k_c) at a random state."""
    random = np.random.default_rng(seed)
    q, v = random.uniform(-1.5, 1.5, (2, machine.n))
    mass = np.array(machine.M(q, 0, machine.values))
    k_c = np.array(machine.k_c(q, v, 0, machine.values)).ravel()
    k_e = np.array(machine.k_e(q, v, [], [], 0, machine.values)).ravel()
    return np.linalg.solve(mass, k_e - k_c)


@pytest.mark.parametrize("text", [PLANE, SPACE], ids=["plane", "space"])
def test_it_is_the_inertia_of_a_ball_that_is_fixed_to_the_body(text: str) -> None:
    added, ball = build(parse_model(text + MORE)), build(parse_model(with_a_ball(text)))
    for seed in range(4):
        expected = accelerations(ball, seed)
        assert accelerations(added, seed) == pytest.approx(expected, rel=1e-9, abs=1e-9)
        assert accelerations(build(parse_model(text)), seed) != pytest.approx(expected, rel=1e-3)


def test_it_is_tried_on_bodies_that_turn_in_their_own_way() -> None:
    random = np.random.default_rng(2)
    pad = 'pad = { body = "upper", at = ["l", "0"] }'  # turns as the coordinate a does
    tip = 'tip = { body = "fore", at = ["0.3 m", "0"] }'  # as the hand does
    plane = PLANE.replace("[sensors]", f"{pad}\n{tip}\n[sensors]")
    for text in (plane, SPACE):
        model = parse_model(text)
        q, v = random.standard_normal((2, 50, len(model.coordinates)))
        tried = point_hypotheses(model, [(q, v, np.linspace(0, 1, 50))], 1e-3)
        assert {h.place for h in tried if h.kind == "added_inertia"} == {At("hand")}


def test_it_needs_a_body_that_turns() -> None:
    loose = PLANE.replace('{ body = "fore", at = ["0.2 m", "0.1 m"] }', '["0.2 m", "0.1 m"]')
    with pytest.raises(InputError, match="fixed to no body, so an inertia there turns nothing"):
        parse_model(loose + MORE)
    wrong = MORE.replace("0.02 kg*m^2", "0.02 kg")
    with pytest.raises(InputError, match=r"kg\*m\^2"):
        parse_model(PLANE + wrong)
