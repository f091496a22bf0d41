"""Many parameter sets: the same numbers in one process and in several, in their order."""

import numpy as np
import pytest
from builders import damper, oscillator, spring

from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation.sweep import simulate_many


@pytest.fixture(scope="module")
def machine() -> Machine:
    return build(
        oscillator(
            {"spring": spring("k"), "damper": damper("d")},
            {"k": (400.0, "N/m"), "d": (1.5, "N*s/m")},
        )
    )


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    t = np.linspace(0.0, 2.0, 201)
    return Scenario(t, np.array([0.05]), np.zeros(1), t[[0, -1]], np.empty((2, 0)))


def with_stiffness(machine: Machine, *levels: float) -> np.ndarray:
    sets = np.tile(machine.values, (len(levels), 1))
    sets[:, machine.column("k")] = levels
    return sets


def test_each_set_swings_at_its_own_frequency(machine: Machine, scenario: Scenario) -> None:
    """x = x₀ e^(−δt)(cos ωt + δ/ω sin ωt) with δ = d/2m and ω² = k/m − δ²."""
    levels = (100.0, 400.0, 900.0)
    runs = simulate_many(machine, scenario, with_stiffness(machine, *levels))
    decay, t = 1.5 / 2.4, scenario.t
    for level, run in zip(levels, runs, strict=True):
        omega = np.sqrt(level / 1.2 - decay**2)
        swing = np.cos(omega * t) + decay / omega * np.sin(omega * t)
        assert run.q[:, 0] == pytest.approx(0.05 * np.exp(-decay * t) * swing, abs=1e-7)


def test_several_processes_give_the_same_numbers(machine: Machine, scenario: Scenario) -> None:
    sets = with_stiffness(machine, *np.linspace(50.0, 800.0, 11))
    alone = simulate_many(machine, scenario, sets)
    shared = simulate_many(machine, scenario, sets, workers=2)
    assert len(alone) == len(shared) == 11
    for p, one, other in zip(sets, alone, shared, strict=True):
        assert np.array_equal(one.q, simulate(machine, scenario, p).q)
        for name in ("t", "q", "v", "a", "y", "z"):
            assert np.array_equal(getattr(one, name), getattr(other, name))


def test_a_run_that_fails_leaves_the_others_alone(machine: Machine, scenario: Scenario) -> None:
    runs = simulate_many(machine, scenario, with_stiffness(machine, 400.0, -1e7, 400.0))
    assert [run.complete for run in runs] == [True, False, True]
    assert "grew without bound" in runs[1].reason
    assert np.array_equal(runs[0].q, runs[2].q)


def test_no_sets_are_no_runs(machine: Machine, scenario: Scenario) -> None:
    assert simulate_many(machine, scenario, np.empty((0, machine.values.size)), workers=2) == ()


def test_sets_of_another_shape_and_no_workers_are_refused(
    machine: Machine, scenario: Scenario
) -> None:
    with pytest.raises(ValueError, match=r"shape \(4,\); one row a set with 4 values"):
        simulate_many(machine, scenario, machine.values)
    with pytest.raises(ValueError, match="at least one"):
        simulate_many(machine, scenario, machine.values[None], workers=0)
