"""The same feedback for every plan: linear-quadratic gains of the model without its correction.

Upright the machine is unstable, and leaves every force that only repeats a plan. One loop holds it
along the plan (the states that the plan promises), one upright after the end. Feedback is held for
a sample. Sizes: K states of a plan, 4 states.
"""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from engine import Machine
from numpy.typing import NDArray
from plan import HANGING, LASTING, STEPS, UPRIGHT, Plan
from scipy.linalg import solve_discrete_are

import symhyb as sh
from symhyb.optimisation.opti import step_function

Array = NDArray[np.float64]

STEP = LASTING / STEPS
MOTOR = 12.0  # N, the most that it can do
STATE, FORCE = np.diag([0.05, 0.1, 0.5, 1.0]) ** 2, 2.0**2  # what counts as much: m, rad, …; N
HELD = 3.0  # s upright
END = 0.5  # m: there the rail ends


@dataclass(frozen=True, slots=True)
class Gains:
    """Force in N per error of the state: along a plan (K − 1, 4), and upright (1, 4)."""

    along: Array
    upright: Array


def gains(machine: sh.Machine, plan: Plan) -> Gains:
    """By the Riccati recursion, backwards from upright."""
    slopes = _slopes(machine)
    weight, price = np.linalg.inv(STATE), np.array([[1 / FORCE]])

    def gain(A: Array, B: Array, P: Array) -> Array:
        return np.asarray(np.linalg.solve(price + B.T @ P @ B, B.T @ P @ A))

    A, B = slopes(UPRIGHT, 0.0)
    P = solve_discrete_are(A, B, weight, price)
    upright, rows = gain(A, B, P), []
    for x, u in zip(plan.states[-2::-1], plan.push[-2::-1], strict=True):
        A, B = slopes(x, u)
        rows.append(gain(A, B, P)[0])
        P = weight + A.T @ P @ (A - B @ rows[-1][None])
    return Gains(np.array(rows[::-1]), upright)


def _slopes(machine: sh.Machine) -> Callable[[Array, float], tuple[Array, Array]]:
    """(state, force) -> slopes of one step by the state (4, 4) and by the force (4, 1)."""
    step, x, u = step_function(machine), ca.SX.sym("x", 4), ca.SX.sym("u")
    after = step(x, u, u, 0.0, STEP, machine.values)
    both = ca.Function("slopes", [x, u], [ca.jacobian(after, x), ca.jacobian(after, u)])

    def at(state: Array, push: float) -> tuple[Array, Array]:
        A, B = both(state, push)
        return A.full(), B.full()

    return at


def follow(machine: Machine, plan: Plan, along: Array | None = None) -> Array:
    """The states (K, 4) of the real machine from hanging: with the force of the plan alone, or with
    gains (K − 1, 4) ``along`` it."""
    states = [np.array(HANGING)]
    for i, ends in enumerate(zip(plan.push[:-1], plan.push[1:], strict=True)):
        more = 0.0 if along is None else float(along[i] @ (plan.states[i] - states[-1]))
        now, then = np.clip(np.array(ends) + more, -MOTOR, MOTOR)
        states.append(machine.advance(states[-1], (float(now), float(then)), STEP))
    return np.array(states)


def hold(machine: Machine, state: Array, upright: Array) -> Array:
    """What comes of the ``state`` in HELD s with the gains (1, 4) of the upright pole, or until the
    cart comes to the end of the rail."""
    states = [state]
    for _ in range(round(HELD / STEP)):
        if abs(states[-1][0]) > END:
            break
        push = float(np.clip((-upright @ off(states[-1]))[0], -MOTOR, MOTOR))
        states.append(machine.advance(states[-1], (push, push), STEP))
    return np.array(states)


def off(state: Array) -> Array:
    """How far a state is from upright and at rest in the middle, the angle within ±π."""
    error = state - UPRIGHT
    error[1] = (error[1] + np.pi) % (2 * np.pi) - np.pi
    return np.asarray(error)
