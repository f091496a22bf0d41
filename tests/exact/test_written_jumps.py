"""Jumps that a model file writes, located in exact runs: against SciPy with events, by hand, and
against the same law as friction or in closed form."""

import re
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from builders import DRIVEN_MASS, Entries, model_of, push, spring
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.exact.simulation import simulate
from symhyb.model.jumps import jumps
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
T = np.linspace(0, 5, 2001)


def oscillator(elements: Entries, **more: Entries) -> Model:
    """1 kg on a spring of 40 N/m."""
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "R": (0.5, "N"), "k": (40.0, "N/m"), "h": (0.02, "m")},
        bodies={"b": {"mass": "m", "at": ["x", "0"]}},
        elements={"spring": spring("k"), **elements},
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "push": {"measures": "m*x'' + k*x", "unit": "N"},
        },
        **more,
    )


def free_mass(elements: Entries) -> Model:
    """1 kg that nothing else holds."""
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "R": (0.5, "N")},
        bodies={"b": {"mass": "m", "at": ["x", "0"]}},
        elements=elements,
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


def run(
    model: Model, q: float = 0.1, v: float = 0.0, t: Array = T, u: Array | None = None
) -> Trajectory:
    t_u, u = (t[[0, -1]], np.empty((2, 0))) if u is None else (t, u[:, None])
    scenario = Scenario(t, np.array([q]), np.array([v]), t_u, u)
    found = simulate(build(model), scenario, exact=True)
    assert found.complete, found.reason
    return found


def edge(place: float, direction: int) -> Callable[[float, Array], float]:
    """An event of SciPy that ends the integration where x passes a place."""

    def passes(_: float, y: Array) -> float:
        return float(y[0] - place)

    passes.terminal, passes.direction = True, direction  # type: ignore[attr-defined]
    return passes


def test_a_relay_with_a_dead_zone_against_scipy_with_events() -> None:
    """Each switch of 5 s and the motion, integrated by hand from one switch to the next."""
    page = (Path(__file__).parents[2] / "docs" / "model-file.md").read_text(encoding="utf-8")
    examples = re.findall(r"^    symhyb .*?(?=^\S)", page, re.M | re.S)
    (example,) = [dedent(text) for text in examples if "[elements.relay]" in text]
    made = run(parse_model(example))
    now, y, zone, switches = 0.0, np.array([0.1, 0.0]), 1, list[float]()
    truth = np.empty((T.size, 2))
    while now < T[-1]:

        def rate(_: float, y: Array, zone: int = zone) -> list[float]:
            return [y[1], -40 * y[0] - 0.5 * zone]

        own = [edge(0.02, -1)] if zone == 1 else [edge(-0.02, 1)]
        own = [edge(0.02, 1), edge(-0.02, -1)] if zone == 0 else own
        rows = now <= T
        done = solve_ivp(
            rate, (now, T[-1]), y, "DOP853", rtol=1e-12, atol=1e-14, events=own, dense_output=True
        )
        truth[rows] = done.sol(T[rows]).T
        now, y = done.t[-1], done.y[:, -1]
        if done.status == 1:
            switches.append(now)
            zone = int(np.sign(y[0])) if zone == 0 else 0
    assert len(switches) == 22
    assert [event.time for event in made.events] == pytest.approx(switches, abs=1e-8)
    assert {event.element for event in made.events} == {"relay.jump1", "relay.jump2"}
    # x > h holds no more, then x < −h holds
    assert [event.transition for event in made.events[:4]] == [
        "switches -",
        "switches +",
        "switches -",
        "switches +",
    ]
    np.testing.assert_allclose(made.q[:, 0], truth[:, 0], atol=1e-8)
    np.testing.assert_allclose(made.v[:, 0], truth[:, 1], atol=1e-7)
    zones = np.where(made.q[:, 0] > 0.02, 1, np.where(made.q[:, 0] < -0.02, -1, 0))
    np.testing.assert_allclose(made.y[:, 1], -0.5 * zones, atol=1e-8)


def test_sign_of_the_speed_holds_as_friction_does() -> None:
    """The motion stays on a jump where both sides lead back to it."""
    made = run(oscillator({"rail": push("-R*sign(x')")}))
    truth = run(oscillator({"rail": {"kind": "friction", "on": "x", "coulomb": "R"}}))
    times = [event.time for event in truth.events]
    assert [event.time for event in made.events] == pytest.approx(times, abs=1e-9)
    assert [event.transition for event in made.events] == [
        "switches +",
        "switches -",
        "switches +",
        "stays on it",
    ]
    np.testing.assert_allclose(made.q, truth.q, atol=1e-9)
    np.testing.assert_allclose(made.y[:, 1], truth.y[:, 1], atol=1e-7)


def test_a_relay_leaves_its_jump_where_it_cannot_hold() -> None:
    """sign(x') under a growing push begins to slide where that exceeds R: 0.5 N at 2.5 s."""
    model = free_mass({"rail": push("-R*sign(x')"), "motor": push("0.2 N/s * t")})
    made = run(model, q=0.0)
    assert [event.transition for event in made.events] == ["switches +"]
    assert made.events[0].time == pytest.approx(2.5, abs=1e-9)
    late = np.maximum(T - 2.5, 0)
    np.testing.assert_allclose(made.q[:, 0], 0.2 * late**3 / 6, atol=1e-8)


def test_a_sliding_mode_runs_along_its_line() -> None:
    """x' + 3 x/s = 0 once it is reached: x falls as e^(−3 t), the push is what that takes."""
    made = run(oscillator({"relay": push("-10*R*sign(x' + 3*x/(1 s))")}))
    (event,) = made.events
    assert event.transition == "stays on it"
    late = event.time < T
    start = made.q[late, 0][0]
    fall = start * np.exp(-3 * (T[late] - T[late][0]))
    np.testing.assert_allclose(made.q[late, 0], fall, atol=1e-12)
    np.testing.assert_allclose(made.y[late, 1], 49 * fall, atol=1e-9)  # (k + 9 m/s²) x


def test_an_input_decides_and_is_at_its_jump_for_a_while() -> None:
    """The push acts while the signal is above 0, half of it where that is 0 for a while."""
    model = parse_model(DRIVEN_MASS.replace('force = "f"', 'force = "where(f > 0, 2 N, 0)"'))
    u = np.where(T < 1, 1 - T, np.where(T < 2, 0.0, np.minimum(0.0, 2 - T)))
    made = run(model, q=0.0, u=u)
    assert [event.time for event in made.events] == pytest.approx([1.0, 2.0], abs=1e-8)
    assert [event.transition for event in made.events] == ["stays on it", "switches -"]

    def rate(t: float, y: Array) -> list[float]:
        force = 2.0 if t < 1 else 1.0 if t < 2 else 0.0
        return [y[1], force - 25 * y[0] - 0.6 * y[1]]

    y, truth = np.zeros(2), np.empty((T.size, 2))
    for begin, end in ((0.0, 1.0), (1.0, 2.0), (2.0, 5.0)):
        rows = (begin <= T) & (end >= T)
        done = solve_ivp(rate, (begin, end), y, "DOP853", T[rows], rtol=1e-12, atol=1e-14)
        truth[rows], y = done.y.T, done.y[:, -1]
    np.testing.assert_allclose(made.q[:, 0], truth[:, 0], atol=1e-7)


def test_a_jump_in_the_rate_of_a_state() -> None:
    """An integrator that runs up and down between two times: a triangle, to the last digits."""
    ramp = {"r": {"unit": "N", "rate": "where(1 s < t < 2 s, 3 N/s, -1 N/s)"}}
    made = run(oscillator({"push": push("r")}, states=ramp), q=0.0)
    assert [event.time for event in made.events] == pytest.approx([1.0, 2.0], abs=1e-12)
    assert {event.element for event in made.events} == {"states.r.jump1", "states.r.jump2"}
    truth = np.where(T < 1, -T, np.where(T < 2, -1 + 3 * (T - 1), 2 - (T - 2)))
    np.testing.assert_allclose(made.z[:, 0], truth, atol=1e-9)


def test_a_switch_beside_friction_that_holds_lets_it_go() -> None:
    """A push of 0.4 N does not move what 0.5 N of friction hold, from 1 s on 0.7 N do."""
    rail = {"kind": "friction", "on": "x", "coulomb": "R"}
    model = free_mass({"rail": rail, "push": push("where(t < 1 s, 0.4 N, 0.7 N)")})
    made = run(model, q=0.0)
    assert [(e.element, e.transition) for e in made.events] == [
        ("rail", "slides +"),
        ("push.jump", "switches -"),
    ]
    assert made.events[0].time == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(made.q[:, 0], 0.1 * np.maximum(T - 1, 0) ** 2, atol=1e-9)


def test_what_switches_without_end_is_said() -> None:
    """Two relays that wind x and x' about 0 ever faster: the time of the end is finite."""
    model = free_mass({"relay": push("-R*(6*sign(x) + 2*sign(x'))")})
    scenario = Scenario(T, np.array([0.1]), np.zeros(1), T[[0, -1]], np.empty((2, 0)))
    made = simulate(build(model), scenario, exact=True)
    assert not made.complete
    assert "elements.relay.jump" in made.reason
    assert "without end (Zeno)" in made.reason


def test_one_jump_is_one_however_it_is_written() -> None:
    model = oscillator(
        {
            "a": push("where(x' > 0, R, -R)"),
            "b": push("where(0 < x', 0, R)"),
            "c": push("R*sign(-x')"),
            "d": push("where(h > x, R, 0)"),
            "e": push("where(x >= h, R, 0)"),
            "f": push("R*sign(k - 2 N/m)"),  # which never changes
        }
    )
    assert [jump.name for jump in jumps(model)] == ["a", "d"]
    made = run(model)
    assert {event.element for event in made.events} == {"a.jump", "d.jump"}
