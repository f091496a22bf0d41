"""The force that swings the pole up, from a model alone: multiple shooting, then exact runs.

    minimise  ∫ (push² + (τ push')²) dt
    so that   hanging and at rest at 0, upright and at rest at T,  |x| ≤ rail,  |push| ≤ most

``shoot`` asks IPOPT, with the steps of the model as constraints. Dry friction reverses within one
of these steps; so ``polish`` changes the force as little as will do until a run with error control
ends upright. Sizes: K = N + 1 values of the force, P parameters, 4 states.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

import symhyb as sh
from symhyb.optimisation.opti import step_function

Array = NDArray[np.float64]

LASTING, STEPS = 2.0, 200  # s
RAIL, MOST = 0.35, 8.0  # m, N: the motor can do more, for feedback
SMOOTH = 0.02  # s, τ
HANGING, UPRIGHT = np.zeros(4), np.array([0.0, np.pi, 0.0, 0.0])
TRANSITIONS = (0.1, 0.03, 0.01)  # m/s: friction turns that softly in the plan, one after the other


@dataclass(frozen=True, slots=True)
class Plan:
    """A force (K,) in N and the states (K, 4) that its model promises, SI, every LASTING/STEPS."""

    push: Array
    states: Array


def shoot(machine: sh.Machine, p: Array, guess: Plan | None = None) -> Plan:
    """The plan of a model with parameters ``p`` (P,), SI, whose steps have ends that meet."""
    h, problem = LASTING / STEPS, ca.Opti()
    x, u = problem.variable(4, STEPS + 1), problem.variable(1, STEPS + 1)
    step = step_function(machine, stiff=True).map(STEPS)
    times, values = h * np.arange(STEPS)[None], np.tile(p[:, None], STEPS)
    problem.subject_to(x[:, 1:] == step(x[:, :-1], u[:, :-1], u[:, 1:], times, h, values))
    problem.subject_to(x[:, 0] == HANGING)
    problem.subject_to(x[:, -1] == UPRIGHT)
    problem.subject_to(problem.bounded(-RAIL, x[0, :], RAIL))
    problem.subject_to(problem.bounded(-MOST, u, MOST))
    rise = (u[:, 1:] - u[:, :-1]) / h
    problem.minimize(h * ca.sumsqr(u) + h * SMOOTH**2 * ca.sumsqr(rise))
    straight = np.outer(UPRIGHT, np.linspace(0, 1, STEPS + 1))
    problem.set_initial(x, straight if guess is None else guess.states.T)
    problem.set_initial(u, 0 if guess is None else guess.push[None])
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    problem.solver("ipopt", quiet | {"ipopt.max_iter": 1000})
    found = problem.solve()
    return Plan(np.asarray(found.value(u)).ravel(), np.asarray(found.value(x)).T)


def polish(machine: sh.Machine, push: Array, most: int = 20) -> Plan:
    """The force nearest to ``push`` under which a run of the model ends upright.

    Newton's method with the smallest change that will do, slopes by the adjoint.

    Raises:
        RuntimeError: it does not come there, or the force grows beyond what the motor can do.
    """
    t = np.linspace(0, LASTING, STEPS + 1)
    scenario = sh.Scenario(t, HANGING[:2], HANGING[2:], t, push[:, None])
    run, force = sh.Rollout(machine, scenario), push[:, None]
    for _ in range(most):
        states = run.states(inputs=force)
        error = UPRIGHT - states[-1]
        if np.abs(error).max() < 1e-9:
            return Plan(force[:, 0], states)
        slopes = []
        for weight in np.eye(4):
            seed = np.zeros_like(states)
            seed[-1] = weight
            silent = np.zeros(run.shape)
            slopes.append(run.pull_back(silent, inputs=force, states=seed).inputs[:, 0])
        change = np.linalg.lstsq(np.array(slopes), error, rcond=None)[0]
        force = force + _shorter(run, force, change[:, None], np.abs(error / SIZES).max())
    raise RuntimeError(f"after {most} steps the run ends at {states[-1]}")


SIZES = np.array([0.1, 1.0, 1.0, 10.0])  # of the states


def _shorter(run: sh.Rollout, force: Array, change: Array, before: float) -> Array:
    """The change, halved until the end comes nearer."""
    for _ in range(8):
        end = run.states(inputs=force + change)[-1]
        if np.abs((UPRIGHT - end) / SIZES).max() < before:
            break
        change = change / 2
    return change


def make(machine: sh.Machine, transitions: Sequence[str] = ()) -> Plan:
    """The plan of a model; ``transitions`` are the paths of those of its dry frictions, which turn
    softly at first."""
    p = machine.values.copy()
    columns = [machine.column(path) for path in transitions]
    plan = None
    for soft in TRANSITIONS if columns else TRANSITIONS[:1]:
        p[columns] = np.maximum(soft, machine.values[columns])
        plan = shoot(machine, p, plan)
    assert plan is not None
    return polish(machine, plan.push)
