"""Imported robots against recursive Newton-Euler of their URDF, and against MuJoCo."""

from collections.abc import Mapping

import mujoco
import numpy as np
import pytest
from newton_euler import energies, inverse_dynamics
from robots import ARM, drawn, joint, link, robot

from symhyb.imports.deliver import Order, model_of
from symhyb.imports.urdf import parse_urdf
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build

CLOSE = 1e-9  # of the largest


def imported(text: str, order: Order | None = None) -> Machine:
    return build(model_of(parse_urdf(text.encode()), order or Order())[0], keep=False)


def names_of(machine: Machine) -> list[str]:
    return [coordinate.name for coordinate in machine.model.coordinates]


def needed(machine: Machine, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """M a + k_c − k_e without inputs: what the motors have to give."""
    still = np.zeros(len(machine.model.inputs))
    inner = np.zeros(machine.inner_states)
    (forces,) = call(machine.discrepancy, (q, v, a, inner, still, 0.0, machine.values))
    return forces.ravel()


def close(found: np.ndarray, expected: np.ndarray) -> None:
    assert np.abs(found - expected).max() < CLOSE * max(1.0, np.abs(expected).max())


def agree(
    text: str, machine: Machine, seed: int, locked: Mapping[str, float] | None = None
) -> None:
    """Torques of random motions are those of Newton-Euler, coordinate by coordinate."""
    rng, names = np.random.default_rng(seed), names_of(machine)
    for _ in range(3):
        q, v, a = rng.uniform(-2, 2, (3, machine.n))
        given = [dict(zip(names, map(float, x), strict=True)) for x in (q, v, a)]
        given[0].update(locked or {})
        expected = inverse_dynamics(text, *given)
        close(needed(machine, q, v, a), np.array([expected[name] for name in names]))


def test_an_arm_with_every_kind_of_joint_and_skewed_axes() -> None:
    machine = imported(ARM)
    assert names_of(machine) == ["shoulder", "elbow", "reach", "twist", "grip"]
    agree(ARM, machine, 1)


@pytest.mark.parametrize("seed", range(6))
def test_drawn_robots(seed: int) -> None:
    text = drawn(seed)
    agree(text, imported(text), seed)


def test_an_arm_of_which_two_joints_move() -> None:
    order = Order(joints=("elbow", "twist"), at=("shoulder=0.7", "reach=-0.2"))
    machine = imported(ARM, order)
    assert names_of(machine) == ["elbow", "twist"]
    agree(ARM, machine, 2, {"shoulder": 0.7, "reach": -0.2})


def test_joints_that_follow_others() -> None:
    """A mimic turns with ratio and offset: its torque is passed on by its ratio."""
    follow = '<mimic joint="lead" multiplier="-2.5" offset="0.3"/>'
    slide = '<mimic joint="turn" multiplier="0.1"/>'
    text = robot(
        *(link(name) for name in ("base", "a", "b", "c")),
        joint("turn", "revolute", "base", "b", (0.1, 0, 0), (0.2, 0.3, 0), (1, 1, 0), follow),
        joint("lead", "revolute", "base", "a", (0, 0.2, 0), (0.1, 0, 0.4), (0, 1, 0)),
        joint("slide", "prismatic", "a", "c", (0, 0.2, 0), (0.1, 0, 0.4), (0, 2, 1), slide),
    )
    machine = imported(text)
    assert names_of(machine) == ["lead"]
    rng = np.random.default_rng(3)
    for q, v, a in rng.uniform(-2, 2, (3, 3)):
        ratios = {"lead": 1.0, "turn": -2.5, "slide": -0.25}
        offsets = {"lead": 0.0, "turn": 0.3, "slide": 0.03}
        at = {name: ratio * q + offsets[name] for name, ratio in ratios.items()}
        rates, pulls = ({name: ratio * x for name, ratio in ratios.items()} for x in (v, a))
        torques = inverse_dynamics(text, at, rates, pulls)
        expected = sum(ratio * torques[name] for name, ratio in ratios.items())
        close(needed(machine, *np.array([[q], [v], [a]])), np.array([expected]))


def test_losses_act_on_their_joints() -> None:
    """Damping and dry friction resist, those of a joint that follows times its ratio."""
    losses = '<dynamics damping="2.0" friction="0.5"/>'
    follow = '<dynamics damping="3.0"/><mimic joint="lead" multiplier="2" offset="0.1"/>'
    text = robot(
        *(link(name) for name in ("base", "a", "b")),
        joint("lead", "revolute", "base", "a", more=losses),
        joint("turn", "revolute", "base", "b", more=follow),
    )
    machine, v = imported(text), 0.7
    motion = {"lead": v, "turn": 2 * v}
    torques = inverse_dynamics(text, {"lead": 0.2, "turn": 0.5}, motion, {})
    free = torques["lead"] + 2 * torques["turn"]
    expected = free + 2.0 * v + 0.5 + 2 * 3.0 * 2 * v
    close(needed(machine, *np.array([[0.2], [v], [0.0]])), np.array([expected]))


def test_against_mujoco() -> None:
    """MuJoCo reads the same URDF with its own reader."""
    bodies = mujoco.MjModel.from_xml_string(ARM)
    state = mujoco.MjData(bodies)
    machine = imported(ARM)
    names = [bodies.joint(k).name for k in range(bodies.njnt)]
    assert names == names_of(machine)
    rng = np.random.default_rng(4)
    for q, v, a in rng.uniform(-2, 2, (3, 3, machine.n)):
        state.qpos[:], state.qvel[:], state.qacc[:] = q, v, a
        mujoco.mj_inverse(bodies, state)
        close(needed(machine, q, v, a), state.qfrc_inverse)


def energy(machine: Machine, q: np.ndarray, v: np.ndarray) -> tuple[float, float]:
    kinetic, potential, _ = call(machine.energy, (q, v, np.zeros(0), 0.0, machine.values))
    return kinetic.item(), potential.item()


SLIDES = (("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1)))


def spread(
    kind: str, axis: tuple[float, ...], steps: tuple[tuple[str, tuple[float, ...]], ...]
) -> tuple[str, str]:
    """A robot whose joint is of a ``kind`` with several coordinates, and the same of plain joints,
    ``steps`` of travel and a turn about ``axis`` at the end."""
    origin = ((0.1, 0.2, 0.3), (0.4, -0.5, 0.6))
    ends = (link("base"), link("cart", 2.0), link("pole", 0.5))
    pole = joint("pole", "revolute", "cart", "pole", (0.1, 0.1, 0), (0.3, 0, 0.1), (1, 0, 1))
    whole = robot(*ends, joint("move", kind, "base", "cart", *origin, axis), pole)
    plain = [joint("origin", "fixed", "base", "s", *origin), '<link name="s"/>']
    last = "s"
    for name, way in steps:
        plain += [joint(name, "prismatic", last, f"s{name}", axis=way), f'<link name="s{name}"/>']
        last = f"s{name}"
    plain.append(joint("turn", "continuous", last, "cart", axis=axis))
    return whole, robot(*ends, *plain, pole)


@pytest.mark.parametrize(
    ("axis", "ways"),
    [
        ((0, 0, 1), ((1, 0, 0), (0, 1, 0))),
        ((0, 1, 0), ((0, 0, 1), (1, 0, 0))),
        ((1, 0, 0), ((0, 1, 0), (0, 0, 1))),
    ],
)
def test_a_planar_joint_travels_across_its_axis(
    axis: tuple[float, ...], ways: tuple[tuple[float, ...], ...]
) -> None:
    whole, plain = spread("planar", axis, (("x", ways[0]), ("y", ways[1])))
    machine, rng = imported(whole), np.random.default_rng(5)
    assert names_of(machine) == ["move_x", "move_y", "move_angle", "pole"]
    names = ("x", "y", "turn", "pole")
    for q, v, a in rng.uniform(-2, 2, (3, 3, 4)):
        given = [dict(zip(names, map(float, x), strict=True)) for x in (q, v, a)]
        expected = inverse_dynamics(plain, *given)
        close(needed(machine, q, v, a), np.array([expected[name] for name in names]))


def test_a_floating_joint_has_a_place_and_a_quaternion() -> None:
    """Turned by q about x of the joint's frame, at x, y, z in the axes of the parent."""
    ends = ('<link name="base"/>', link("body"), link("pole"))
    text = robot(
        *ends,
        joint("free", "floating", "base", "body", (0.1, 0.2, 0.3), (0.4, -0.5, 0.6)),
        joint("pole", "revolute", "body", "pole", (0.1, 0.1, 0), (0.3, 0, 0.1), (1, 0, 1)),
    )
    plain = robot(
        *ends,
        *(f'<link name="s{name}"/>' for name in "xyz"),
        joint("x", "prismatic", "base", "sx", (0.1, 0.2, 0.3), axis=(1, 0, 0)),
        joint("y", "prismatic", "sx", "sy", axis=(0, 1, 0)),
        joint("z", "prismatic", "sy", "sz", axis=(0, 0, 1)),
        joint("turn", "continuous", "sz", "body", rpy=(0.4, -0.5, 0.6), axis=(1, 0, 0)),
        joint("pole", "revolute", "body", "pole", (0.1, 0.1, 0), (0.3, 0, 0.1), (1, 0, 1)),
    )
    machine = imported(text)
    names = names_of(machine)
    assert names == [*(f"free_{part}" for part in ("x", "y", "z", "qw", "qx", "qy", "qz")), "pole"]
    q, v = (np.array(part) for part in machine.model.start())
    start = q[3:7]
    for place, rate, pole in np.random.default_rng(6).uniform(-1, 1, (3, 3, 3)):
        angle, spin = pole[1:]
        turn, half = np.array([np.cos(angle / 2), np.sin(angle / 2), 0, 0]), spin / 2
        change = half * np.array([-turn[1], turn[0], 0, 0])
        q = np.array([*place, *_times(start, turn), pole[0]])
        v = np.array([*rate, *_times(start, change), 0.4])
        at = {**dict(zip("xyz", map(float, place), strict=True)), "turn": angle, "pole": pole[0]}
        way = {**dict(zip("xyz", map(float, rate), strict=True)), "turn": spin, "pole": 0.4}
        close(np.array(energy(machine, q, v)), np.array(energies(plain, at, way)))


def _times(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The product of two quaternions, scalar part first."""
    w, x, y, z = left
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ right


def test_a_floating_base_falls() -> None:
    text = robot(link("base", 2.0), link("arm"), joint("swing", "revolute", "base", "arm"))
    machine = imported(text, Order(floating=True))
    assert names_of(machine)[:3] == ["base_x", "base_y", "base_z"]
    q, v = (np.array(part) for part in machine.model.start())
    still = np.zeros(len(machine.model.inputs))
    given = (q, v, np.zeros(0), still, 0.0, machine.values, np.zeros(machine.n), np.zeros(0))
    (falling,) = call(machine.acceleration, given)
    assert falling.ravel() == pytest.approx([0, 0, -9.81, *[0] * 5], abs=1e-9)
