"""Models in space against MuJoCo, and against Newton's and Euler's equations written by hand.

MuJoCo's chains are built from the numbers of the model files, read without symhyb. The quadrotor is
written by hand here: forces and torques in the axes of its frame, its attitude by a quaternion.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
import pytest
from shipped import close, machine_of, shipped, start_of
from test_models_against_mujoco import mass_and_forces
from test_models_balances import balance_of, in_other_units
from textbook import Array, numbers

from symhyb.discrepancy.checks.modes import modes_at
from symhyb.model.read import parse_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Triple = tuple[float, float, float]
ZERO: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Solid:
    """A body hung on the one before at ``at`` (m, in its axes) by hinges about its own ``axes``,
    one after the other; ``inertia`` Jxx, Jyy, Jzz, Jxy, Jxz, Jyz about its ``centre``."""

    axes: str
    at: Triple
    mass: float
    centre: Triple
    inertia: tuple[float, ...]
    damping: float = 0.0


def text_of(numbers: Sequence[float]) -> str:
    return " ".join(repr(float(x)) for x in numbers)


AXIS = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def engine(solids: Sequence[Solid], site: tuple[int, Triple]) -> mujoco.MjModel:
    """MuJoCo's model of a chain under gravity along −z, with an accelerometer and a gyroscope at
    the ``site`` of the body of that index."""
    text, closing = "", ""
    for i, solid in enumerate(solids):
        text += f'<body pos="{text_of(solid.at)}">'
        for axis in solid.axes:
            text += f'<joint type="hinge" axis="{AXIS[axis]}" damping="{solid.damping!r}"/>'
        six = (*solid.inertia, 0.0, 0.0, 0.0)[:6]
        text += f'<inertial pos="{text_of(solid.centre)}" mass="{solid.mass!r}" '
        text += f'fullinertia="{text_of(six)}"/>'
        if i == site[0]:
            text += f'<site name="unit" pos="{text_of(site[1])}"/>'
        closing += "</body>"
    return mujoco.MjModel.from_xml_string(
        '<mujoco><option gravity="0 0 -9.81"/>'
        f"<worldbody>{text}{closing}</worldbody>"
        '<sensor><accelerometer site="unit"/><gyro site="unit"/></sensor></mujoco>'
    )


def gyroscope() -> mujoco.MjModel:
    p = numbers("gyroscope")
    cage = Solid("zy", ZERO, p["m_c"], (0, 0, p["l"]), (p["A_c"], p["A_c"], p["C_c"]))
    rotor = Solid("z", (0, 0, p["l"]), p["m_r"], ZERO, (p["A_r"], p["A_r"], p["C_r"]), p["d"])
    return engine([cage, rotor], (0, (p["r"], 0, p["l"])))


def furuta_pendulum() -> mujoco.MjModel:
    p = numbers("furuta_pendulum")
    bar = (p["J_a"] / 10, p["J_a"], p["J_a"])
    arm = Solid("z", ZERO, p["m_a"], (p["c"], 0, 0), bar, p["d_a"])
    rod = (p["J_p"], p["J_p"], p["J_l"])
    pendulum = Solid("x", (p["r"], 0, 0), p["m_p"], (0, 0, -p["a"]), rod, p["d_p"])
    return engine([arm, pendulum], (1, (0, 0, -p["l"])))


def six_joint_arm() -> mujoco.MjModel:
    p = numbers("six_joint_arm")
    j, d = [0.0] + [p[f"J_{i}"] for i in range(1, 7)], [p[f"d_{i}"] for i in range(1, 7)]
    l_3, column = p["l_3"], (j[1], j[1], j[1] / 2, 0, j[1] / 10, 0)
    fore = (j[3] / 6, j[3], j[3], 0, j[3] / 20, 0)
    solids = [
        Solid("z", ZERO, p["m_1"], (p["e"] / 3, 0, p["h"] / 2), column, d[0]),
        Solid(
            "y",
            (p["e"], 0, p["h"]),
            p["m_2"],
            (0, 0, 0.45 * p["l_2"]),
            (j[2], j[2], j[2] / 8),
            d[1],
        ),
        Solid("y", (0, 0, p["l_2"]), p["m_3"], (0.3 * l_3, 0, 0.05 * l_3), fore, d[2]),
        Solid("x", (0.6 * l_3, 0, 0), p["m_4"], (0.2 * l_3, 0, 0), (j[4] / 2, j[4], j[4]), d[3]),
        Solid("y", (0.4 * l_3, 0, 0), p["m_5"], ZERO, (j[5], j[5], j[5] / 2), d[4]),
        Solid("x", (p["l_6"] / 2, 0, 0), p["m_6"], ZERO, (j[6], j[6] / 2, j[6] / 2), d[5]),
        Solid("", (p["l_6"] / 2, 0, 0), p["load"], ZERO, (1e-14,) * 3),
    ]
    return engine(solids, (6, ZERO))


CHAINS = {
    "gyroscope": gyroscope,
    "furuta_pendulum": furuta_pendulum,
    "six_joint_arm": six_joint_arm,
}
PUSHED = {"gyroscope": [], "furuta_pendulum": [0], "six_joint_arm": list(range(6))}


@pytest.mark.parametrize("name", CHAINS)
def test_chains_in_space_agree_with_mujoco_at_random_states(name: str) -> None:
    machine, m, rng = machine_of(name), CHAINS[name](), np.random.default_rng(21)
    n, p, pushed = machine.n, machine.values, PUSHED[name]
    pairs: list[list[tuple[Array, Array]]] = [[], [], []]
    for _ in range(1000):
        q, v, f = rng.normal(size=(3, n)) * np.array([[2.0], [5.0], [5.0]])
        u = f[pushed]
        f = np.where(np.isin(np.arange(n), pushed), f, 0.0)
        found = (
            call(machine.M, (q, 0, p))[0],
            call(machine.k_c, (q, v, 0, p))[0][0],
            call(machine.k_e, (q, v, np.empty(0), u, 0, p))[0][0]
            - call(machine.k_e, (q, 0 * v, np.empty(0), 0 * u, 0, p))[0][0],
        )
        mass, k_c, k_e = mass_and_forces(m, q, v, f)
        weight = mass_and_forces(m, q, 0 * v, 0 * f)[2]
        for pair, ours, theirs in zip(pairs, found, (mass, k_c, k_e - weight), strict=True):
            pair.append((ours, theirs))
        own = call(machine.k_e, (q, 0 * v, np.empty(0), 0 * u, 0, p))[0][0]
        assert own == pytest.approx(weight, rel=1e-9, abs=1e-9 * np.abs(weight).max())
    for what, pair in zip(("M", "k_c", "k_e"), pairs, strict=True):
        ours, theirs = (np.array(each) for each in zip(*pair, strict=True))
        floor = 1e-13 * float(np.abs(theirs).max())
        assert close(ours, theirs, 1e-9, floor), what


def test_the_inertial_unit_on_the_cage_shows_what_that_of_mujoco_shows() -> None:
    machine, m, still = machine_of("gyroscope"), gyroscope(), np.zeros(0)
    data, rng = mujoco.MjData(m), np.random.default_rng(22)
    pairs = []
    for _ in range(300):
        q, v = rng.normal(size=(2, 3)) * np.array([[2.0], [5.0]])
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(m, data)
        here = (q, v, still, still, 0, machine.values)
        a = call(machine.acceleration, (*here, np.zeros(3), still))[0][0]
        y = call(machine.outputs, (q, v, a, still, still, 0, machine.values))[0][0]
        pairs.append((y[[3, 4, 5, 0, 1, 2]], data.sensordata.copy()))
    shown, wanted = (np.array(each) for each in zip(*pairs, strict=True))
    assert close(shown, wanted, 1e-9)


# --- the quadrotor by hand ----------------------------------------------------------------------


def multiplied(a: Array, b: Array) -> Array:
    """The product of two quaternions (4,)."""
    w = a[0] * b[0] - a[1:] @ b[1:]
    return np.concatenate([[w], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])])


def axes_of(q: Array) -> Array:
    """R (3, 3): columns are the axes of the body, each turned by q e q*."""
    back = q * np.array([1, -1, -1, -1])
    columns = [multiplied(multiplied(q, np.array([0.0, *e])), back)[1:] for e in np.eye(3)]
    return np.array(columns).T


def by_hand(p: dict[str, float], speed: Array, q: Array, w: Array, u: Array) -> tuple[Array, ...]:
    """Acceleration in inertial axes, dω/dt, and specific force in the axes of the frame."""
    turned = axes_of(q)
    arms = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]]) * p["l"]
    torque = sum(np.cross([*arm, p["h"]], [0, 0, f]) for arm, f in zip(arms, u, strict=True))
    torque = torque + np.array([0, 0, p["c"] * (u[0] - u[1] + u[2] - u[3])])
    inertia = np.array([p["J_x"], p["J_y"], p["J_z"]])
    felt = turned @ [0, 0, u.sum()] / p["m"] - p["b"] / p["m"] * np.linalg.norm(speed) * speed
    pull = felt - np.array([0, 0, p["g"]])
    return pull, (torque - np.cross(w, inertia * w)) / inertia, turned.T @ felt


def test_the_quadrotor_agrees_with_newton_and_euler_at_random_states() -> None:
    p, machine, rng = numbers("quadrotor"), machine_of("quadrotor"), np.random.default_rng(23)
    pairs, still = [], np.zeros(0)
    for _ in range(1000):
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        w, speed, u = 6 * rng.normal(size=3), 4 * rng.normal(size=3), rng.uniform(0, 4, 4)
        turn = multiplied(q, np.array([0, *w])) / 2
        state = np.concatenate([rng.normal(size=3), q]), np.concatenate([speed, turn])
        here = (*state, still, u, 0, machine.values)
        a = call(machine.acceleration, (*here, np.zeros(7), still))[0][0]
        y = call(machine.outputs, (*state, a, still, u, 0, machine.values))[0][0]
        pull, spin, felt = by_hand(p, speed, q, w, u)
        bend = (multiplied(q, np.array([0, *spin])) + multiplied(turn, np.array([0, *w]))) / 2
        wanted = np.concatenate([pull, bend, w, felt])
        pairs.append((np.concatenate([a, y[3:]]), wanted))
    found, wanted = (np.array(each) for each in zip(*pairs, strict=True))
    assert close(found, wanted, 1e-9)


def test_the_length_of_a_quaternion_changes_nothing_that_is_measured() -> None:
    machine, rng, still = machine_of("quadrotor"), np.random.default_rng(24), np.zeros(0)
    for _ in range(50):
        q, v, u = rng.normal(size=7), rng.normal(size=7), rng.uniform(0, 4, 4)
        shown = []
        for size, growth in ((1.0, 0.0), (3.7, 0.8), (0.2, -2.0)):
            place, rate = q.copy(), v.copy()
            place[3:], rate[3:] = size * q[3:], size * (v[3:] + growth * q[3:])
            here = (place, rate, still, u, 0, machine.values)
            a = call(machine.acceleration, (*here, np.zeros(7), still))[0][0]
            y = call(machine.outputs, (place, rate, a, still, u, 0, machine.values))[0][0]
            turn = machine_turn(place[3:], rate[3:], a[3:])
            shown.append(np.concatenate([a[:3], turn, y]))
        for other in shown[1:]:
            assert other == pytest.approx(shown[0], rel=1e-9, abs=1e-9)


def machine_turn(q: Array, v: Array, a: Array) -> Array:
    """dω/dt in the axes of the body of a quaternion of any length with its derivatives."""
    size = q @ q
    back = np.array([1, -1, -1, -1])
    first, second = multiplied(q * back, v)[1:], multiplied(q * back, a)[1:]
    return 2 * (second / size - 2 * (q @ v) / size**2 * first)


def flown(end: float, u: Array, w: Array, outputs: int, still_air: bool = False) -> Trajectory:
    machine = machine_of("quadrotor")
    values = machine.values.copy()
    if still_air:
        values[[machine.column("g"), machine.column("b")]] = 0.0
    start = start_of("quadrotor")
    v = np.concatenate([np.zeros(3), multiplied(start[3:], np.array([0, *w])) / 2])
    t_u = np.array([0.0, end])
    scenario = Scenario(np.linspace(0, end, outputs), start, v, t_u, np.array([u, u]))
    run = simulate(machine, scenario, values)
    assert run.complete, run.reason
    return run


def test_a_tumbling_body_keeps_its_angular_momentum_and_the_length_of_its_quaternion() -> None:
    """60 s about the middle axis, the unstable one: it tips over again and again."""
    p = numbers("quadrotor")
    run = flown(60.0, np.zeros(4), np.array([0.01, 5.0, 0.01]), 601, still_air=True)
    lengths = np.linalg.norm(run.q[:, 3:], axis=1)
    assert np.abs(lengths - 1).max() < 1e-8
    inertia = np.array([p["J_x"], p["J_y"], p["J_z"]])
    spins = 2 * np.array(
        [
            multiplied(q * [1, -1, -1, -1], v)[1:]
            for q, v in zip(run.q[:, 3:], run.v[:, 3:], strict=True)
        ]
    )
    momentum = np.array(
        [axes_of(q) @ (inertia * w) for q, w in zip(run.q[:, 3:], spins, strict=True)]
    )
    size = np.linalg.norm(momentum[0])
    assert np.abs(momentum - momentum[0]).max() < 1e-6 * size
    assert np.ptp(spins[:, 1]) > 9.0  # it did tip over
    energy = spins**2 @ inertia / 2
    assert np.ptp(energy) < 1e-6 * energy[0]


def test_rotors_that_carry_the_weight_let_it_hover() -> None:
    p = numbers("quadrotor")
    run = flown(3.0, np.full(4, p["m"] * p["g"] / 4), np.zeros(3), 31)
    assert run.q == pytest.approx(np.tile(start_of("quadrotor"), (31, 1)), abs=1e-9)
    assert run.y[:, 8] == pytest.approx(p["g"], rel=1e-9)  # its support, along z of the frame


def test_the_length_of_a_quaternion_is_no_mode_of_a_machine() -> None:
    """At hover nothing pulls back: all six motions are free, and the length is not among them."""
    p, machine = numbers("quadrotor"), machine_of("quadrotor")
    modes = modes_at(machine, start_of("quadrotor"), np.full(4, p["m"] * p["g"] / 4))
    assert modes
    assert all(mode.frequency == mode.rate == 0.0 for mode in modes)
    assert all(dict(mode.shape).get("qw", 0.0) == 0.0 for mode in modes)


@pytest.mark.parametrize("name", CHAINS)
def test_energy_in_space_changes_by_the_power_of_dampers_and_motors(name: str) -> None:
    machine, rng = machine_of(name), np.random.default_rng(26)
    balance, still, n = balance_of(machine), np.zeros(0), machine.n
    rows = []
    for _ in range(200):
        q, v = rng.normal(size=(2, n)) * np.array([[2.0], [5.0]])
        u = rng.normal(size=len(machine.model.inputs))
        a = call(machine.acceleration, (q, v, still, u, 0, machine.values, 0 * q, still))[0][0]
        rows.append([x.item() for x in call(balance, (q, v, a, still, u, 0, machine.values))])
    _, power, slope = np.array(rows).T
    assert close(slope, power, 1e-9, 1e-11 * float(np.abs(power).max()))
    assert np.abs(power).min() > 0


# --- the top ------------------------------------------------------------------------------------


def test_a_fast_top_precesses_steadily() -> None:
    """(A − C_c) ψ'² cosθ − C (φ' + ψ' cosθ) ψ' + m g l = 0 of cage and rotor, θ kept."""
    p, machine = numbers("gyroscope"), machine_of("gyroscope")
    theta, spin = np.radians(50.0), 314.0  # spin of the rotor about its axis, in all
    across = p["A_c"] + p["A_r"] + (p["m_c"] + p["m_r"]) * p["l"] ** 2
    moment = (p["m_c"] + p["m_r"]) * p["g"] * p["l"]
    roots = np.roots([(across - p["C_c"]) * np.cos(theta), -p["C_r"] * spin, moment])
    values = machine.values.copy()
    values[machine.column("d")] = 0.0
    for rate in roots.real:
        q = np.array([0.0, theta, 0.0])
        v = np.array([rate, 0.0, spin - rate * np.cos(theta)])
        end = 3 * 2 * np.pi / abs(rate)
        t, t_u = np.linspace(0, end, 61), np.array([0.0, end])
        run = simulate(machine, Scenario(t, q, v, t_u, np.zeros((2, 0))), values)
        assert run.complete, run.reason
        assert run.q[:, 1] == pytest.approx(theta, abs=1e-6)
        assert run.q[:, 0] == pytest.approx(rate * t, abs=1e-5)
    assert roots.real.min() == pytest.approx(moment / p["C_r"] / spin, rel=0.1)  # the slow one


def test_the_energy_of_the_top_is_lost_in_its_bearing_alone() -> None:
    p, machine = numbers("gyroscope"), machine_of("gyroscope")
    t = np.linspace(0, 0.5, 2001)
    v = np.array([3.0, 1.0, 314.0])
    idle = Scenario(t, np.array([0.0, 0.9, 0.0]), v, t[[0, -1]], np.zeros((2, 0)))
    run = simulate(machine, idle)
    assert run.complete, run.reason
    rows = [
        call(machine.energy, (q, v, np.zeros(0), 0, machine.values))[:2]
        for q, v in zip(run.q, run.v, strict=True)
    ]
    energy = np.array([kinetic.item() + potential.item() for kinetic, potential in rows])
    power = -p["d"] * run.v[:, 2] ** 2
    lost = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(t))])
    assert energy - energy[0] == pytest.approx(lost, abs=3e-8 * energy[0])
    assert lost[-1] < -3e-3 * energy[0]


@pytest.mark.parametrize("name", ["gyroscope", "furuta_pendulum", "quadrotor"])
def test_units_do_not_change_a_machine_in_space(name: str) -> None:
    model = shipped(name)
    changed = build(parse_model(in_other_units(model.text)))
    original, rng = build(model), np.random.default_rng(25)
    assert changed.model.parameters[0].unit.text != model.parameters[0].unit.text
    for _ in range(50):
        q, v, a = rng.normal(size=(3, original.n))
        u, still = rng.normal(size=len(model.inputs)), np.zeros(0)
        for function in ("outputs", "discrepancy"):
            ours, theirs = (
                call(getattr(m, function), (q, v, a, still, u, 0, m.values))[0][0]
                for m in (original, changed)
            )
            assert theirs == pytest.approx(ours, rel=1e-9, abs=1e-9 * np.abs(ours).max())


def test_the_same_body_by_angles_and_by_a_quaternion() -> None:
    """A body by three rotations and by a quaternion from one start: the same inertial unit."""
    quaternion = shipped("quadrotor")
    text = quaternion.text.replace(
        'quaternion = ["qw", "qx", "qy", "qz"]',
        'rotations  = [["z", "yaw"], ["y", "pitch"], ["x", "roll"]]',
    )
    for old, new in (("qw", "yaw"), ("qx", "pitch"), ("qy", "roll")):
        text = text.replace(
            f'{old} = {{ unit = "1", start = 1.0', f'{old} = {{ unit = "1", start = 0.0'
        )
        text = text.replace(f'\n{old} = {{ unit = "1"', f'\n{new} = {{ unit = "rad"')
    text = "\n".join(line for line in text.splitlines() if not line.startswith("qz"))
    angles = parse_model(text)
    t, u = np.linspace(0, 2.0, 41), np.array([1.7, 1.5, 1.62, 1.58])
    runs = []
    for model in (quaternion, angles):
        machine = build(model)
        start = np.array([c.start * c.unit.factor for c in model.coordinates])
        scenario = Scenario(t, start, 0 * start, t[[0, -1]], np.array([u, u]))
        runs.append(simulate(machine, scenario))
        assert runs[-1].complete, runs[-1].reason
    assert runs[1].y == pytest.approx(runs[0].y, abs=2e-6)
    assert np.abs(runs[0].y[-1, 3:6]).max() > 1.0
    assert replace(quaternion, text="").bodies != replace(angles, text="").bodies
