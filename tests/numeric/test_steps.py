"""The integration step of windows: its order, its stiffness, and what a step is made of."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest
from builders import (
    Entries,
    cart_pole,
    damper,
    model_of,
    oscillator,
    pendulum,
    push,
    run,
    spring,
    value,
)
from numpy.typing import ArrayLike, NDArray

from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.steps import factored, rosenbrock_step, solved, step_and_middle

Array = NDArray[np.float64]
INPUT: Mapping[str, Entries] = {"f": {"unit": "N"}}


def march(machine: Machine, x: ArrayLike, duration: float, steps: int, slope: float = 0.0) -> Array:
    """The state after equal steps; every input rises from 0 with this slope."""
    step = rosenbrock_step(state_form(machine))
    h = duration / steps
    inputs = np.ones(len(machine.model.inputs)) * slope
    state = np.asarray(x, float)
    for i in range(steps):
        u0, u1 = i * h * inputs, (i + 1) * h * inputs
        state = value(step, state, u0, u1, i * h, h, machine.values)
    return state


def order(machine: Machine, x: ArrayLike, duration: float, steps: int, slope: float = 0.0) -> float:
    """Observed order: error against a run with eight times as many steps, from two step sizes."""
    reference = march(machine, x, duration, 8 * steps, slope)
    errors = [
        np.linalg.norm(march(machine, x, duration, count, slope) - reference)
        for count in (steps, 2 * steps)
    ]
    assert errors[1] > 1e-12
    return float(np.log2(errors[0] / errors[1]))


def driven() -> Machine:
    """Cubic spring, drag, a force that depends on time, and an input: nothing of it is linear."""
    return build(
        oscillator(
            {
                "hold": spring("k", cubic="c"),
                "oil": damper("d"),
                "wind": push("F*sin(w*t)*cos(x/l) + f*x'/s"),
            },
            {
                "k": (40.0, "N/m"),
                "c": (500.0, "N/m^3"),
                "d": (0.8, "N*s/m"),
                "F": (3.0, "N"),
                "w": (5.0, "1/s"),
                "l": (0.3, "m"),
                "s": (1.0, "m/s"),
            },
            inputs=INPUT,
        )
    )


def test_order_on_smooth_machines() -> None:
    assert order(build(pendulum()), [1.2, 0.5], 1.0, 40) > 3.7
    assert order(driven(), [0.2, -0.5], 0.8, 40, slope=2.0) > 3.7


def test_order_with_two_coordinates() -> None:
    smooth = model_of(
        gravity=["0", "-g"],
        coordinates={"x": {"unit": "m"}, "phi": {"unit": "rad"}},
        parameters={
            "g": (9.81, "m/s^2"),
            "m": (0.6, "kg"),
            "a": (0.3, "m"),
            "k": (25.0, "N/m"),
            "d": (0.02, "N*m*s/rad"),
            "A": (0.02, "m"),
            "w": (4.0, "1/s"),
        },
        points={
            "pivot": ["x + A*sin(w*t)", "0"],
            "tip": ["x + A*sin(w*t) + a*sin(phi)", "-a*cos(phi)"],
        },
        bodies={"cart": {"mass": "m", "at": "pivot"}, "ball": {"mass": "m", "at": "tip"}},
        elements={"hold": spring("k"), "bearing": damper("d", on="phi")},
    )
    assert order(build(smooth), [0.1, 1.0, -0.2, 2.0], 0.8, 40) > 3.7


def test_a_fine_march_agrees_with_cvodes() -> None:
    machine = driven()
    end = march(machine, [0.2, -0.5], 0.8, 400, slope=2.0)
    result = run(machine, t := np.array([0.0, 0.4, 0.8]), 0.2, -0.5, 2 * t)
    assert end == pytest.approx([result.q[-1, 0], result.v[-1, 0]], abs=1e-6)


def test_a_step_of_no_length_changes_nothing() -> None:
    machine = build(cart_pole())
    x = np.array([0.1, 0.4, -0.3, 1.1])
    step = rosenbrock_step(state_form(machine))
    assert value(step, x, 2.0, 5.0, 0.0, 0.0, machine.values) == pytest.approx(x)


def test_stiff_friction_is_stood_at_steps_far_above_its_time_constant() -> None:
    """L-stability: transition 1e-4 m/s and 2 N on 1.2 kg relax in 60 µs; the step is 10 ms."""
    model = oscillator(
        {"rail": {"kind": "friction", "on": "x", "coulomb": "c", "transition": "w"}},
        {"c": (2.0, "N"), "w": (1e-4, "m/s")},
    )
    end = march(build(model), [0.0, 0.0005], 0.2, 20)
    assert abs(end[1]) < 1e-7
    assert abs(end[0]) < 2 * 2.0 / 1.2 * 0.01**2  # one step beyond the stop, no more


def test_an_undamped_stiff_spring_is_damped_and_not_blown_up() -> None:
    machine = build(oscillator({"hold": spring("k")}, {"k": (1e12, "N/m")}))
    end = march(machine, [1e-3, 0.0], 1.0, 50)
    assert np.all(np.isfinite(end))
    assert abs(end[0]) < 1e-6


def test_equations_are_solved_by_their_nonzeros_alone() -> None:
    """An arrow: a speed that all inner states act on, which do not act on each other."""
    size = 5
    below = ca.Sparsity.triplet(size, size, [1, 2, 3], [0, 0, 0])
    pattern = ca.Sparsity.diag(size) + below + below.T
    matrix, right = ca.SX.sym("A", pattern), ca.SX.sym("b", size)
    rows = factored(matrix)
    assert [sorted(row) for row in rows[:2]] == [[0, 1, 2, 3], [0, 1, 2, 3]]  # filled in
    assert sorted(rows[4]) == [4]  # meets nobody
    solve = ca.Function("solve", [matrix, right], [solved(rows, right)])
    random = np.random.default_rng(1)
    given = np.where(ca.DM(pattern, 1).full() > 0, random.normal(size=(size, size)), 0.0)
    given, aim = given + 4 * np.eye(size), random.normal(size=size)
    found = np.array(solve(ca.DM(given)[pattern], aim)).ravel()
    assert found == pytest.approx(np.linalg.solve(given, aim), rel=1e-12)


def test_a_zero_that_is_written_is_no_nonzero() -> None:
    matrix = ca.SX.eye(2)
    matrix[1, 0] = 0 * ca.SX.sym("a")
    assert [sorted(row) for row in factored(matrix)] == [[0], [1]]


def test_the_state_in_the_middle_of_a_step_is_accurate_to_third_order() -> None:
    machine = driven()
    form, start = state_form(machine), np.array([0.3, -0.2])
    both, errors = step_and_middle(form), []
    for h in (0.02, 0.01):
        inputs = (np.zeros(1), np.full(1, 0.7 * h), 0.0, h, machine.values)
        (after,), (middle,) = call(both, (start, *inputs))
        assert after == pytest.approx(march(machine, start, h, 1, 0.7), abs=1e-14)
        errors.append(np.linalg.norm(middle - march(machine, start, h / 2, 8, 0.7)))
    assert errors[1] > 1e-12
    assert np.log2(errors[0] / errors[1]) > 3.5  # of one step
