"""Chains of bodies against MuJoCo, which has its own kinematics, mass matrix and bias forces.

Its chains are built from the numbers of the model files, read without symhyb. M and k_c come from
MuJoCo without gravity, k_e from its gravity, joint damping and applied forces; whole runs from its
Runge-Kutta method at two step widths, extrapolated (Richardson).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from shipped import close, machine_of, start_of
from textbook import Array, numbers

from symhyb.model.read import parse_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

SPECK = 1e-14  # kg·m²: MuJoCo refuses a body without inertia


@dataclass(frozen=True)
class Link:
    """A body hung on the one before at ``at`` (m, in its axes), first ``turned`` (rad) and then
    moved by its ``joint``: a slide along x, a hinge, or none."""

    joint: str
    at: tuple[float, float]
    mass: float
    centre: tuple[float, float] = (0.0, 0.0)
    inertia: float = SPECK
    damping: float = 0.0
    turned: float = 0.0


AXES = {"slide": "1 0 0", "hinge": "0 0 1"}


def engine(links: Sequence[Link], tip: tuple[float, float] | None = None) -> mujoco.MjModel:
    """MuJoCo's model of a chain in the plane of x and y, gravity along −y; at the ``tip`` of its
    last body an accelerometer and a gyroscope."""
    text, closing, sensors = "", "", ""
    for link in links:
        text += f'<body pos="{link.at[0]!r} {link.at[1]!r} 0" euler="0 0 {link.turned!r}">'
        if link.joint:
            text += f'<joint type="{link.joint}" axis="{AXES[link.joint]}" '
            text += f'damping="{link.damping!r}"/>'
        size = " ".join([repr(link.inertia)] * 3)
        text += f'<inertial pos="{link.centre[0]!r} {link.centre[1]!r} 0" '
        text += f'mass="{link.mass!r}" diaginertia="{size}"/>'
        closing += "</body>"
    if tip is not None:
        text += f'<site name="tip" pos="{tip[0]!r} {tip[1]!r} 0"/>'
        sensors = '<accelerometer site="tip"/><gyro site="tip"/>'
    return mujoco.MjModel.from_xml_string(
        '<mujoco><compiler angle="radian"/><option gravity="0 -9.81 0" integrator="RK4"/>'
        f"<worldbody>{text}{closing}</worldbody><sensor>{sensors}</sensor></mujoco>"
    )


def double_pendulum(p: Mapping[str, float]) -> list[Link]:
    down = -np.pi / 2
    return [
        Link("hinge", (0.0, 0.0), p["m_1"], (p["a_1"], 0.0), p["J_1"], turned=down),
        Link("hinge", (p["l"], 0.0), p["m_2"], (p["a_2"], 0.0), p["J_2"]),
    ]


def triple_pendulum(p: Mapping[str, float]) -> list[Link]:
    rod = p["m"], (p["l"] / 2, 0.0), p["m"] * p["l"] ** 2 / 12, p["d"]
    return [Link("hinge", (at, 0.0), *rod) for at in (0.0, p["l"], p["l"])]


def pendulum_on_cart(p: Mapping[str, float]) -> list[Link]:
    upper, lower = ((p[f"m_{i}"], (0.0, -p[f"l_{i}"] / 2)) for i in (1, 2))
    return [
        Link("slide", (0.0, 0.0), p["m_c"]),
        Link("hinge", (0.0, 0.0), *upper, p["m_1"] * p["l_1"] ** 2 / 12),
        Link("hinge", (0.0, -p["l_1"]), *lower, p["m_2"] * p["l_2"] ** 2 / 12),
        Link("", (0.0, -p["l_2"]), p["load"]),
    ]


def two_link_arm(p: Mapping[str, float]) -> list[Link]:
    return [
        Link("hinge", (0.0, 0.0), p["m_1"], (p["a_1"], 0.0), p["J_1"], p["d_1"]),
        Link("hinge", (p["l_1"], 0.0), p["m_2"], (p["a_2"], 0.0), p["J_2"], p["d_2"]),
        Link("", (p["l_2"], 0.0), p["load"]),
    ]


CHAINS = (double_pendulum, triple_pendulum, pendulum_on_cart, two_link_arm)
UNKNOWN = {"F_c": 0.0, "b": 0.0}  # forces of the cart and its load that MuJoCo does not have


def known(machine: Machine) -> Array:
    """The parameters (P,) without the forces that MuJoCo does not have."""
    names = [item.name for item in machine.model.parameters]
    return np.array([UNKNOWN.get(n, v) for n, v in zip(names, machine.values, strict=True)])


def mass_and_forces(m: mujoco.MjModel, q: Array, v: Array, f: Array) -> tuple[Array, Array, Array]:
    """M (n, n), k_c and k_e (n,) by MuJoCo under the joint forces f (n,)."""
    data, pull = mujoco.MjData(m), m.opt.gravity.copy()
    data.qpos[:], data.qvel[:] = q, v
    mass = np.zeros((m.nv, m.nv))
    m.opt.gravity[:] = 0
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, mass)
    k_c, damped = data.qfrc_bias.copy(), data.qfrc_passive.copy()
    m.opt.gravity[:] = pull
    data.qvel[:] = 0
    mujoco.mj_forward(m, data)
    return mass, k_c, f + damped - data.qfrc_bias


def agree(machine: Machine, m: mujoco.MjModel, total: int, pushed: Sequence[int]) -> None:
    """Compare at ``total`` random states; the inputs are joint forces on coordinates ``pushed``."""
    rng, n, p = np.random.default_rng(11), machine.n, known(machine)
    pairs: list[list[tuple[Array, Array]]] = [[], [], []]
    for _ in range(total):
        q, v, f = rng.normal(size=(3, n)) * np.array([[2.0], [5.0], [5.0]])
        u = f[list(pushed)]
        f = np.where(np.isin(np.arange(n), pushed), f, 0.0)
        found = (
            call(machine.M, (q, 0, p))[0],
            call(machine.k_c, (q, v, 0, p))[0][0],
            call(machine.k_e, (q, v, np.empty(0), u, 0, p))[0][0],
        )
        for pair, *both in zip(pairs, found, mass_and_forces(m, q, v, f), strict=True):
            pair.append((both[0], both[1]))
    size = float(np.abs([wanted for _, wanted in pairs[2]]).max())
    for what, pair, floor in zip(("M", "k_c", "k_e"), pairs, (0.0, 0.0, 1e-13 * size), strict=True):
        ours, theirs = (np.array(each) for each in zip(*pair, strict=True))
        assert close(ours, theirs, 1e-9, floor), what


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: chain.__name__)
def test_chains_agree_with_mujoco_at_random_states(chain: object) -> None:
    assert callable(chain)
    machine = machine_of(chain.__name__)
    pushed = {"pendulum_on_cart": [0], "two_link_arm": [0, 1]}.get(chain.__name__, [])
    agree(machine, engine(chain(numbers(chain.__name__))), 1000, pushed)


def test_an_inertial_sensor_at_the_toe_shows_what_that_of_mujoco_shows() -> None:
    p, machine = numbers("triple_pendulum"), machine_of("triple_pendulum")
    m = engine(triple_pendulum(p), (p["l"], 0.0))
    data, rng, still = mujoco.MjData(m), np.random.default_rng(12), np.zeros(0)
    pairs = []
    for _ in range(200):
        q, v = rng.normal(size=(2, 3)) * np.array([[2.0], [5.0]])
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(m, data)
        here = (q, v, still, still, 0, machine.values)
        a = call(machine.acceleration, (*here, np.zeros(3), still))[0][0]
        y = call(machine.outputs, (q, v, a, still, still, 0, machine.values))[0][0]
        pairs.append((y[1:], data.sensordata[[0, 1, 5]].copy()))
    shown, wanted = (np.array(each) for each in zip(*pairs, strict=True))
    assert close(shown, wanted, 1e-9)


def stepped(m: mujoco.MjModel, q: Array, end: float, steps: int) -> Array:
    """q (n,) after ``end`` seconds at rest from q, in equal Runge-Kutta steps."""
    m.opt.timestep = end / steps
    data = mujoco.MjData(m)
    data.qpos[:] = q
    for _ in range(steps):
        mujoco.mj_step(m, data)
    return np.array(data.qpos)


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: chain.__name__)
def test_runs_of_chains_agree_with_the_converged_run_of_mujoco(chain: object) -> None:
    assert callable(chain)
    name, end = chain.__name__, 1.5
    machine, m, start = machine_of(name), engine(chain(numbers(name))), start_of(name)
    coarse, fine = (stepped(m, start, end, steps) for steps in (1500, 3000))
    limit = fine + (fine - coarse) / 15
    idle = np.zeros((2, len(machine.model.inputs)))
    scenario = Scenario(np.array([0.0, end]), start, np.zeros(machine.n), np.array([0, end]), idle)
    run = simulate(machine, scenario, known(machine))
    assert run.complete, run.reason
    moved = np.abs(limit - start).max()
    assert np.abs(limit - fine).max() < 1e-8 * moved  # MuJoCo has converged
    assert np.abs(run.q[-1] - limit).max() < 1e-6 * moved
    assert moved > 0.5


def long_chain(links: int) -> tuple[str, list[Link]]:
    """A cart with a chain of unequal rods, as a model file and as links for MuJoCo."""
    q = "\n".join(f'q{i} = {{ unit = "rad" }}' for i in range(1, links + 1))
    joints, bodies, built = "", "", [Link("slide", (0.0, 0.0), 2.0)]
    at = 0.0
    for i in range(1, links + 1):
        length, mass = 0.2 + 0.03 * i, 0.5 - 0.04 * i
        joints += f'end{i} = {{ body = "rod{i}", at = ["{length!r}*unit", "0"] }}\n'
        hung = 'joint = ["x", "0"]' if i == 1 else f'parent = "rod{i - 1}"\njoint = "end{i - 1}"'
        bodies += f"""
[bodies.rod{i}]
{hung}
mass = "{mass!r}*one"
at = ["{length / 2!r}*unit", "0"]
inertia = "{mass * length**2 / 12!r}*one*unit**2"
angle = "q{i}"
"""
        centre, inertia = (length / 2, 0.0), mass * length**2 / 12
        built.append(Link("hinge", (at, 0.0), mass, centre, inertia))
        at = length
    return (
        f"""symhyb = 1
title = "chain on a cart"
gravity = ["0", "-9.81*unit/time**2"]
[coordinates]
x = {{ unit = "m" }}
{q}
[parameters]
one = {{ value = 1, unit = "kg" }}
unit = {{ value = 1, unit = "m" }}
time = {{ value = 1, unit = "s" }}
[points]
{joints}
[bodies.cart]
mass = "2*one"
at = ["x", "0"]
{bodies}
[sensors]
cart = {{ measures = "x", unit = "m" }}
""",
        built,
    )


def test_eight_links_on_a_cart_agree_with_mujoco() -> None:
    text, links = long_chain(8)
    agree(build(parse_model(text)), engine(links), 1000, [])
