"""Slopes of whole runs: closed forms, forward against adjoint, finite differences."""

import numpy as np
import pytest
from builders import cart_pole, damper, oscillator, pendulum, push, spring
from numpy.typing import NDArray

from symhyb.errors import NumericsError
from symhyb.numeric.kernels import compiled
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation import rollout
from symhyb.optimisation.rollout import Rollout, Slopes

Array = NDArray[np.float64]
INPUT = {"f": {"unit": "N"}}
needs_compiler = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")
pytestmark = needs_compiler


def driven(
    machine: Machine, end: float, outputs: int, start: list[float], every: int = 1
) -> Scenario:
    """A run with inputs at every ``every``-th output."""
    t = np.linspace(0, end, outputs)
    t_u = t[::every]
    u = np.column_stack([1.5 * np.sin((3 + i) * t_u) for i in range(len(machine.model.inputs))])
    return Scenario(t, np.array(start), np.full(machine.n, 0.1), t_u, u)


def cart() -> tuple[Rollout, Scenario]:
    machine = build(cart_pole())
    scenario = driven(machine, 1.0, 201, [0.0, 0.4], 5)
    return Rollout(machine, scenario, ["a", "d", "k", "m_p", "c"]), scenario


def remembering() -> tuple[Rollout, Scenario]:
    """A spring that relaxes, which has an inner state."""
    slow = {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"}
    machine = build(
        oscillator(
            {"it": slow, "hold": spring("s"), "motor": push("f")},
            {"k": (60.0, "N/m"), "d": (6.0, "N*s/m"), "s": (90.0, "N/m")},
            inputs=INPUT,
        )
    )
    scenario = driven(machine, 2.0, 101, [0.03])
    return Rollout(machine, scenario, ["k", "d", "m"]), scenario


MADE = {"cart and pole": cart, "inner state": remembering}


def drawn(run: Rollout, seed: int) -> tuple[Slopes, Array]:
    """A change of all arguments, and weights of what the sensors record."""
    rng = np.random.default_rng(seed)
    by = Slopes(
        rng.normal(size=run.theta.size) * run.theta,
        0.1 * rng.normal(size=run.start.size),
        rng.normal(size=run.inputs.shape),
    )
    return by, rng.normal(size=run.shape)


def against(slopes: Slopes, by: Slopes) -> float:
    """The change that the slopes say."""
    pairs = ((slopes.free, by.free), (slopes.start, by.start), (slopes.inputs, by.inputs))
    return float(sum(np.sum(a * b) for a, b in pairs))


@pytest.mark.parametrize("make", MADE.values(), ids=MADE)
def test_a_rollout_is_the_run_that_simulate_makes(make) -> None:
    run, scenario = make()
    reported = simulate(run.machine, scenario)
    assert run() == pytest.approx(reported.y, abs=1e-6)
    assert run.states()[:, : run.machine.n] == pytest.approx(reported.q, abs=1e-6)


def test_slopes_of_a_free_oscillation_are_those_of_its_closed_form() -> None:
    """x = x0 cos ωt, ω² = k/m: ∂x/∂k = −x0 t sin ωt/(2mω), ∂x/∂x0 = cos ωt, ∂x/∂v0 = sin ωt/ω."""
    machine = build(oscillator({"hold": spring("k")}, {"k": (300.0, "N/m")}))
    t = np.linspace(0, 5, 301)
    scenario = Scenario(t, np.array([0.02]), np.zeros(1), t[[0, -1]], np.empty((2, 0)))
    run, m, k = Rollout(machine, scenario, ["k"], 1e-12), 1.2, 300.0
    omega = np.sqrt(k / m)
    s, c = np.sin(omega * t), np.cos(omega * t)
    weights = np.random.default_rng(3).normal(size=(301, 1))
    found = run.pull_back(weights)
    by_k = -0.02 * t * s / (2 * m * omega)
    assert found.free[0] == pytest.approx(weights[:, 0] @ by_k, rel=1e-8)
    assert found.start == pytest.approx([weights[:, 0] @ c, weights[:, 0] @ s / omega], rel=1e-8)
    pushed = run.push(Slopes(np.array([2.0]), np.zeros(2), np.empty((2, 0))))
    assert pushed[:, 0] == pytest.approx(2 * by_k, abs=1e-8 * np.abs(by_k).max())


@pytest.mark.parametrize("make", MADE.values(), ids=MADE)
def test_forward_and_adjoint_slopes_are_the_same_and_those_of_differences(make) -> None:
    """Differences of fourth order along a direction that changes everything."""
    run, _ = make()
    by, weights = drawn(run, 1)
    found = against(run.pull_back(weights), by)
    assert np.sum(weights * run.push(by)) == pytest.approx(found, rel=1e-9)

    def along(h: float) -> float:
        moved = run(run.theta + h * by.free, run.start + h * by.start, run.inputs + h * by.inputs)
        return float(np.sum(weights * moved))

    h = 1e-4
    steps = 8 * (along(h) - along(-h)) - (along(2 * h) - along(-2 * h))
    assert found == pytest.approx(steps / (12 * h), rel=2e-7)


@pytest.mark.parametrize("make", MADE.values(), ids=MADE)
def test_the_slopes_of_every_sample_are_those_of_differences_and_of_the_adjoint(make) -> None:
    run, _ = make()
    found, theta = run.jacobian(), run.theta
    assert found.shape == (*run.shape, theta.size)
    weights = np.random.default_rng(6).normal(size=run.shape)
    forward = np.einsum("nmf,nm->f", found, weights) * theta
    adjoint = run.pull_back(weights).free * theta
    assert forward == pytest.approx(adjoint, abs=1e-8 * np.abs(adjoint).max())
    for i, way in enumerate(np.diag(1e-4 * theta)):
        steps = 8 * (run(theta + way) - run(theta - way)) - (
            run(theta + 2 * way) - run(theta - 2 * way)
        )
        known = steps / (12 * way[i])
        assert found[:, :, i] == pytest.approx(known, abs=1e-6 * np.abs(known).max())


def test_without_free_parameters_there_are_no_slopes_by_them() -> None:
    run, scenario = cart()
    assert Rollout(run.machine, scenario).jacobian().shape == (*run.shape, 0)


def test_weights_of_states_are_pulled_back_too() -> None:
    run, _ = cart()
    by, _ = drawn(run, 2)
    states = np.random.default_rng(5).normal(size=run.states().shape)
    found = against(run.pull_back(np.zeros(run.shape), states=states), by)
    assert found == pytest.approx(np.sum(states * run.pushed(by)[1]), rel=1e-9)


def test_a_tape_that_is_too_short_is_replaced() -> None:
    """Ten times the stiffness asks for three times the steps that were foreseen."""
    machine = build(oscillator({"hold": spring("k")}, {"k": (3.0, "N/m")}))
    t = np.array([0.0, 9.0])
    run = Rollout(machine, Scenario(t, np.ones(1), np.zeros(1), t, np.empty((2, 0))), ["k"])
    omega = np.sqrt(30000 / 1.2)
    (slope,) = run.pull_back(np.array([[0.0], [1.0]]), np.array([30000.0])).free
    assert slope == pytest.approx(-9 * np.sin(9 * omega) / (2 * 1.2 * omega), rel=1e-5)


def test_a_run_that_fails_has_no_slopes() -> None:
    soft = {"kind": "spring", "on": "x", "stiffness": "k", "cubic": "c"}
    machine = build(oscillator({"soft": soft}, {"k": (50.0, "N/m"), "c": (50.0, "N/m^3")}))
    t = np.linspace(0, 20, 21)
    run = Rollout(machine, Scenario(t, np.ones(1), np.zeros(1), t, np.empty((21, 0))), ["k", "c"])
    bad = np.array([50.0, -100.0])
    y = run(bad)
    assert np.isfinite(y[0]).all()
    assert np.isnan(y[-1]).all()
    assert np.isnan(run.pull_back(np.ones((21, 1)), bad).free).all()


def test_what_makes_no_rollout_is_refused() -> None:
    machine = build(pendulum())
    t = np.linspace(0, 1, 11)
    scenario = Scenario(t, np.ones(1), np.zeros(1), t, np.empty((11, 0)))
    with pytest.raises(ValueError, match=r"no parameter 'n'; there are g, m, l, J"):
        Rollout(machine, scenario, ["n"])
    run = Rollout(machine, scenario, ["m"])
    with pytest.raises(ValueError, match="theta has 2 numbers, needs 1"):
        run(np.ones(2))


def test_without_a_compiler_there_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rollout, "field_of", lambda function: None)
    monkeypatch.setattr(rollout, "kept", lambda key, make: make())
    machine = build(oscillator({"oil": damper("d")}, {"d": (0.5, "N*s/m")}))
    t = np.linspace(0, 1, 11)
    scenario = Scenario(t, np.ones(1), np.zeros(1), t, np.empty((11, 0)))
    with pytest.raises(NumericsError, match=r"need a C compiler.*step_function needs none"):
        Rollout(machine, scenario, ["d"])
    assert kept is not rollout.kept
