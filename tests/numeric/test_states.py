"""Declared states in runs, along measured motions and in exact runs, against SciPy and closed
forms."""

import numpy as np
import pytest
from builders import model_of
from motors import MOTOR, D, J, K, L, R, motor, turned
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.exact.simulation import simulate
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.inner import inner_along, settled
from symhyb.numeric.lowered.linear import state_slope
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import Block, WindowModel
from symhyb.simulation import run_model, run_table

Array = NDArray[np.float64]


def scenario(t: Array, u: Array, n: int = 1) -> Scenario:
    return Scenario(t, np.zeros(n), np.zeros(n), t, u.reshape(t.size, -1))


def test_a_run_is_that_of_scipy() -> None:
    """SciPy is given the straight lines between the samples, as the run is."""
    t, u, _ = turned(samples=600)

    def rates(time: float, state: Array) -> list[float]:
        _, speed, current = state
        volts = float(np.interp(time, t, u))
        held = (K * current - D * speed) / J
        return [speed, held, (volts - R * current - K * speed) / L]

    options = {"method": "LSODA", "rtol": 1e-9, "atol": 1e-11, "max_step": 2.5e-4}
    true = solve_ivp(rates, (0, t[-1]), [0.0, 0.0, 0.0], t_eval=t, **options).y
    run = simulate(build(motor(ammeter=True)), scenario(t, u))
    np.testing.assert_allclose(run.q[:, 0], true[0], atol=2e-6 * np.ptp(true[0]))
    np.testing.assert_allclose(run.z[:, 0], true[2], atol=2e-6 * np.ptp(true[2]))
    np.testing.assert_allclose(run.y[:, 1], run.z[:, 0], rtol=1e-12)


def test_a_run_shows_them_in_their_unit() -> None:
    """A sensor of the same name comes first."""
    text = MOTOR.replace('unit = "A",', 'unit = "mA", start = 40.0,')
    machine, given, run = run_model(parse_model(text), end=0.01, step=0.01)
    names = [name for name, _, _ in run.signals()]
    assert names == ["encoder", "phi", "phi'", "phi''", "i"]
    head, first, _ = run_table(machine, given, run).splitlines()
    assert head.endswith(",phi [rad],phi' [rad/s],i [mA]")
    assert first.endswith(",40")
    named = parse_model(text + 'i = { measures = "i", unit = "A" }\n')
    machine, given, run = run_model(named, end=0.01, step=0.01)
    assert run_table(machine, given, run).startswith("t [s],u [V],encoder [rad],i [A],")
    assert "i (state)" in [name for name, _, _ in run.signals()]


def test_states_act_on_each_other_and_have_limits() -> None:
    """A controller with an integrator and a limit drives a mass through a filter."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        states={
            "e": {"unit": "m*s", "rate": "w - x"},
            "y": {"unit": "N", "start": 0.5, "rate": "(max(-f, min(f, p*(w - x) + q*e)) - y)/T"},
        },
        parameters={
            "m": (2.0, "kg"),
            "p": (30.0, "N/m"),
            "q": (8.0, "N/m/s"),
            "T": (50.0, "ms"),
            "f": (4.0, "N"),
            "d": (6.0, "N*s/m"),
        },
        inputs={"w": {"unit": "m"}},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "drive": {"kind": "force", "on": "x", "force": "y"},
            "rail": {"kind": "damper", "on": "x", "damping": "d"},
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    t = np.linspace(0, 6, 601)
    wanted = np.where(t < 3, 0.4, -0.2)

    def rates(time: float, state: Array) -> list[float]:
        x, v, e, y = state
        w = float(np.interp(time, t, wanted))
        asked = min(max(30 * (w - x) + 8 * e, -4.0), 4.0)
        return [v, (y - 6 * v) / 2, w - x, (asked - y) / 0.05]

    options = {"rtol": 1e-9, "atol": 1e-11, "max_step": 0.01}
    true = solve_ivp(rates, (0, 6), [0, 0, 0, 0.5], t_eval=t, method="LSODA", **options).y
    run = simulate(build(model), scenario(t, wanted))
    np.testing.assert_allclose(run.q[:, 0], true[0], atol=1e-6)
    np.testing.assert_allclose(run.z, true[2:].T, atol=2e-5)


def test_windows_take_the_states_along() -> None:
    t, u, (phi, w, i) = turned(samples=200)
    machine = build(motor())
    start = np.array([[phi[50], w[50], i[50]]])
    rows = slice(50, 150)
    block = Block(
        t[None, rows],
        u[None, rows, None],
        np.empty((1, 100, 1)),
        np.full((1, 99), 8),
        (t, u[:, None]),
    )
    states, y = WindowModel(machine).simulate(block, start, machine.values)
    np.testing.assert_allclose(states[0, :, 2], i[rows], atol=5e-3 * np.ptp(i))
    np.testing.assert_allclose(y[0, :, 0], phi[rows], atol=2e-3 * np.ptp(phi))


def test_along_a_motion_a_state_begins_at_what_it_settles_to() -> None:
    """i = (u − k φ')/R at the first sample, whatever the truth began with; it is forgotten."""
    t, u, (phi, w, i) = turned(samples=400, begin=-3.0)
    a = np.gradient(w, t)
    machine = build(motor())
    motion = phi[:, None], w[:, None], a[:, None]
    (z,) = inner_along(machine, t, motion, u[:, None], machine.values).T
    assert z[0] == pytest.approx((u[0] - K * w[0]) / R, rel=1e-9)
    np.testing.assert_allclose(z[20:], i[20:], atol=6e-3 * np.ptp(i))
    moved = inner_along(machine, t, motion, u[:, None], machine.values, off=np.array([0.5]))
    assert moved[0, 0] - z[0] == pytest.approx(0.5)
    assert moved[1, 0] - z[1] == pytest.approx(0.5 * np.exp(-R / L * 0.005), rel=0.01)


def loops(**states: dict[str, object]) -> Model:
    return model_of(
        coordinates={"x": {"unit": "m"}},
        states=states,
        parameters={"m": (1.0, "kg"), "T": (2.0, "s"), "w": (3.0, "1/s"), "s": (1.0, "m")},
        inputs={"u": {"unit": "m"}},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


@pytest.mark.parametrize(
    ("states", "begins", "settles"),
    [
        ({"a": {"unit": "m", "rate": "(u - a)/T", "start": 7.0}}, [0.8], [True]),
        ({"a": {"unit": "m*s", "rate": "u - x", "start": 7.0}}, [7.0], [False]),
        ({"a": {"unit": "m", "rate": "(a - u)/T", "start": 7.0}}, [7.0], [False]),
        (
            {  # of second order: each holds the other
                "a": {"unit": "m", "rate": "b"},
                "b": {"unit": "m/s", "rate": "w**2*(u - a) - w*b", "start": 4.0},
            },
            [0.8, 0.0],
            [True, True],
        ),
        (
            {  # the filter follows the integrator, which stays where it begins
                "e": {"unit": "m*s", "rate": "u - x", "start": 5.0},
                "f": {"unit": "m", "rate": "(e/T - f)/T", "start": 1.0},
            },
            [5.0, 2.5],
            [False, True],
        ),
        ({"a": {"unit": "m", "rate": "(u - a**3/s**2)/T", "start": 1.0}}, [0.8 ** (1 / 3)], [True]),
    ],
)
def test_what_decays_settles_and_what_does_not_begins_at_its_start(
    states: dict[str, dict[str, object]], begins: list[float], settles: list[bool]
) -> None:
    machine, still = build(loops(**states)), np.zeros(1)
    z, found = settled(machine, still, still, np.array([0.8]), 0.0, machine.values)
    np.testing.assert_allclose(z, begins, rtol=1e-9, atol=1e-12)
    assert found.tolist() == settles


def test_the_linearised_machine_holds_them() -> None:
    machine = build(motor())
    form = state_form(machine)
    matrix = state_slope(form, np.zeros(3), np.zeros(1), 0.0, machine.values)
    expected = [[0, 1, 0], [0, -D / J, K / J], [0, -K / L, -R / L]]
    np.testing.assert_allclose(matrix, expected, rtol=1e-12, atol=1e-12)


def test_an_exact_run_breaks_away_when_the_current_has_risen() -> None:
    """At rest under 2 V the torque is k U/R (1 − e^(−t R/L)); dry friction of 0.06 N·m gives way
    at t = −L/R ln(1 − 0.06 R/(k U)); a voltage below R F/k never moves it."""
    rubs = '[elements.rub]\nkind = "friction"\non = "phi"\ncoulomb = "F"\n'
    model = motor(rubs + '[elements.rub.parameters]\nF = { value = 0.06, unit = "N*m" }\n')
    t = np.linspace(0, 0.05, 101)
    for volts in (1.1, 2.0):
        given = Scenario(t, np.zeros(1), np.zeros(1), t[[0, -1]], np.full((2, 1), volts))
        run = simulate(build(model), given, exact=True)
        slides = [event.time for event in run.events if event.transition == "slides +"]
        if volts < 1.2:
            assert not slides
            assert np.abs(run.q).max() == 0
            np.testing.assert_allclose(run.z[:, 0], volts * (1 - np.exp(-t * R / L)), atol=1e-8)
        else:
            assert slides == [pytest.approx(-L / R * np.log(1 - 0.06 * R / (K * volts)), rel=1e-6)]


def test_a_state_may_stand_beside_a_loop() -> None:
    """Constraints close without the rates, which name an input."""
    text = (
        'symhyb = 1\n[coordinates]\nx = { unit = "m" }\nphi = { unit = "rad" }\n'
        '[states]\ni = { unit = "N", rate = "(u - i)/T" }\n'
        '[parameters]\nm = { value = 1.0, unit = "kg" }\nr = { value = 0.1, unit = "m" }\n'
        'T = { value = 0.2, unit = "s" }\n[inputs]\nu = { unit = "N" }\n'
        '[bodies.cart]\nmass = "m"\nat = ["x", "0"]\n'
        '[constraints.wheel]\nkind = "rolling"\non = ["x", "phi"]\nradius = "r"\n'
        '[elements.drive]\nkind = "force"\non = "x"\nforce = "i"\n'
        '[sensors]\nturn = { measures = "phi", unit = "rad" }\n'
    )
    t = np.linspace(0, 1, 101)
    run = simulate(build(parse_model(text)), scenario(t, np.ones(t.size), 2))
    expected = t**2 / 2 - 0.2 * t + 0.04 * (1 - np.exp(-t / 0.2))
    np.testing.assert_allclose(run.q[:, 0], expected, atol=1e-7)
    np.testing.assert_allclose(run.y[:, 0], expected / 0.1, atol=1e-6)
