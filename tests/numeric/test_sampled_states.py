"""Digital controllers of a model file against loops by hand: in runs and exact runs, begun at any
time; and what refuses them."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from textwrap import dedent

import numpy as np
import pytest
from builders import model_of, push, spring
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.errors import InputError
from symhyb.exact.simulation import simulate
from symhyb.export.spec import spec_of
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel

Array = NDArray[np.float64]
T = 0.004 * np.arange(1001)
EACH = pytest.mark.parametrize("exact", [False, True])


def page() -> Model:
    """The example of the documentation: a digital PI controller."""
    text = (Path(__file__).parents[2] / "docs" / "model-file.md").read_text(encoding="utf-8")
    examples = re.findall(r"^    symhyb .*?(?=^\S)", text, re.M | re.S)
    (example,) = [dedent(one) for one in examples if "every" in one]
    return parse_model(example)


def run(
    model: Model,
    t: Array,
    q: float,
    v: float,
    u: Callable[[Array], Array] | None = None,
    z: list[float] | None = None,
    exact: bool = False,
) -> Trajectory:
    t_u = np.linspace(t[0], t[-1], 4001)
    given = np.empty((4001, 0)) if u is None else u(t_u)[:, None]
    start = None if z is None else np.array(z)
    scenario = Scenario(t, np.array([q]), np.array([v]), t_u, given, z=start)
    made = simulate(build(model), scenario, exact=exact)
    assert made.complete, made.reason
    return made


def by_hand(
    t: Array,
    every: float,
    first: float,
    start: tuple[Array, Array],
    rate: Callable[[float, Array, Array], list[float]],
    after: Callable[[float, Array, Array], Array],
) -> tuple[Array, Array]:
    """States (N, X) and held values (N, H) at ``t``: SciPy from one sample to the next."""
    y, held = start
    states, values = np.empty((t.size, y.size)), np.empty((t.size, held.size))
    begin = max(int(np.ceil((t[0] - first) / every - 1e-9)), 0)
    instants = first + every * np.arange(begin, 1 + int((t[-1] - first) / every + 1e-9))
    now = float(t[0])
    for end in [*instants.tolist(), float(t[-1]) + 1e-9]:
        rows = (t >= now - 1e-12) & (t < end - 1e-12)
        if end > now:
            options = {"rtol": 1e-11, "atol": 1e-13, "dense_output": True}
            done = solve_ivp(rate, (now, end), y, "DOP853", args=(held,), **options)
            states[rows], values[rows], y = done.sol(t[rows]).T, held, done.y[:, -1]
        held, now = after(end, y, held), end
    return states, values


@EACH
def test_a_digital_pi_controller_is_that_of_a_loop_by_hand(exact: bool) -> None:
    """Samples at every 10 ms, outputs at every 4 ms; the wanted place steps at 1.003 s."""

    def wanted(t: Array | float) -> Array:
        return np.where(np.asarray(t) < 1.003, 0.0, np.minimum(5 * (np.asarray(t) - 1.003), 1.0))

    def rate(_: float, y: Array, held: Array) -> list[float]:
        return [y[1], held[1] - 4 * y[1]]

    def after(t: float, y: Array, held: Array) -> Array:
        off = float(wanted(t)) - y[0]
        total = held[0] + 0.01 * off
        return np.array([total, 60 * off + 40 * total - 5 * y[1]])

    states, held = by_hand(T, 0.01, 0.0, (np.array([0.1, 0.0]), np.zeros(2)), rate, after)
    made = run(page(), T, 0.1, 0.0, wanted, exact=exact)
    np.testing.assert_allclose(made.q[:, 0], states[:, 0], atol=1e-7)
    np.testing.assert_allclose(made.z, held, atol=1e-5)
    np.testing.assert_allclose(made.y[:, 1], held[:, 1], atol=1e-5)
    assert made.q[-1, 0] == pytest.approx(1.0, abs=0.05)


def relay() -> Model:
    """A mass on a spring under a relay with hysteresis that looks every 7 ms, from 3 ms on."""
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (40.0, "N/m"), "h": (0.02, "m"), "U": (2.0, "N")},
        states={
            "r": {
                "unit": "1",
                "start": 1.0,
                "every": "7 ms",
                "first": "3 ms",
                "next": "where(x > h, -1, where(x < -h, 1, r))",
            }
        },
        bodies={"b": {"mass": "m", "at": ["x", "0"]}},
        elements={"spring": spring("k"), "relay": push("U*r")},
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "force": {"measures": "U*r", "unit": "N"},
        },
    )


@EACH
@pytest.mark.parametrize("begin", [0.0, 1.2345])
def test_a_relay_with_hysteresis_begun_at_any_time(begin: float, exact: bool) -> None:
    """Begun between two samples it holds what it is given, until the next."""

    def rate(_: float, y: Array, held: Array) -> list[float]:
        return [y[1], 2 * held[0] - 40 * y[0]]

    def after(_: float, y: Array, held: Array) -> Array:
        return np.array([-1.0 if y[0] > 0.02 else 1.0 if y[0] < -0.02 else held[0]])

    t = begin + T
    states, held = by_hand(t, 0.007, 0.003, (np.array([0.03, 0.1]), np.array([1.0])), rate, after)
    made = run(relay(), t, 0.03, 0.1, z=[1.0], exact=exact)
    np.testing.assert_array_equal(made.z, held)
    np.testing.assert_allclose(made.q[:, 0], states[:, 0], atol=1e-7)
    np.testing.assert_array_equal(made.y[:, 1], 2 * held[:, 0])
    assert len(np.flatnonzero(np.diff(held[:, 0]))) > 5


def test_friction_that_holds_is_pushed_by_what_is_sampled() -> None:
    """0.5 N of friction hold against 0.4 N, and let go at the sample after which 0.7 N push; a
    valve that a condition on the held value opens is one jump with it."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "R": (0.5, "N")},
        states={"u": {"unit": "N", "every": 0.3, "next": "where(t < 1 s, 0.4 N, 0.6 N)"}},
        bodies={"b": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "rail": {"kind": "friction", "on": "x", "coulomb": "R"},
            "motor": push("u + where(u > 0.5 N, 0.1 N, 0)"),
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    made = run(model, T, 0.0, 0.0, exact=True)
    assert [(e.element, e.transition) for e in made.events] == [
        ("rail", "slides +"),
        ("motor.jump", "switches +"),
    ]
    assert [e.time for e in made.events] == pytest.approx([1.2, 1.2], abs=1e-12)
    np.testing.assert_allclose(made.q[:, 0], 0.1 * np.maximum(T - 1.2, 0) ** 2, atol=1e-9)


def test_states_of_two_rates_are_sampled_from_the_values_before() -> None:
    """A counter every 0.1 s, and one that takes it over every 0.2 s: at once, one behind."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        states={
            "n": {"unit": "1", "every": 0.1, "next": "n + 1"},
            "copy": {"unit": "1", "every": 0.2, "next": "n"},
        },
        bodies={"b": {"mass": "m", "at": ["x", "0"]}},
        sensors={"count": {"measures": "n + 0*x/(1 m)", "unit": "1"}},
    )
    t = 0.05 + 0.1 * np.arange(10)
    made = run(model, np.concatenate([[0.0], t]), 0.0, 0.0)
    np.testing.assert_array_equal(made.z[1:, 0], 1 + np.arange(10))
    np.testing.assert_array_equal(made.z[1:, 1], 2 * (np.arange(10) // 2))


@EACH
def test_a_chain_is_a_dead_time_of_whole_samples(exact: bool) -> None:
    """A spring whose force acts 20 ms late, by a controller that measures every 10 ms."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (40.0, "N/m"), "d": (2.0, "N*s/m")},
        states={
            "x0": {"unit": "m", "every": "10 ms", "next": "x"},
            "x1": {"unit": "m", "every": "10 ms", "next": "x0"},
            "x2": {"unit": "m", "every": "10 ms", "next": "x1"},
        },
        bodies={"b": {"mass": "m", "at": ["x", "0"]}},
        elements={"motor": push("-k*x2 - d*x'")},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    t = 0.01 * np.arange(401)
    made = run(model, t, 0.1, 0.0, exact=exact)
    np.testing.assert_allclose(made.z[2:, 2], made.q[:-2, 0], atol=1e-12)
    x, v, late = 0.1, 0.0, [0.0, 0.0]
    decay, places = np.exp(-2 * 0.01), []
    for _ in range(401):
        places.append(x)
        force, late = -40 * late[0], [late[1], x]
        v_end = force / 2 + (v - force / 2) * decay
        x, v = x + 0.01 * force / 2 + (v - force / 2) * (1 - decay) / 2, v_end
    np.testing.assert_allclose(made.q[:, 0], places, atol=1e-8)


def test_what_cannot_sample_says_so_with_the_cure() -> None:
    model = relay()
    machine = build(model)
    t = 0.01 * np.arange(400)
    recording = Recording("r.csv", t, {}, {"place": np.sin(t), "force": np.cos(t)}, (), "")
    said = r"states\.r: is sampled every 0\.007 s, which .* does not do; .*"
    with pytest.raises(InputError, match=said + 'as an input with between = "held"'):
        sh.diagnose(model, recording)
    with pytest.raises(InputError, match=said + 'as an input with between = "held"'):
        WindowModel(machine)
    with pytest.raises(InputError, match=said + "let the host sample"):
        spec_of(model, "relay", whole=True)
    assert replace(model.states[0], next=None).words == "r' = 0 [1/s]"
