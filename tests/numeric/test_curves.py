"""Characteristic curves in a machine against SciPy: values, slopes, signs, runs and windows."""

from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from blocks import block, slope, uneven
from builders import DRIVEN_MASS, model_of, oscillator, push, run, spring, value
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from symhyb.laws.characteristic import Characteristic, through
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.tables import picked
from symhyb.numeric.runs.windows import WindowModel

X = np.array([-0.6, -0.2, -0.05, 0.0, 0.1, 0.3, 0.8])
F = np.array([-9.0, -6.2, -3.0, 0.0, 1.0, 2.6, 4.0])
INNER = PchipInterpolator(X, F)
SLOPES = INNER.derivative()
POINTS = [[1e3 * x, f] for x, f in zip(X, F, strict=True)]
MASS, STIFFNESS = 1.2, 40.0


def force(x: float) -> float:
    """The curve by SciPy, with the lines of its end slopes beyond."""
    at = min(max(x, X[0]), X[-1])
    return float(INNER(at) + SLOPES(at) * (x - at))


def curved(over: str, place: str = "x", **more: object) -> Model:
    """A driven mass on a spring with a curve; ``n`` is a factor of it."""
    unit = "mm" if over == "stretch" else "mm/s"
    curve = {"kind": "curve", "over": over, "units": [unit, "N"], "points": POINTS, "scale": "n"}
    where = {"on": "x"} if place == "x" else {"between": ["wall", "block"], "length": "far"}
    return oscillator(
        {"hold": spring("k"), "pad": {**curve, **where, **more}, "motor": push("f")},
        {"k": (STIFFNESS, "N/m"), "n": (1.5, "1")},
        {
            "place": {"measures": "x", "unit": "m"},
            "cell": {"measures": "force(pad)", "unit": "N"},
        },
        {"f": {"unit": "N"}},
    )


def characteristics() -> list[Characteristic]:
    rng = np.random.default_rng(1)
    x = np.sort(rng.normal(size=100))
    return [
        through("c", X, F),
        through("c", X, F, "linear", "hold"),
        through("c", x, rng.normal(size=100)),
        through("c", [0.0, 1.0], [1.0, 3.0]),
        # one steep piece must not cost the others their digits
        through("c", [-1.0, 0.0, 1e-9, 1.0], [0.0, 0.0, 1e6, 1e6 + 1e-3]),
    ]


@pytest.mark.parametrize("curve", characteristics(), ids=["pchip", "lines", "100", "2", "steep"])
def test_the_lowered_curve_and_its_slopes_are_those_of_the_pieces(curve: Characteristic) -> None:
    x = ca.SX.sym("x")
    lowered = picked(curve, x)
    first = ca.jacobian(lowered, x)
    function = ca.Function("f", [x], [lowered, first, ca.jacobian(first, x)], {"cse": True})
    fine = [np.linspace(a, b, 50) for a, b in pairwise(curve.breaks)]
    at = np.concatenate([[-3.0, -1e-3], *fine, curve.breaks, [5.0]])
    made = [np.array(part).ravel() for part in function.map(at.size)(at[None, :])]
    for found, exact in zip(made, (curve, curve.slope(), curve.slope().slope()), strict=True):
        expected = exact(at)
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-13 * np.abs(expected).min())


def test_slopes_cost_next_to_nothing() -> None:
    x, curve = ca.SX.sym("x"), characteristics()[2]
    lowered = picked(curve, x)
    alone = ca.Function("f", [x], [lowered], {"cse": True}).n_instructions()
    slopes = [ca.jacobian(lowered, x), ca.hessian(lowered, x)[0]]
    with_slopes = ca.Function("f", [x], [lowered, *slopes], {"cse": True}).n_instructions()
    assert alone < 16 * len(curve.breaks)
    assert with_slopes - alone < 20


def test_what_is_no_number_stays_none() -> None:
    x = ca.SX.sym("x")
    assert np.isnan(float(ca.Function("f", [x], [picked(characteristics()[0], x)])(np.nan)))


@pytest.mark.parametrize("place", ["x", "wall to block"])
@pytest.mark.parametrize("over", ["stretch", "rate"])
def test_the_force_resists_with_the_sign_of_a_spring_or_damper(over: str, place: str) -> None:
    machine = build(curved(over, place))
    for at in (-1.0, -0.3, -0.01, 0.04, 0.25, 1.3):
        q, v = ([at], [0.3]) if over == "stretch" else ([0.2], [at])
        made = value(machine.k_e, q, v, [], [0.0], 0.0, machine.values)
        assert made == pytest.approx([-STIFFNESS * q[0] - 1.5 * force(at)], rel=1e-12)
        assert value(machine.outputs, q, v, [0], [], [0.0], 0.0, machine.values)[1] == (
            pytest.approx(1.5 * force(at), rel=1e-12)
        )


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("over", ["stretch", "rate"])
def test_runs_are_those_of_scipy(
    over: str, compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the explicit method in machine code, and by CVODES."""
    if not compiled:
        monkeypatch.setattr("symhyb.numeric.runs.integrate.field", lambda form: None)
    t, pushed = np.linspace(0, 3, 301), 6.0
    made = run(curved(over), t, -0.3, 0.9, pushed * np.ones(301))
    assert made.complete

    def rate(_: float, state: np.ndarray) -> list[float]:
        law = force(state[0] if over == "stretch" else state[1])
        return [state[1], (pushed - STIFFNESS * state[0] - 1.5 * law) / MASS]

    exact = solve_ivp(rate, (0, 3), [-0.3, 0.9], t_eval=t, rtol=1e-9, atol=1e-11, max_step=5e-3)
    assert np.ptp(exact.y[0]) > 0.1
    assert made.q[:, 0] == pytest.approx(exact.y[0], abs=5e-6)
    assert ("explicit" in made.method) == compiled


def test_over_the_stretch_energy_is_kept_and_over_the_rate_lost() -> None:
    t = np.linspace(0, 3, 31)
    kept, lost = (
        run(build(curved(over)), t, 0.3, 0.5, np.zeros(31)) for over in ("stretch", "rate")
    )

    def energy(machine, trajectory) -> np.ndarray:  # type: ignore[no-untyped-def]
        total = []
        for q, v, at in zip(trajectory.q, trajectory.v, t, strict=True):
            parts = call(machine.energy, [q, v, [], at, machine.values])
            total.append(sum(float(np.sum(part)) for part in parts))
        return np.array(total)

    conserved = energy(build(curved("stretch")), kept)
    assert conserved == pytest.approx(conserved[0], rel=1e-6)
    assert np.all(np.diff(energy(build(curved("rate")), lost)) < 0)


@pytest.mark.parametrize("over", ["stretch", "rate"])
def test_windows_are_differentiated_by_states_and_by_the_factor(over: str) -> None:
    machine = build(curved(over))
    model = WindowModel(machine, (machine.column("n"), machine.column("k")))
    t = uneven(2, 25, seed=5)
    windows = block(t, 6 * np.sin(5 * t)[..., None], 2, substeps=16)
    start = np.array([[0.13, 0.45], [-0.12, -0.32]])
    linear = model.differentiate(windows, start, machine.values)
    for i in range(2):
        moved = np.eye(2)[i]
        found = slope(
            lambda h, d=moved: model.simulate(windows, start + h * d, machine.values)[1], 1e-6
        )
        exact = linear.from_start()[..., i]
        assert exact == pytest.approx(found, rel=5e-3, abs=5e-3 * np.abs(found).max())
    for column, i in enumerate(model.free):
        moved = np.eye(machine.values.size)[i]
        found = slope(
            lambda h, d=moved: model.simulate(windows, start, machine.values + h * d)[1], 1e-5
        )
        exact = linear.from_free()[..., column]
        assert exact == pytest.approx(found, rel=5e-3, abs=5e-3 * np.abs(found).max())


def test_machines_that_differ_by_points_alone_are_two() -> None:
    """Lowered functions are shared by machines of one structure."""
    first, second = curved("rate"), curved("rate", points=[[0, 0], [100, 50]])
    made = [
        value(build(model).k_e, [0.0], [0.1], [], [0.0], 0.0, build(model).values)
        for model in (first, second)
    ]
    assert made[1] == pytest.approx([-75.0])
    assert made[0] != pytest.approx(made[1])


SHARED = """symhyb = 1
[coordinates]
phi = {{ unit = "rad", start_rate = 2.0 }}
y = {{ unit = "m" }}
[parameters]
J = {{ value = 0.01, unit = "kg*m^2" }}
m = {{ value = 0.2, unit = "kg" }}
[bodies.shaft]
mass = 1
at = ["0", "0"]
inertia = "J"
angle = "phi"
[bodies.follower]
mass = "m"
at = ["0", "y"]
[curves.cam]
units = ["rad", "mm"]
points = {cam}
[constraints.cam]
zero = "y - curve(cam, phi)"
[sensors]
lift = {{ measures = "curve(cam, phi)", unit = "mm" }}
"""


def test_a_cam_is_a_constraint_with_a_curve() -> None:
    """The follower rides on the cam, and nothing but the shaft's inertia changes with the lift:
    (J + m c'²) phi'² is kept."""
    phi = np.linspace(-1.0, 8.0, 19)
    lift = 4.0 * (1 - np.cos(phi))
    model = parse_model(SHARED.format(cam=np.column_stack([phi, lift]).tolist()))
    machine, t = build(model), np.linspace(0, 2, 41)
    made = run(machine, t, *(np.array(part) for part in model.start()))
    cam = PchipInterpolator(phi, lift / 1e3)
    assert made.complete
    assert np.ptp(made.q[:, 0]) > 3.0
    assert made.q[:, 1] == pytest.approx(cam(made.q[:, 0]), abs=1e-9)
    assert made.y[:, 0] == pytest.approx(cam(made.q[:, 0]), abs=1e-9)
    inertia = 0.01 + 0.2 * cam.derivative()(made.q[:, 0]) ** 2
    kept = inertia * made.v[:, 0] ** 2
    assert kept == pytest.approx(kept[0], rel=1e-4)


def test_a_potential_may_be_a_curve() -> None:
    """Its force is minus the slope, exactly."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        curves={"well": {"units": ["m", "J"], "points": [list(p) for p in zip(X, F, strict=True)]}},
        energy={"potential": "2*curve(well, x)"},
    )
    machine = build(model)
    for at in (-0.7, -0.1, 0.05, 0.2, 0.9):
        inside = min(max(at, X[0]), X[-1])
        made = value(machine.k_e, [at], [0.0], [], [], 0.0, machine.values)
        assert made == pytest.approx([-2 * float(SLOPES(inside))], rel=1e-10)


def test_an_element_and_an_expression_with_one_curve_do_the_same() -> None:
    text = """[curves.valve]
units = ["m/s", "N"]
points = [[-1, -3], [0, 0], [1, 7]]
[elements.strut]
"""
    element = 'kind = "curve"\non = "x"\nover = "rate"\ncurve = "valve"\n'
    law = 'kind = "law"\non = "x"\nforce = "-curve(valve, x\')"\n'
    made = []
    for way in (element, law):
        machine = build(parse_model(DRIVEN_MASS + text + way))
        made.append(value(machine.k_e, [0.1], [0.4], [], [2.0], 0.0, machine.values))
    assert made[0] == pytest.approx(made[1], rel=1e-15)
    other = build(parse_model(DRIVEN_MASS + text.replace("7", "8") + law))
    assert value(other.k_e, [0.1], [0.4], [], [2.0], 0.0, other.values) != pytest.approx(made[0])


@pytest.mark.parametrize(
    ("times", "unit", "speed"), [("rate", "N*s/m", "x'"), ("square", "N*s^2/m^2", "abs(x')*x'")]
)
def test_a_factor_of_the_speed_is_an_expression_with_the_curve(
    times: str, unit: str, speed: str
) -> None:
    text = f"""[curves.zone]
units = ["m", "{unit}"]
points = [[-1, 3], [0, 0], [1, 7]]
[elements.brake]
"""
    element = f'kind = "curve"\non = "x"\nover = "stretch"\ntimes = "{times}"\ncurve = "zone"\n'
    law = f'kind = "law"\non = "x"\nforce = "-curve(zone, x)*{speed}"\n'
    made = []
    for way in (element, law):
        machine = build(parse_model(DRIVEN_MASS + text + way))
        made.append(value(machine.k_e, [0.1], [-0.4], [], [2.0], 0.0, machine.values))
    assert made[0] == pytest.approx(made[1], rel=1e-15)


def test_an_angle_takes_degrees_and_torques() -> None:
    stop = {
        "kind": "curve",
        "on": "phi",
        "over": "stretch",
        "units": ["deg", "N*cm"],
        "points": [[-90, -200], [0, 0], [90, 100]],
        "interpolation": "linear",
    }
    model = model_of(
        coordinates={"phi": {"unit": "deg"}},
        parameters={"J": (0.1, "kg*m^2")},
        bodies={"rotor": {"mass": 1, "at": ["0", "0"], "inertia": "J", "angle": "phi"}},
        elements={"stop": stop},
    )
    machine = build(model)
    for at, torque in ((np.pi / 4, -0.5), (-np.pi / 4, 1.0), (np.pi, -2.0)):
        made = value(machine.k_e, [at], [0.0], [], [], 0.0, machine.values)
        assert made == pytest.approx([torque])
