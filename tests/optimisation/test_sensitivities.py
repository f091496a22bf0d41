"""Slopes of a run by its start and parameters, against closed forms and finite differences."""

import numpy as np
import pytest
from builders import oscillator

from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation.sensitivities import sensitivities

T = np.linspace(0, 3, 61)


def scenario(x: float, v: float, k: int = 0) -> Scenario:
    rise = np.linspace(0.0, 2.0, 31)[:, None] * np.ones(k)
    return Scenario(T, np.array([x]), np.array([v]), np.linspace(0, 3, 31), rise)


def test_slopes_by_the_start_of_a_spring_are_its_swing() -> None:
    """x = x0 cos wt + v0/w sin wt."""
    machine = build(
        oscillator({"bar": {"kind": "spring", "on": "x", "stiffness": "k"}}, {"k": (50.0, "N/m")})
    )
    u = len(machine.model.inputs)
    found = sensitivities(machine, scenario(0.1, 0.0, u), ())
    mass = float(np.asarray(machine.M([0.1], 0.0, machine.values)).item())
    w = np.sqrt(50.0 / mass)
    assert found.by_start[:, 0, 0] == pytest.approx(np.cos(w * T), abs=1e-6)
    assert found.by_start[:, 0, 1] == pytest.approx(np.sin(w * T) / w, abs=1e-6)
    assert found.by_free.shape == (T.size, 2, 0)


def test_slopes_by_parameters_agree_with_differences() -> None:
    """A hardening spring with drag: nonlinear in state and parameters."""
    model = oscillator(
        {
            "bar": {"kind": "spring", "on": "x", "stiffness": "k", "cubic": "c"},
            "air": {"kind": "drag", "on": "x", "drag": "b"},
        },
        {"k": (50.0, "N/m"), "c": (900.0, "N/m^3"), "b": (0.7, "N*s^2/m^2")},
    )
    machine = build(model)
    case = scenario(0.2, -0.3, len(machine.model.inputs))
    free = [machine.column(name) for name in ("k", "c", "b")]
    found = sensitivities(machine, case, free)
    assert found.run.complete
    for i, column in enumerate(free):
        runs = []
        for sign in (1, -1):
            p = machine.values.copy()
            p[column] *= 1 + sign * 1e-3
            runs.append(simulate(machine, case, p))
        change = (runs[0].q - runs[1].q)[:, 0] / (2e-3 * machine.values[column])
        size = np.abs(change).max()
        assert found.by_free[:, 0, i] == pytest.approx(change, abs=1e-3 * size)
