"""How fine recordings must be integrated, as the noise and the recording say."""

import numpy as np
import pytest
from builders import oscillator, recording, spring

from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run, noise_sd, with_noise
from symhyb.numeric.lowered.machine import build
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
