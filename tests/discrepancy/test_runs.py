"""How fine recordings must be integrated, as the noise and the recording say."""

import numpy as np
import pytest
from builders import model_of, oscillator, recording, spring

from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import (
    COORDINATES_FEW,
    FINE_LEAST,
    Run,
    fine_needed,
    noise_sd,
    stepped_for,
    with_noise,
)
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

T = np.arange(500) / 100


def steps(rate: float) -> int:
    """Steps between samples of a recorded swing of 1 Hz, by a model whose motion grows with this
    rate in 1/s."""
    machine = build(oscillator({"hold": spring("k")}, {"k": (-(rate**2), "N/m")}))
    swing = recording(
        T, place=np.sin(2 * np.pi * T) + 1e-5 * np.random.default_rng(1).normal(size=500)
    )
    first = Run(swing, motion_of(swing, machine), np.empty(0))
    (run,) = with_noise([first], noise_sd([first], machine), WindowModel(machine))
    return run.steps


@pytest.mark.parametrize(("rate", "expected"), [(2.0, 1), (20.0, 1), (100.0, 8)])
def test_a_model_that_runs_away_needs_no_finer_steps_than_until_then(
    rate: float, expected: int
) -> None:
    """At 20/s an error grows by exp(20) in the period of a window, and the motion leaves the
    recording within a tenth of it; what it errs by then says nothing."""
    assert steps(rate) == expected


def chain(masses: int) -> Machine:
    """Masses in a row, each on a spring of its own to the ground, with no friction declared."""
    names = [f"x{i}" for i in range(masses)]
    return build(
        model_of(
            coordinates={name: {"unit": "m"} for name in names},
            parameters={
                "m": {"value": 1.0, "unit": "kg"},
                "k": {"value": 39.5, "unit": "N/m"},
            },
            bodies={name: {"mass": "m", "at": [name, "0"]} for name in names},
            elements={name: spring("k", name) for name in names},
            sensors={name: {"measures": name, "unit": "m"} for name in names},
        )
    )


@pytest.mark.parametrize("masses", [COORDINATES_FEW, COORDINATES_FEW + 1])
def test_how_fine_reversals_are_is_left_open_where_many_coordinates_move(masses: int) -> None:
    """A force that is missing could be friction: of few coordinates that is tried at once."""
    machine = chain(masses)
    t = np.arange(400) / 100
    signals = {
        f"x{i}": np.sin(2 * np.pi * t)
        + 0.2 * np.sin(6 * np.pi * t)
        + 1e-4 * np.random.default_rng(i).normal(size=t.size)
        for i in range(masses)
    }
    swing = recording(t, **signals)
    first = Run(swing, motion_of(swing, machine), np.empty(0))
    (run,) = with_noise([first], noise_sd([first], machine), WindowModel(machine))
    needed = fine_needed(machine, run)
    assert needed > FINE_LEAST
    assert run.fine == (needed if masses == COORDINATES_FEW else FINE_LEAST)
    # with the laws that act known, smooth ones, no finer steps are needed
    assert stepped_for(machine, run, 1.0).fine == 1


def test_laws_that_hold_what_the_model_lets_fall_need_fewer_steps() -> None:
    """A mass that runs away at 100/s asks for eight steps between samples; held by a spring it
    swings as recorded, and one is enough. There are never more than before."""
    falling = build(oscillator({"hold": spring("k")}, {"k": (-1e4, "N/m")}))
    held = build(oscillator({"hold": spring("k")}, {"k": (1.2 * (2 * np.pi) ** 2, "N/m")}))
    swing = recording(
        T, place=np.sin(2 * np.pi * T) + 1e-5 * np.random.default_rng(1).normal(size=500)
    )
    first = Run(swing, motion_of(swing, falling), np.empty(0))
    (run,) = with_noise([first], noise_sd([first], falling), WindowModel(falling))
    assert run.steps == 8
    assert stepped_for(held, run, 1.0).steps == 1
    assert stepped_for(falling, run, 1.0).steps <= 8
