"""A four-bar linkage drawn in space moves as the one of models/four_bar.toml in the plane."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.model.read import parse_model, read_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.linear import free_slope
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

MODEL = Path(__file__).parents[2] / "models" / "four_bar.toml"


def in_space(turned: str = "", gravity: str = '"0", "-g", "0"', offset: str = "0") -> str:
    """The same file with three components: all hinges about z, behind a rotation of the whole."""
    text = MODEL.read_text(encoding="utf-8")
    text = text.replace('["0", "-g"]', f"[{gravity}]")
    text = re.sub(r'= \["([^"]+)", "0"\]', r'= ["\1", "0", "0"]', text)
    text = re.sub(r'inertia = "(J_.)"', r'inertia = ["0.5*\1", "\1", "\1"]', text)
    for name in ("alpha", "gamma"):
        text = text.replace(f'angle   = "{name}"', f'rotations = [{turned}["z", "{name}"]]')
    text = text.replace('angle   = "beta"', 'rotations = [["z", "beta"]]')
    return text.replace('joint   = ["d", "0", "0"]', f'joint = ["d", "0", "{offset}"]')


def run(machine: Machine) -> Trajectory:
    q, v = (np.array(part) for part in machine.model.start())
    t = np.linspace(0, 1.5, 151)
    return simulate(machine, Scenario(t, q, v, t, 0.05 * np.sin(5 * t)[:, None]))


@cache
def plane() -> Trajectory:
    return run(build(read_model(MODEL)))


TURNS = {
    "flat": ("", '"0", "-g", "0"'),
    "upright": ('["x", "pi/2"], ', '"0", "0", "-g"'),  # the second axis of the plane is z
    "tilted": ('["x", "0.4"], ', '"0", "-g*cos(0.4)", "-g*sin(0.4)"'),
}


@pytest.mark.parametrize("which", TURNS)
def test_it_moves_as_in_the_plane(which: str) -> None:
    """Of the three rows of its pin one says nothing beside the others."""
    machine = build(parse_model(in_space(*TURNS[which])))
    assert machine.constraints == 2
    found, flat = run(machine), plane()
    assert found.complete
    np.testing.assert_allclose(found.q, flat.q, atol=2e-6)
    np.testing.assert_allclose(found.v, flat.v, atol=5e-5)


def test_what_is_left_out_is_said() -> None:
    machine = build(parse_model(in_space()))
    said = "constraints.knee.z is zero wherever the machine moves and is left out"
    assert said in machine.notes
    assert said in build(parse_model(in_space(*TURNS["upright"]))).notes


def on_a_turntable() -> str:
    text = in_space(*TURNS["upright"])
    text = text.replace("[bodies.crank]", TURNTABLE + "[bodies.crank]\nparent = 'table'")
    text = text.replace('joint = ["d"', "parent = 'table'\njoint = [\"d\"")
    return text.replace("[parameters]", "psi = { unit = 'rad', start_rate = 3.0 }\n[parameters]")


TURNTABLE = """[bodies.table]
joint     = ["0", "0", "0"]
mass      = "m_1"
inertia   = "J_1"
rotations = [["z", "psi"]]

"""


def momentum(machine: Machine, found: Trajectory, coordinate: int) -> np.ndarray:
    """Of a coordinate that nothing but inertia acts along."""
    masses = [call(machine.M, (q, 0.0, machine.values))[0] for q in found.q]
    return np.array([(M @ v)[coordinate] for M, v in zip(masses, found.v, strict=True)])


def test_the_plane_of_a_loop_may_turn_right_round() -> None:
    """Across a plane that turns lies no axis of the room; the momentum about z stays."""
    machine = build(parse_model(on_a_turntable()))
    assert "constraints.knee.z is zero wherever the machine moves and is left out" in machine.notes
    found = run(machine)
    assert (found.complete, found.note) == (True, "")
    assert np.ptp(found.q[:, 3]) > np.pi
    np.testing.assert_allclose(momentum(machine, found, 3), momentum(machine, found, 3)[0], 1e-6)


def test_a_line_may_turn_right_round() -> None:
    """A bead on a spoke of a wheel that turns about z."""
    text = """symhyb = 1
gravity = ["0", "0", "-9.81 m/s^2"]
[coordinates]
phi = { unit = "rad", start_rate = 5.0 }
x = { unit = "m", start = 0.1 }
y = { unit = "m" }
z = { unit = "m" }
[points]
hub = { body = "wheel", at = ["0", "0", "0"] }
rim = { body = "wheel", at = ["1 m", "0", "0"] }
bead = ["x", "y", "z"]
[bodies.wheel]
joint = ["0", "0", "0"]
mass = "1 kg"
inertia = "0.5 kg*m^2"
rotations = [["z", "phi"]]
[bodies.bead]
mass = "0.2 kg"
at = "bead"
[constraints.spoke]
kind = "slider"
point = "bead"
along = ["hub", "rim"]
[sensors]
turn = { measures = "phi", unit = "rad" }
"""
    machine = build(parse_model(text))
    assert machine.constraints == 2
    q, v = (np.array(part) for part in machine.model.start())
    t = np.linspace(0, 0.6, 61)
    found = simulate(machine, Scenario(t, q, v, t[[0, -1]], np.empty((2, 0))))
    assert found.complete
    assert found.q[-1, 0] > np.pi / 2
    radius, rate = np.hypot(found.q[:, 1], found.q[:, 2]), found.v[:, 0]
    np.testing.assert_allclose((0.5 + 0.2 * radius**2) * rate, (0.5 + 0.2 * 0.1**2) * 5, 1e-6)
    np.testing.assert_allclose(
        np.arctan2(found.q[:, 2], found.q[:, 1]), found.q[:, 0] % (2 * np.pi), atol=1e-9
    )


def test_it_swings_as_in_the_plane_when_it_is_linearised() -> None:
    roots = []
    for model in (read_model(MODEL), parse_model(in_space(*TURNS["upright"]))):
        machine = build(model)
        form, (q, _) = state_form(machine), machine.model.start()
        x = np.array([*q, 0.0, 0.0, 0.0])
        slope = free_slope(form, x, np.zeros(1), 0.0, machine.values)
        roots.append(np.sort_complex(np.linalg.eigvals(slope)))
    np.testing.assert_allclose(roots[1], roots[0], rtol=1e-6, atol=1e-6)


def test_a_loop_whose_ends_lie_in_two_planes_cannot_close() -> None:
    with pytest.raises(InputError) as caught:
        build(parse_model(in_space(offset="d/10")))
    (problem,) = caught.value.problems
    assert problem.place == "constraints.knee"
    assert "nothing moves along knee.z, and there it is off by 0.022 (SI)" in problem.text


def tilted(angle: str) -> str:
    """The rocker turns about an axis that is not quite that of the crank."""
    return in_space().replace('[["z", "gamma"]]', f'[["x", "{angle}"], ["z", "gamma"]]')


def test_hinges_that_are_nearly_parallel_move_as_in_the_plane() -> None:
    """As where a file has 1.5708 for a right angle: to the last digit the loop would lock."""
    machine = build(parse_model(tilted("1e-4")))
    assert machine.constraints == 2
    said = "constraints.knee.z is nearly zero wherever the machine moves and is left out"
    assert said in machine.notes
    found, flat = run(machine), plane()
    assert found.complete
    np.testing.assert_allclose(found.q, flat.q, atol=5e-6)
    with pytest.raises(InputError, match=r"constraints\.knee: the loop cannot be closed"):
        build(parse_model(tilted("1e-2")))


def test_a_part_that_is_driven_holds_nothing_that_could_give_way() -> None:
    with pytest.raises(InputError, match=r"constraints\.knee: holds nothing that is free to move"):
        build(parse_model(in_space(offset="0.001*d*sin(t/(1 s))")))


def test_a_slider_in_a_plane_of_space_is_held_beside_its_line() -> None:
    """Two of the three rows of a line in space are zero: the pendulum swings from its rail."""
    text = """symhyb = 1
gravity = ["0", "-9.81 m/s^2", "0"]
[coordinates]
x = { unit = "m", start_rate = 0.3 }
y = { unit = "m" }
phi = { unit = "rad", start = 0.5 }
[points]
a = ["0", "0", "0"]
b = ["1 m", "0", "0"]
hub = ["x", "y", "0"]
bob = ["x + 0.4 m * sin(phi)", "y - 0.4 m * cos(phi)", "0"]
[bodies.cart]
mass = "1 kg"
at = "hub"
[bodies.bob]
mass = "0.5 kg"
at = "bob"
[constraints.rail]
kind = "slider"
point = "hub"
along = ["a", "b"]
[sensors]
place = { measures = "x", unit = "m" }
"""
    machine = build(parse_model(text))
    assert machine.constraints == 1
    q, v = (np.array(part) for part in machine.model.start())
    t = np.linspace(0, 2, 201)
    found = simulate(machine, Scenario(t, q, v, t[[0, -1]], np.empty((2, 0))))
    assert np.abs(found.q[:, 1]).max() < 1e-9
    x, phi = found.q[:, 0], found.q[:, 2]
    along, turning = found.v[:, 0], found.v[:, 2]
    momentum = 1.5 * along + 0.5 * 0.4 * turning * np.cos(phi)
    np.testing.assert_allclose(momentum, momentum[0], atol=1e-6)
    assert np.ptp(x) > 0.1
