"""Maps in a machine against SciPy: values, slopes, signs, cost, runs and windows."""

import casadi as ca
import numpy as np
import pytest
from blocks import block, slope, uneven
from builders import DRIVEN_MASS, model_of, oscillator, push, run, spring, value
from scipy.integrate import solve_ivp
from scipy.interpolate import RegularGridInterpolator

from symhyb.exact.simulation import simulate
from symhyb.laws.characteristic import through
from symhyb.laws.surface import Surface, bilinear
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.tables import on_surface, picked
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel

S = np.array([-0.4, -0.1, 0.0, 0.15, 0.5])
R = np.array([-2.0, -0.5, 0.0, 0.4, 1.5])
F = np.array([[3.0], [1.0], [0.8], [1.0], [2.5]]) * np.array([-9.0, -4.0, 0.0, 2.0, 4.0])
F += 3.0 * S[:, None]  # a stiffness beside the damping
KNOWN = RegularGridInterpolator((S, R), F, "linear", bounds_error=False, fill_value=None)
GRID = {"x": (1e3 * S).tolist(), "y": (1e3 * R).tolist(), "values": F.tolist()}
MASS, STIFFNESS = 1.2, 40.0


def force(s: float, r: float) -> float:
    return float(KNOWN((s, r)))


def mapped_keys() -> dict[str, object]:
    return {"kind": "map", "units": ["mm", "mm/s", "N"], **GRID, "scale": "n"}


def mapped(place: str = "x", **more: object) -> Model:
    """A driven mass on a spring with a map; ``n`` is a factor of it."""
    own = mapped_keys()
    where = {"on": "x"} if place == "x" else {"between": ["wall", "block"], "length": "far"}
    return oscillator(
        {"hold": spring("k"), "pad": {**own, **where, **more}, "motor": push("f")},
        {"k": (STIFFNESS, "N/m"), "n": (1.5, "1")},
        {
            "place": {"measures": "x", "unit": "m"},
            "cell": {"measures": "force(pad)", "unit": "N"},
        },
        {"f": {"unit": "N"}},
    )


def surfaces() -> list[Surface]:
    rng = np.random.default_rng(1)
    x, y = np.sort(rng.normal(size=(2, 50)))
    return [
        bilinear("m", S.tolist(), R.tolist(), F.tolist()),
        bilinear("m", S.tolist(), R.tolist(), F.tolist(), "hold"),
        bilinear("m", x.tolist(), y.tolist(), rng.normal(size=(50, 50)).tolist()),
        bilinear("m", [0.0, 1.0], [-1.0, 1.0], [[1.0, 3.0], [2.0, -1.0]], "hold"),
    ]


@pytest.mark.parametrize("surface", surfaces(), ids=["line", "hold", "50 by 50", "2 by 2"])
def test_the_lowered_map_and_its_derivatives_are_those_of_the_grid(surface: Surface) -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    lowered = on_surface(surface, x, y)
    by_x, by_y = ca.jacobian(lowered, x), ca.jacobian(lowered, y)
    function = ca.Function("f", [x, y], [lowered, by_x, by_y, ca.jacobian(by_x, y)], {"cse": True})
    rng = np.random.default_rng(2)
    at = rng.uniform(-3, 3, (2, 400))
    made = [np.array(part).ravel() for part in function.map(400)(at[:1], at[1:])]
    exact = (surface, surface.slope("x"), surface.slope("y"), surface.slope("x").slope("y"))
    for found, known in zip(made, exact, strict=True):
        expected = known(*at)
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def test_a_map_of_ten_by_ten_costs_as_a_curve_of_forty_points() -> None:
    rng = np.random.default_rng(3)
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    places = np.linspace(-1, 1, 10).tolist()
    one = on_surface(bilinear("m", places, places, rng.normal(size=(10, 10)).tolist()), x, y)
    curve = picked(through("c", np.linspace(-1, 1, 40).tolist(), rng.normal(size=40).tolist()), x)

    def cost(*expressions: ca.SX) -> int:
        return int(ca.Function("f", [x, y], expressions, {"cse": True}).n_instructions())

    assert cost(one) < 1.05 * cost(curve)
    assert cost(one, ca.gradient(one, ca.vertcat(x, y))) < 1.5 * cost(one)


@pytest.mark.parametrize("place", ["x", "wall to block"])
def test_the_force_resists_with_the_sign_of_a_spring_or_damper(place: str) -> None:
    machine = build(mapped(place))
    for s, r in ((-0.5, 0.3), (-0.05, -1.0), (0.02, 0.1), (0.3, 1.2), (0.6, -2.5)):
        made = value(machine.k_e, [s], [r], [], [0.0], 0.0, machine.values)
        assert made == pytest.approx([-STIFFNESS * s - 1.5 * force(s, r)], rel=1e-11)
        shown = value(machine.outputs, [s], [r], [0], [], [0.0], 0.0, machine.values)[1]
        assert shown == pytest.approx(1.5 * force(s, r), rel=1e-11)


@pytest.mark.parametrize("compiled", [True, False])
def test_runs_are_those_of_scipy(compiled: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the explicit method in machine code, and by CVODES."""
    if not compiled:
        monkeypatch.setattr("symhyb.numeric.runs.integrate.field", lambda form: None)
    t, pushed = np.linspace(0, 3, 301), 6.0
    made = run(mapped(), t, -0.3, 0.9, pushed * np.ones(301))
    assert made.complete

    def rate(_: float, state: np.ndarray) -> list[float]:
        return [state[1], (pushed - STIFFNESS * state[0] - 1.5 * force(*state)) / MASS]

    exact = solve_ivp(rate, (0, 3), [-0.3, 0.9], t_eval=t, rtol=1e-9, atol=1e-11, max_step=5e-3)
    assert np.ptp(exact.y[0]) > 0.1
    assert made.q[:, 0] == pytest.approx(exact.y[0], abs=5e-6)
    assert ("explicit" in made.method) == compiled


def test_windows_are_differentiated_by_states_and_by_the_factor() -> None:
    machine = build(mapped())
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


def test_machines_that_differ_by_values_alone_are_two() -> None:
    """Lowered functions are shared by machines of one structure."""
    made = []
    for model in (mapped(), mapped(values=(2 * F).tolist())):
        machine = build(model)
        made.append(value(machine.k_e, [0.0], [0.1], [], [0.0], 0.0, machine.values)[0])
    assert made[1] == pytest.approx(2 * made[0])


def test_an_exact_run_stops_at_walls_beside_a_map() -> None:
    """Bounces between rigid stops, by events, against SciPy that stops at each of them."""
    wall = {"kind": "gap", "on": "x", "stiffness": "stiff", "clearance": "free"}
    model = oscillator(
        {"hold": spring("k"), "pad": {**mapped_keys(), "on": "x"}, "wall": wall},
        {"k": (STIFFNESS, "N/m"), "n": (0.2, "1"), "stiff": (5e3, "N/m"), "free": (0.1, "m")},
    )
    t = np.linspace(0, 1, 201)
    start, speed = np.array([0.0]), np.array([2.0])
    scenario = Scenario(t, start, speed, t[[0, -1]], np.empty((2, 0)))
    made = simulate(build(model), scenario, exact=True)
    assert made.complete
    assert len(made.events) >= 4

    def rate(_: float, state: np.ndarray) -> list[float]:
        x, v = state
        pushed = 5e3 * (max(x - 0.1, 0.0) - max(-x - 0.1, 0.0))
        return [v, (-STIFFNESS * x - 0.2 * force(x, v) - pushed) / MASS]

    exact = solve_ivp(rate, (0, 1), [0.0, 2.0], t_eval=t, rtol=1e-9, atol=1e-11, max_step=1e-3)
    assert made.q[:, 0] == pytest.approx(exact.y[0], abs=2e-5)


NAMED = """[maps.valve]
units = ["m", "m/s", "N"]
x = [-1, 0, 1]
y = [-1, 0, 2]
values = [[-3, 0, 5], [-1, 0, 2], [-4, 1, 8]]
[elements.strut]
"""


def test_an_element_and_an_expression_with_one_map_do_the_same() -> None:
    element = 'kind = "map"\non = "x"\nmap = "valve"\n'
    law = 'kind = "law"\non = "x"\nforce = "-map(valve, x, x\')"\n'
    made = []
    for way in (element, law):
        machine = build(parse_model(DRIVEN_MASS + NAMED + way))
        made.append(value(machine.k_e, [0.5], [1.0], [], [2.0], 0.0, machine.values))
    assert made[0] == pytest.approx(made[1], rel=1e-15)
    assert made[0] == pytest.approx([2.0 - 25 * 0.5 - 0.6 - 2.75])
    other = build(parse_model(DRIVEN_MASS + NAMED.replace("8", "9") + law))
    assert value(other.k_e, [0.5], [1.0], [], [2.0], 0.0, other.values) != pytest.approx(made[0])


def test_a_potential_may_be_a_map() -> None:
    """Its forces are minus the slopes, exactly."""
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        bodies={"block": {"mass": "m", "at": ["x", "y"]}},
        maps={
            "hill": {
                "units": ["m", "m", "J"],
                "x": S.tolist(),
                "y": R.tolist(),
                "values": F.tolist(),
            }
        },
        energy={"potential": "2*map(hill, x, y)"},
    )
    machine, hill = build(model), surfaces()[0]
    for x, y in ((-0.7, 0.1), (0.05, -0.7), (0.2, 2.5)):
        made = value(machine.k_e, [x, y], [0.0, 0.0], [], [], 0.0, machine.values)
        slopes = [float(hill.slope(axis)(x, y)) for axis in "xy"]
        assert made == pytest.approx([-2 * one for one in slopes], rel=1e-10)


def test_a_coefficient_may_be_a_map_of_an_input_and_the_time() -> None:
    text = """[maps.fade]
units = ["N", "s", "1"]
x = [0, 10]
y = [0, 4]
values = [[1, 0.5], [2, 1]]
[elements.more]
kind = "damper"
on = "x"
damping = "d*map(fade, f, t)"
"""
    machine = build(parse_model(DRIVEN_MASS + text))
    made = value(machine.k_e, [0.1], [1.0], [], [5.0], 2.0, machine.values)
    assert made == pytest.approx([5.0 - 2.5 - 0.6 * (1 + 1.5 * 0.75)])


def test_an_angle_takes_degrees_and_torques() -> None:
    stop = {
        "kind": "map",
        "on": "phi",
        "units": ["deg", "rpm", "N*cm"],
        "x": [-90, 0, 90],
        "y": [-60, 0, 60],
        "values": [[-300, -200, -100], [-50, 0, 50], [50, 100, 150]],
    }
    model = model_of(
        coordinates={"phi": {"unit": "deg"}},
        parameters={"J": (0.1, "kg*m^2")},
        bodies={"rotor": {"mass": 1, "at": ["0", "0"], "inertia": "J", "angle": "phi"}},
        elements={"stop": stop},
    )
    machine = build(model)
    for at, rate, torque in ((np.pi / 4, 0, -0.5), (0, np.pi, -0.25), (-np.pi / 2, -np.pi, 2.5)):
        made = value(machine.k_e, [at], [rate], [], [], 0.0, machine.values)
        assert made == pytest.approx([torque])
