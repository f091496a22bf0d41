"""What rolls without slip in space: against Newton and Euler by hand, closed forms, and the
published benchmark of the bicycle."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.errors import InputError
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.linear import free_slope
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import closed, gaps_of, placing
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
MODELS = Path(__file__).parents[2] / "models"
ROLLING = """\
symhyb = 1
gravity = ["g*sin(slope)", "0", "-g*cos(slope)"]
[coordinates]
x = { unit = "m", start = 0.0 }
y = { unit = "m", start = 0.0 }
z = { unit = "m" }
psi = { unit = "rad", start = 0.2, start_rate = 0.5 }
phi = { unit = "rad", start = 0.3, start_rate = 0.1 }
spin = { unit = "rad", start = 0.0, start_rate = 6.0 }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
slope = { value = 0.0, unit = "deg" }
m = { value = 2.0, unit = "kg" }
r = { value = 0.3, unit = "m" }
A = { value = 0.045, unit = "kg*m^2" }
C = { value = 0.09, unit = "kg*m^2" }
[points]
hub = { body = "disc", at = ["0", "0", "0"] }
rim = ["x", "y", "z"]
[bodies.disc]
at = ["x", "y", "z"]
mass = "m"
inertia = ["A", "C", "A"]
rotations = [["z", "psi"], ["x", "phi"], ["y", "spin"]]
[constraints.ground]
kind = "wheel"
point = "hub"
axle = "y"
radius = "r"
"""
SKATE = """\
symhyb = 1
gravity = ["g*sin(slope)", "0"]
[coordinates]
x = { unit = "m", start = 0.0, start_rate = 0.0 }
y = { unit = "m", start = 0.0, start_rate = 0.0 }
a = { unit = "rad", start = 0.0, start_rate = 2.0 }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
slope = { value = 10.0, unit = "deg" }
m = { value = 3.0, unit = "kg" }
J = { value = 0.2, unit = "kg*m^2" }
[bodies.skate]
at = ["x", "y"]
mass = "m"
inertia = "J"
angle = "a"
[constraints.edge]
rate = "x'*sin(a) - y'*cos(a)"
"""


def free(machine: Machine, t: Array) -> Trajectory:
    """A run from the start that the file declares."""
    q, v = (np.array(part) for part in machine.model.start())
    return simulate(machine, Scenario(t, q, v, t[[0, -1]], np.empty((2, 0))))


def energy(machine: Machine, run: Trajectory) -> Array:
    rows = [
        call(machine.energy, (q, v, np.zeros(0), t, machine.values))
        for q, v, t in zip(run.q, run.v, run.t, strict=True)
    ]
    return np.array([float(kinetic[0, 0] + potential[0, 0]) for kinetic, potential, *_ in rows])


def turned(axis: int, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    matrix, j, k = np.eye(3), (axis + 1) % 3, (axis + 2) % 3
    matrix[j, j], matrix[j, k], matrix[k, j], matrix[k, k] = c, -s, s, c
    return matrix


def rolling_by_hand(q: Array, v: Array) -> tuple[Array, Array, Array]:
    """Velocity and acceleration of the hub and ω' (3,) of the disc, in the inertial axes: Newton
    and Euler with the force of the ground as an unknown, and v = −ω × b, b from the hub downwards.
    """
    m, r, g, small, large = 2.0, 0.3, 9.81, 0.045, 0.09
    yaw, lean, spin = turned(2, q[3]), turned(0, q[4]), turned(1, q[5])
    axes = yaw @ lean @ spin
    x, z = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    axle = yaw @ lean @ np.array([0, 1.0, 0])
    omega = z * v[3] + yaw @ x * v[4] + axle * v[5]
    down = -r * yaw @ lean @ z  # the plane of a disc leans with it: its lowest point lies there
    falling = np.cross(z * v[3] + yaw @ x * v[4], down)
    inertia = axes @ np.diag([small, large, small]) @ axes.T
    across = lambda b: np.array([[0, -b[2], b[1]], [b[2], 0, -b[0]], [-b[1], b[0], 0]])  # noqa: E731
    # unknown: acceleration (3), ω' (3), force (3)
    matrix, right = np.zeros((9, 9)), np.zeros(9)
    matrix[:3, :3], matrix[:3, 6:] = m * np.eye(3), -np.eye(3)
    right[:3] = -m * g * z
    matrix[3:6, 3:6], matrix[3:6, 6:] = inertia, -across(down)
    right[3:6] = -np.cross(omega, inertia @ omega)
    matrix[6:, :3], matrix[6:, 3:6] = np.eye(3), -across(down)  # a + ω' × b + ω × b' = 0
    right[6:] = -np.cross(omega, falling)
    found = np.linalg.solve(matrix, right)
    return -np.cross(omega, down), found[:3], found[3:6]


def test_a_rolling_disc_against_newton_and_euler() -> None:
    """1000 random states on the constraints, to 1e-9."""
    machine = build(parse_model(ROLLING, "disc.toml"))
    random = np.random.default_rng(1)
    q = random.uniform(-1, 1, (1000, 6))
    v = random.uniform(-5, 5, (1000, 6))
    on = closed(machine, (q, v, 0 * q), np.zeros(1000), machine.values, (3, 4, 5))
    assert on.q[:, 3:] == pytest.approx(q[:, 3:], abs=0)
    given = (np.zeros(0), np.zeros(0), 0.0, machine.values, np.zeros(6), np.zeros(0))
    for q_i, v_i in zip(on.q, on.v, strict=True):
        (a,) = call(machine.acceleration, (q_i, v_i, *given))
        speed, hub, spin = rolling_by_hand(q_i, v_i)
        assert v_i[:3] == pytest.approx(speed, abs=1e-12)
        assert a[0, :3] == pytest.approx(hub, rel=1e-9, abs=1e-9)
        # ω of the model by its own angles, differentiated by a small step along the motion
        assert omega_rate(q_i, v_i, a[0]) == pytest.approx(spin, rel=1e-6, abs=1e-5)


def omega_rate(q: Array, v: Array, a: Array, h: float = 1e-5) -> Array:
    """ω' in the inertial axes from angles, rates and accelerations, by central differences."""

    def omega(s: float) -> Array:
        here, rate = q + s * v + s**2 / 2 * a, v + s * a
        yaw, lean = turned(2, here[3]), turned(0, here[4])
        ahead = yaw @ np.array([1.0, 0, 0]) * rate[4]
        return np.array([0, 0, 1.0]) * rate[3] + ahead + yaw @ lean @ np.array([0, 1, 0]) * rate[5]

    return (omega(h) - omega(-h)) / (2 * h)


def test_a_rolling_disc_keeps_its_energy_and_touches() -> None:
    """For a minute: energy, and no slip and no gap above 1e-8."""
    machine = build(parse_model(ROLLING, "disc.toml"))
    run = free(machine, t := np.linspace(0, 60, 1201))
    assert run.complete, run.reason
    gaps = gaps_of(machine, run.q, run.v, run.a, t, machine.values)
    assert np.abs(gaps.gap).max() < 1e-8
    assert np.abs(gaps.rate).max() < 1e-8
    total = energy(machine, run)
    assert np.ptp(total) < 1e-6 * total[0]
    assert np.ptp(run.q[:, 0]) > 1  # it goes somewhere


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "share"), [("2/5", 5 / 7), ("2/3", 3 / 5)])
def test_a_ball_rolls_down_a_slope(shape: str, share: float) -> None:
    """Solid and hollow: a = 5/7 and 3/5 of g sin α; a spin about the vertical changes nothing."""
    text = ROLLING.replace('kind = "wheel"', 'kind = "ball"').replace('axle = "y"\n', "")
    text = text.replace('inertia = ["A", "C", "A"]', f'inertia = "{shape}*m*r**2"')
    text = text.replace("slope = { value = 0.0", "slope = { value = 10.0")
    text = text.replace("start = 0.3, start_rate = 0.1", "start = 0.3, start_rate = 0.0")
    text = text.replace("start = 0.0, start_rate = 6.0", "start = 0.0, start_rate = 0.0")
    run = free(build(parse_model(text, "ball.toml")), t := np.linspace(0, 2, 41))
    assert run.complete, run.reason
    pull = share * 9.81 * np.sin(np.radians(10))
    assert run.q[:, 0] == pytest.approx(pull * t**2 / 2, abs=1e-7)
    assert run.q[:, 1:3] == pytest.approx(np.tile([0.0, 0.3], (41, 1)), abs=1e-7)


def test_a_skate_on_a_slope_against_its_cycloid() -> None:
    """A knife edge that turns steadily at ω goes along, not down: x = k sin²ωt, y = k (ωt −
    sin ωt cos ωt), k = g sin α/(2 ω²) (Neimark and Fufaev, ch. II)."""
    sensor = '[sensors]\nside = { measures = "reaction(edge)", unit = "N", sd = 0.1 }\n'
    machine = build(parse_model(SKATE + sensor, "skate.toml"))
    run = free(machine, t := np.linspace(0, 10, 501))
    k, w = 9.81 * np.sin(np.radians(10)) / 8, 2 * t
    assert run.q[:, 0] == pytest.approx(k * np.sin(w) ** 2, abs=1e-7)
    assert run.q[:, 1] == pytest.approx(k * (w - np.sin(w) * np.cos(w)), abs=1e-7)
    assert run.q[:, 2] == pytest.approx(w, abs=1e-9)
    # the edge pushes against sin a x' − cos a y': what gravity pulls across it, and the turn
    along = np.cos(w) * run.v[:, 0] + np.sin(w) * run.v[:, 1]
    push = 3.0 * (-9.81 * np.sin(np.radians(10)) * np.sin(w) - 2 * along)
    assert run.y[:, 0] == pytest.approx(push, abs=1e-5)


@cache
def bicycle() -> Machine:
    return build(read_model(MODELS / "bicycle.toml"))


M = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
K0 = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
K2 = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])
C1 = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
"""M q'' + v C1 q' + (g K0 + v² K2) q = 0 of lean and steering: Meijaard and others 2007, eq. 6."""


@pytest.mark.parametrize("speed", [0.5, 2.0, 4.292382536341, 5.0, 6.02426201538837, 9.0])
def test_the_bicycle_against_the_published_benchmark(speed: float) -> None:
    """Weave, capsize and castering of the upright bicycle, from its full equations in nine
    coordinates, against the published matrices, to 1e-9."""
    machine, form = bicycle(), state_form(bicycle())
    names = [c.name for c in machine.model.coordinates]
    q, v = np.array(machine.model.start()[0]), np.zeros(9)
    for name, rate in (("x", speed), ("rho", speed / 0.3), ("zeta", speed / 0.35)):
        v[names.index(name)] = rate
    x = form.state(q[None], v[None], np.zeros((1, 0)))[0]
    found = np.linalg.eigvals(free_slope(form, x, np.zeros(0), 0.0, machine.values))
    assert found.size == form.moving == 10
    stiffness = 9.81 * K0 + speed**2 * K2
    lower = np.linalg.solve(M, np.hstack([stiffness, speed * C1]))
    reported = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-lower]]))
    for root in reported:
        nearest = found[np.argmin(np.abs(found - root))]
        assert nearest == pytest.approx(root, rel=1e-9, abs=1e-9)
    assert np.sort(np.abs(found))[:6] == pytest.approx(np.zeros(6), abs=1e-6)


def test_the_bicycle_rides_by_itself() -> None:
    """Pushed at a speed at which it is stable, it comes upright again and keeps its energy."""
    machine = bicycle()
    run = free(machine, t := np.linspace(0, 60, 6001))
    assert run.complete, run.reason
    lean = run.q[:, [c.name for c in machine.model.coordinates].index("phi")]
    assert np.abs(lean).max() > 0.1
    assert np.abs(lean[-100:]).max() < 1e-3
    total = energy(machine, run)
    assert np.ptp(total) < 1e-5 * total[0]
    gaps = gaps_of(machine, run.q, run.v, run.a, t, machine.values)
    assert max(np.abs(gaps.gap).max(), np.abs(gaps.rate).max()) < 1e-8


def test_what_holds_places_and_what_holds_speeds() -> None:
    machine = bicycle()
    assert machine.constraints == 6
    assert placing(machine) == [0, 3]
    assert machine.model.assembly is not None
    assert machine.model.assembly.rows[0::3] == ("rear_wheel.touch", "front_wheel.touch")


def test_a_rolling_model_is_written_again_as_it_was() -> None:
    for text in (ROLLING, SKATE):
        model = parse_model(text, "model.toml")
        assert parse_model(render(model), "model.toml").constraints == model.constraints


def test_a_wheel_that_is_held_twice_is_held_once() -> None:
    """The second says nothing new: all three of its rows are left out, and that is reported."""
    twice = ROLLING.split("[constraints.ground]")[1]
    machine = build(parse_model(f"{ROLLING}[constraints.again]{twice}", "disc.toml"))
    assert machine.constraints == 3
    assert [note for note in machine.notes if "constraints.again" in note]


@pytest.mark.parametrize(
    ("text", "old", "new", "sentence"),
    [
        (ROLLING, 'axle = "y"\n', "", "constraints.ground: 'axle' is missing"),
        (ROLLING, 'axle = "y"', 'axle = "w"', "constraints.ground.axle: 'w' is no axis: x, y or z"),
        (
            ROLLING,
            'point = "hub"',
            'point = "rim"',
            "constraints.ground.point: the point 'rim' is fixed to no body; a wheel turns with one",
        ),
        (
            ROLLING,
            'radius = "r"',
            'radius = "slope"',
            "constraints.ground.radius: 'slope' is deg, needs m",
        ),
        (
            ROLLING,
            'radius = "r"',
            'radius = "r"\nheight = "m"',
            "constraints.ground.height: 'm' is kg, needs m",
        ),
        (
            ROLLING,
            "r = { value = 0.3",
            "r = { value = -0.3",
            "constraints.ground.radius: is -0.3; the radius of what rolls must be positive",
        ),
        (
            ROLLING,
            "[points]",
            '[sensors]\nside = { measures = "reaction(ground)", unit = "N" }\n[points]',
            "the reaction of the wheel 'ground' is a vector",
        ),
        (
            SKATE,
            """rate = "x'*sin(a) - y'*cos(a)\"""",
            'rate = "x*sin(a)"',
            "constraints.edge.rate: 'x*sin(a)' contains no rate; a condition on places",
        ),
        (
            SKATE,
            """rate = "x'*sin(a) - y'*cos(a)\"""",
            """rate = "x'*y'\"""",
            "constraints.edge: is not linear in the rates",
        ),
        (
            SKATE,
            """rate = "x'*sin(a) - y'*cos(a)\"""",
            """rate = "x'*sin(a) - a'\"""",
            "constraints.edge.rate: subtracts",
        ),
    ],
)
def test_what_is_refused(text: str, old: str, new: str, sentence: str) -> None:
    assert old in text
    with pytest.raises(InputError) as found:
        build(parse_model(text.replace(old, new), "model.toml"))
    assert sentence in str(found.value)
