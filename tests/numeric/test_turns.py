"""Runs that change methods on the way: when, and with what result."""

from pathlib import Path

import numpy as np
import pytest
from builders import damper, oscillator, push, run, spring
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.compiled import find_compiler
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs import explicit_run, turns
from symhyb.numeric.runs.explicit import STIFF, Steps, Tolerances, field
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import LEFT, Scenario

Array = NDArray[np.float64]
MASS = 1.2  # kg, of builders.oscillator
INPUT = {"f": {"unit": "N"}}
MODELS = Path(__file__).parents[2] / "models"
pytestmark = pytest.mark.skipif(find_compiler() is None, reason="no C compiler")


def van_der_pol(strength: float) -> Model:
    """m x'' = μ (1 − x²/l²) x' − k x."""
    law = {"kind": "law", "on": "x", "force": "mu*(1 - x*x/(l*l))*x'"}
    values = {"mu": (strength, "N*s/m"), "l": (1.0, "m"), "k": (MASS, "N/m")}
    return oscillator({"odd": law, "hold": spring("k")}, values)


def oiled(damping: float) -> Model:
    """A mass on 100 N/m in thick oil, driven."""
    values = {"d": (damping, "N*s/m"), "k": (100.0, "N/m")}
    parts = {"oil": damper("d"), "hold": spring("k"), "motor": push("f")}
    return oscillator(parts, values, inputs=INPUT)


def arm(seconds: float) -> tuple[Machine, Scenario]:
    """The arm of six joints, all of its motors recorded at 200 Hz."""
    machine = build(read_model(MODELS / "six_joint_arm.toml"))
    t = np.linspace(0, seconds, round(200 * seconds) + 1)
    u = np.array([20, 40, 20, 3, 3, 1]) * np.sin(np.outer(t, 2 + np.arange(6)))
    q, v = (np.array(part) for part in machine.model.start())
    return machine, Scenario(t, q, v, t, u)


def never(*_: object, **__: object) -> tuple[Array, str]:
    raise AssertionError("CVODES was called")


def test_a_relaxation_oscillator_changes_to_bdf_and_agrees_with_radau() -> None:
    t = np.linspace(0, 900, 1801)
    found = run(van_der_pol(1000.0 * MASS), t, 2.0)
    assert (found.method, found.reason) == ("bdf", "")
    assert found.note.startswith("explicit up to 0.0")
    assert "stiff" in found.note

    def rate(_: float, y: Array) -> list[float]:
        return [y[1], 1000 * (1 - y[0] ** 2) * y[1] - y[0]]

    def slope(_: float, y: Array) -> list[list[float]]:
        return [[0, 1], [-2000 * y[0] * y[1] - 1, 1000 * (1 - y[0] ** 2)]]

    truth = solve_ivp(rate, (0, 900), [2.0, 0.0], "Radau", t, rtol=1e-9, atol=1e-11, jac=slope).y[0]
    assert np.ptp(truth) > 3.9  # it jumps
    assert np.abs(found.q[:, 0] - truth).max() < 1e-4


def test_a_stiff_run_agrees_with_its_closed_form() -> None:
    """m x'' + d x' + k x = 0: roots −d/m and −k/d, a million times apart."""
    damping, t = 1e6, np.linspace(0, 10, 201)
    model = oscillator(
        {"oil": damper("d"), "hold": spring("k")}, {"d": (damping, "N*s/m"), "k": (1e5, "N/m")}
    )
    found = run(model, t, 0.3)
    slow, fast = sorted(np.roots([MASS, damping, 1e5]), key=abs)
    x = 0.3 * (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow)
    assert (found.method, found.reason) == ("bdf", "")
    assert found.q[:, 0] == pytest.approx(x, rel=1e-6)


def test_an_arm_under_six_recorded_inputs_stays_explicit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its decays are fast, and its steps shorter still, from sample to sample."""
    monkeypatch.setattr(turns, "implicit_states", never)
    found = simulate(*arm(1.0))
    assert (found.method, found.reason, found.note) == ("explicit", "", "")


def test_bends_of_a_drive_are_no_work_that_a_run_is_stopped_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(explicit_run, "STEPS_MOST", 1000)
    monkeypatch.setattr(turns, "implicit_states", never)
    machine, scenario = arm(1.0)
    assert scenario.t_u.size == 201  # three steps from one to the next
    assert simulate(machine, scenario).method == "explicit"


def test_without_a_compiler_the_arm_goes_by_adams(monkeypatch: pytest.MonkeyPatch) -> None:
    """A decay that is slower than the samples of what drives it is not stiff."""
    by_steps = simulate(*arm(0.25))
    monkeypatch.setattr("symhyb.numeric.runs.integrate.field", lambda form: None)
    found = simulate(*arm(0.25))
    assert (found.method, found.reason) == ("adams", "")
    assert found.q == pytest.approx(by_steps.q, abs=1e-6)


def test_where_bdf_was_tried_and_is_slower_the_run_is_the_explicit_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A drive that bends at every sample, where BDF begins anew."""
    t = np.linspace(0, 4, 801)
    tried: list[str] = []

    def counted(*given: object, **more: object) -> tuple[Array, str]:
        tried.append("once")
        return turns_states(*given, **more)  # type: ignore[arg-type]

    turns_states = turns.implicit_states
    monkeypatch.setattr(turns, "implicit_states", counted)
    found = run(oiled(2e5), t, 0.3, 0.0, 5 * np.sin(3 * t))
    assert tried
    monkeypatch.setattr(explicit_run, "AT_STAKE", np.inf)
    monkeypatch.setattr(turns, "implicit_states", never)
    alone = run(oiled(2e5), t, 0.3, 0.0, 5 * np.sin(3 * t))
    assert (found.method, found.note) == (alone.method, alone.note) == ("explicit", "")
    assert np.array_equal(found.q, alone.q)


def test_a_bound_is_kept_over_a_change_and_rows_beyond_are_nan() -> None:
    """m x'' + d x' = k x: x = x0 exp(r t) with r = 0.4/s nearly, after a decay within 1 µs."""
    t = np.linspace(0, 20, 2001)
    model = oscillator(
        {"oil": damper("d"), "fall": spring("k")}, {"d": (1e6, "N*s/m"), "k": (-4e5, "N/m")}
    )
    bound = np.array([50.0, 1e9])
    scenario = Scenario(t, np.ones(1), np.zeros(1), t, np.empty((t.size, 0)), bound=bound)
    found = simulate(build(model), scenario)
    rise = float(np.roots([MASS, 1e6, -4e5]).max())
    assert "BDF" in found.note
    assert found.reason.startswith(LEFT)
    good = np.isfinite(found.q[:, 0])
    assert t[good][-1] == pytest.approx(np.log(50) / rise, abs=0.011)
    assert not good[np.argmin(good) :].any()
    assert found.q[good, 0] == pytest.approx(np.exp(rise * t[good]), rel=1e-5)


def test_what_was_stiff_for_a_while_is_explicit_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Oil in which the mass is slow at first, and which then fades away."""
    law = {"kind": "law", "on": "x", "force": "-d*x'*exp(-t/tau)"}
    values = {"d": (1e8, "N*s/m"), "tau": (0.05, "s"), "k": (300.0, "N/m")}
    model = oscillator({"odd": law, "hold": spring("k")}, values)
    t = np.linspace(0, 10, 2001)
    found = run(model, t, 0.3)
    assert (found.method, found.reason) == ("explicit", "")
    assert "explicit again from" in found.note
    monkeypatch.setattr("symhyb.numeric.runs.integrate.field", lambda form: None)
    other = run(model, t, 0.3)
    assert other.method in ("adams", "bdf")
    assert np.abs(other.q).max() > 0.1
    assert found.q == pytest.approx(other.q, abs=1e-5)


def test_a_run_that_no_method_gets_through_keeps_its_rows_and_says_why() -> None:
    """x'' = −c/x³ from rest: the rates grow without bound where x reaches 0."""
    law = {"kind": "law", "on": "x", "force": "-c/(x*x*x)"}
    model = oscillator({"odd": law}, {"c": (MASS, "N*m^3")}, start=1.0)
    t = np.linspace(0, 3, 301)  # x² = 1 − t²
    found = run(model, t, 1.0)
    good = np.isfinite(found.q[:, 0])
    assert found.reason
    assert found.note.startswith("explicit up to")
    assert found.q[good, 0] == pytest.approx(np.sqrt(1 - t[good] ** 2), abs=1e-4)
    assert 98 <= good.sum() <= 101
    assert not good[np.argmin(good) :].any()


def stepped(model: Model, end: float) -> Steps:
    """The explicit method alone, which ends where it finds the run stiff."""
    machine = build(model)
    rates = field(state_form(machine))
    assert rates is not None
    t = np.array([0.0, end])
    limits = Tolerances(1e-8, np.full(2, 1e-10), np.full(2, 1e9), 10**6)
    nodes = (t, np.zeros((2, 0)))
    return rates.integrate(t, np.array([0.3, 0.0]), machine.values, nodes, limits, suspect=np.inf)


def test_stiff_is_what_decays_within_a_step_and_not_what_swings_fast() -> None:
    """Steps at the border of stability, h d/m = 6.1, against 16 periods that accuracy follows."""
    swing = stepped(oscillator({"hold": spring("k")}, {"k": (1.2e4, "N/m")}), 1.0)
    assert (swing.reason, swing.t) == ("", 1.0)
    values = {"d": (1.2e3, "N*s/m"), "k": (1.2, "N/m")}
    decay = stepped(oscillator({"oil": damper("d"), "hold": spring("k")}, values), 10.0)
    assert decay.reason == STIFF
    assert decay.t < 0.5
    assert decay.last[0] == pytest.approx(0.3 * np.exp(-decay.t / 1e3), rel=1e-5)
