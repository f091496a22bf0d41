"""Masses and inertias that change: by place against the same machine with bodies, by time against
SciPy and closed forms; in runs, windows, exact runs, exports and the printed equations."""

import re
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
import sympy as sp
from blocks import block
from builders import Entries, model_of, push, spring
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.errors import InputError
from symhyb.exact.simulation import simulate
from symhyb.mechanics.readable import readable
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel

Array = NDArray[np.float64]
T = np.linspace(0, 4, 801)
NUMBERS = {
    "m": (2.0, "kg"),
    "J": (0.3, "kg*m^2"),
    "e": (0.4, "m"),
    "c": (1.5, "N*m"),
    "k": (40.0, "N/m"),
    "w": (0.3, "kg/s"),
    "m_e": (0.5, "kg"),
}


def run(model: Model, q: list[float], v: list[float], exact: bool = False) -> Array:
    """Positions (N, n) of a run without inputs."""
    scenario = Scenario(T, np.array(q), np.array(v), T[[0, -1]], np.empty((2, 0)))
    made = simulate(build(model), scenario, exact=exact)
    assert made.complete, made.reason
    return made.q


def eccentric(bodies: Entries) -> Model:
    """A shaft on a torsion spring; what an eccentric of it moves is in ``bodies``."""
    return model_of(
        coordinates={"phi": {"unit": "rad"}},
        parameters=NUMBERS,
        bodies=bodies,
        elements={"spring": spring("c", "phi")},
        sensors={"angle": {"measures": "phi", "unit": "rad"}},
    )


@pytest.mark.parametrize("exact", [False, True])
def test_inertia_by_place_is_that_of_what_moves(exact: bool) -> None:
    """A slider at e·cos(phi) has the inertia m·e²·sin²(phi) about the shaft."""
    shaft = {"mass": "m", "at": ["0", "0"], "angle": "phi"}
    bent = eccentric({"shaft": {**shaft, "inertia": "J + m*e**2*sin(phi)**2"}})
    whole = eccentric(
        {"shaft": {**shaft, "inertia": "J"}, "slider": {"mass": "m", "at": ["e*cos(phi)", "0"]}}
    )
    found = run(bent, [0.5], [6.0], exact)
    np.testing.assert_allclose(found, run(whole, [0.5], [6.0], exact), atol=1e-6)
    assert np.ptp(found) > 3

    q, v, p = np.array([0.7]), np.array([2.0]), build(bent).values
    one, other = build(bent), build(whole)
    assert call(one.k_c, (q, v, 0.0, p))[0] == pytest.approx(call(other.k_c, (q, v, 0.0, p))[0])
    still = np.zeros(0)
    for name in ("weak", "discrepancy"):
        given = (q, v, *([2 * v] if name == "discrepancy" else []), still, still, 0.0, p)
        both = (call(getattr(machine, name), given) for machine in (one, other))
        for a, b in zip(*both, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-12)


def test_mass_by_place_without_gravity_follows_from_lagrange() -> None:
    """m(x) x'' + ½ m'(x) x'² = −k x, which conserves energy."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters=NUMBERS,
        bodies={"b": {"mass": "m*(1 + (x/e)**2)", "at": ["x", "0"]}},
        elements={"spring": spring("k")},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )

    def rate(_: float, y: Array) -> list[float]:
        x, v = y
        m, slope = 2 * (1 + (x / 0.4) ** 2), 4 * x / 0.4**2
        return [v, (-40 * x - slope * v**2 / 2) / m]

    truth = solve_ivp(rate, (0, 4), [0.3, 1.0], "DOP853", T, rtol=1e-11, atol=1e-13).y[0]
    np.testing.assert_allclose(run(model, [0.3], [1.0])[:, 0], truth, atol=1e-6)


def test_a_tensor_in_space_may_change_with_place() -> None:
    """A body about z whose inertia grows with the angle, printed and computed."""
    turned = [["z", "phi"], ["x", "theta"]]
    model = model_of(
        coordinates={"phi": {"unit": "rad"}, "theta": {"unit": "rad"}},
        parameters=NUMBERS,
        bodies={
            "rotor": {
                "mass": "m",
                "at": ["0", "0", "0"],
                "rotations": turned,
                "inertia": ["J*(2 + sin(phi))", "J*2", "J*(2 + cos(theta))"],
            }
        },
        sensors={"angle": {"measures": "phi", "unit": "rad"}},
    )
    printed_is_computed(model, [0.4, 0.9], [1.3, -0.7])


def tank(force: str = "0 N") -> Model:
    """A cart on a spring with a tank that runs empty, 0.3 kg/s down to 0.5 kg."""
    return model_of(
        gravity=["0", "-9.81 m/s^2"],
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters=NUMBERS,
        bodies={"cart": {"mass": "max(m - w*t, m_e)", "at": ["x", "y"]}},
        elements={"spring": spring("k"), "rope": spring("k", "y"), "jet": push(force)},
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "feel": {"measures": "accelerometer_y(p, cart)", "unit": "m/s^2"},
        },
        points={"p": {"body": "cart", "at": ["0", "0"]}},
    )


@pytest.mark.parametrize("exact", [False, True])
def test_what_leaves_in_time_takes_its_momentum_along(exact: bool) -> None:
    """m(t) x'' = −k x and m(t) y'' = −k y − m(t) g: no term m' x'."""

    def rate(t: float, y: Array) -> list[float]:
        m = max(2.0 - 0.3 * t, 0.5)
        return [y[2], y[3], -40 * y[0] / m, -40 * y[1] / m - 9.81]

    done = solve_ivp(
        rate, (0, 4), [0.1, 0, 0.5, 0], "DOP853", T, rtol=1e-11, atol=1e-13, max_step=0.01
    )
    found = run(tank(), [0.1, 0.0], [0.5, 0.0], exact)
    np.testing.assert_allclose(found, done.y[:2].T, atol=1e-6)


def test_the_example_of_the_page_is_that_of_scipy() -> None:
    page = (Path(__file__).parents[2] / "docs" / "model-file.md").read_text(encoding="utf-8")
    examples = re.findall(r"^    symhyb .*?(?=^\S)", page, re.M | re.S)
    (example,) = [dedent(text) for text in examples if "runs empty" in text]
    model = parse_model(example)

    def rate(t: float, y: Array) -> list[float]:
        return [y[1], -40 * y[0] / max(2.0 - 0.3 * t, 0.5)]

    truth = solve_ivp(rate, (0, 4), [0.1, 0], "DOP853", T, rtol=1e-11, atol=1e-13).y[0]
    np.testing.assert_allclose(run(model, [0.1], [0.0])[:, 0], truth, atol=1e-7)


def test_windows_integrate_it_from_any_time() -> None:
    """Two windows, the second of which begins at 2.5 s: each as SciPy has it from its start."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={**NUMBERS, "m": (2.0, "kg", 0.1)},
        bodies={"cart": {"mass": "max(m - w*t, m_e)", "at": ["x", "0"]}},
        elements={"spring": spring("k"), "motor": push("f")},
        inputs={"f": {"unit": "N"}},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    machine = build(model)
    t = np.array([0.0, 2.5])[:, None] + 0.01 * np.arange(120)
    windows, start = (
        block(t, 3 * np.sin(9 * t)[..., None], 2, substeps=3),
        np.array([[0.1, 0.5]] * 2),
    )
    x, _ = WindowModel(machine).simulate(windows, start, machine.values)

    def rate(t: float, y: Array) -> list[float]:
        return [y[1], (3 * np.sin(9 * t) - 40 * y[0]) / max(2.0 - 0.3 * t, 0.5)]

    for w in range(2):
        done = solve_ivp(rate, t[w, [0, -1]], [0.1, 0.5], "DOP853", t[w], rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(x[w], done.y.T, atol=2e-3)
    free = (machine.column("m"),)
    linear = WindowModel(machine, free).differentiate(windows, start, machine.values)
    p, h = machine.values, 1e-5
    moved = [
        WindowModel(machine).simulate(windows, start, p + s * h * np.eye(p.size)[free[0]])[1]
        for s in (1, -1)
    ]
    found = (moved[0] - moved[1]) / (2 * h)
    np.testing.assert_allclose(linear.from_free()[..., 0], found, atol=2e-3 * np.abs(found).max())


def test_a_free_tank_goes_on_at_its_speed_and_a_jet_drives_it_as_a_rocket() -> None:
    """A jet of c = 20 m/s: x' = c ln(m₀/m), the equation of Tsiolkovsky."""
    for force, speed in (("0 N", 0.0), ("20 m/s * w", 20 * np.log(2.0 / (2 - 0.3 * 4)))):
        model = model_of(
            coordinates={"x": {"unit": "m"}},
            parameters=NUMBERS,
            bodies={"cart": {"mass": "m - w*t", "at": ["x", "0"]}},
            elements={"jet": push(force)},
            sensors={"place": {"measures": "x", "unit": "m"}},
        )
        scenario = Scenario(T, np.zeros(1), np.ones(1), T[[0, -1]], np.empty((2, 0)))
        made = simulate(build(model), scenario)
        assert made.v[-1, 0] == pytest.approx(1 + speed, rel=1e-7)


def test_energy_with_a_mass_of_time_is_lagrange_as_it_stands() -> None:
    """[energy] m(t)·x'²/2 gives m x'' + m' x' = 0: what leaves is at rest."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters=NUMBERS,
        energy={"kinetic": "(m - w*t)*x'**2/2"},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    scenario = Scenario(T, np.zeros(1), np.ones(1), T[[0, -1]], np.empty((2, 0)))
    made = simulate(build(model), scenario)
    np.testing.assert_allclose(made.v[:, 0], 2.0 / (2 - 0.3 * T), rtol=1e-7)


def test_the_momentum_balance_of_the_weak_form_holds() -> None:
    """d/dt(m x') = k_e + m' x': what is gained counts what leaves."""
    machine = build(tank())
    q, v, p = np.array([0.2, 0.1]), np.array([1.0, -2.0]), machine.values
    momentum, gained = (part.reshape(-1) for part in call(machine.weak, (q, v, *NONE, 1.0, p)))
    np.testing.assert_allclose(momentum, 1.7 * v)
    (k_e,) = call(machine.k_e, (q, v, *NONE, 1.0, p))
    np.testing.assert_allclose(gained, k_e.reshape(-1) - 0.3 * v)
    (k_c,) = call(machine.k_c, (q, v, 1.0, p))
    np.testing.assert_allclose(k_c, 0, atol=1e-15)


NONE = (np.zeros(0), np.zeros(0))


def printed_is_computed(model: Model, q: list[float], v: list[float]) -> None:
    """The printed rows sum up to what is computed."""
    machine, full = build(model), readable(model, matrices=True)
    s = full.symbols
    p = machine.values
    values = dict(zip((*s.q, *s.v, *s.p, s.t), (*q, *v, *p, 0.8), strict=True))

    def value(side: str, *of: int) -> float:
        rows = [row.value for row in full.rows if (row.side, row.of) == (side, of)]
        total = sp.Add(*rows)
        for name in reversed(full.names):
            total = total.xreplace({name.symbol: name.value})
        return float(total.xreplace({k: sp.Float(x) for k, x in values.items()}).evalf())

    given = np.array(q), np.array(v), 0.8, p
    (k_c,) = call(machine.k_c, given)
    (mass,) = call(machine.M, (given[0], *given[2:]))
    (k_e,) = call(machine.k_e, (*given[:2], *NONE, *given[2:]))
    for i in range(len(q)):
        assert value("k_c", i) == pytest.approx(float(k_c.reshape(-1)[i]), abs=1e-12)
        assert value("k_e", i) == pytest.approx(float(k_e.reshape(-1)[i]), abs=1e-12)
        for j in range(i, len(q)):
            assert value("M", i, j) == pytest.approx(float(mass[i, j]), abs=1e-12)


def test_printed_equations_are_those_that_are_computed() -> None:
    shaft = {"mass": "m", "at": ["0", "0"], "angle": "phi"}
    printed_is_computed(
        eccentric({"shaft": {**shaft, "inertia": "J + m*e**2*sin(phi)**2 + J*w*t/m"}}),
        [0.7],
        [2.0],
    )
    printed_is_computed(tank(), [0.2, 0.1], [1.0, -2.0])


@pytest.mark.parametrize(
    ("bodies", "gravity", "said"),
    [
        (
            {"mass": "m*(1 + x/e)", "at": ["x", "0"]},
            ["0", "-9.81 m/s^2"],
            "'m*(1 + x/e)' depends on the place x, and gravity acts: at which height is what comes",
        ),
        ({"mass": "m*abs(x/e)", "at": ["x", "0"]}, None, "has no smooth speed, which a mass"),
        ({"mass": "m + w*x'", "at": ["x", "0"]}, None, "x' is a speed, on which a mass"),
        (
            {"mass": "m*f/(1 N)", "at": ["x", "0"]},
            None,
            "write its course as a curve over the time",
        ),
        ({"mass": "m - m_e*t", "at": ["x", "0"]}, None, "subtracts 'm' in kg and 'm_e*t' in kg*s"),
        ({"mass": "m*(t/(1 s))", "at": ["x", "0"]}, None, "the mass matrix is singular"),
    ],
)
def test_what_is_refused(bodies: Entries, gravity: list[str] | None, said: str) -> None:
    with pytest.raises(InputError) as caught:
        build(
            model_of(
                gravity=gravity,
                coordinates={"x": {"unit": "m"}},
                parameters=NUMBERS,
                inputs={"f": {"unit": "N"}},
                bodies={"b": bodies},
                sensors={"place": {"measures": "x", "unit": "m"}},
            )
        )
    assert said in str(caught.value)
