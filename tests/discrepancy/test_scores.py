"""Scores of long recordings: some windows and a part of a run tell as much as all."""

import numpy as np
import pytest
from builders import DRIVEN_MASS, recording
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting import scores
from symhyb.discrepancy.fitting.judge import _runs
from symhyb.discrepancy.fitting.scores import Errors, errors
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import Machine, build

NOISE = 1e-3  # m
OMEGA, DECAY = np.sqrt(25.0 - 0.09), 0.3  # of a mass of 1 kg on 25 N/m and 0.6 N s/m


def swinging(samples: int = 3000) -> tuple[Machine, Recording]:
    """The mass from 1 m, let go."""
    t: NDArray[np.float64] = 0.01 * np.arange(samples)
    x = np.exp(-DECAY * t) * (np.cos(OMEGA * t) + DECAY / OMEGA * np.sin(OMEGA * t))
    x += NOISE * np.random.default_rng(1).normal(size=t.size)
    return build(parse_model(DRIVEN_MASS, "m.toml")), recording(t, {"f": 0 * t}, laser=x)


def scored() -> Errors:
    machine, made = swinging()
    return errors(machine, _runs(machine, [made]), 0.3, None)


def test_some_windows_tell_the_error_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    every = scored()
    monkeypatch.setattr(scores, "WINDOWS_MOST", 40)
    some = scored()
    (left,), (whole,) = some.residuals, every.residuals
    assert left is not None
    assert whole is not None
    assert len(left.left) == 40 < len(whole.left)
    np.testing.assert_allclose(some.window, every.window, rtol=0.1)
    np.testing.assert_array_equal(some.free, every.free)


def test_a_part_of_a_long_run_tells_how_it_began(monkeypatch: pytest.MonkeyPatch) -> None:
    """In 3 s a third of the motion is left."""
    every = scored()
    monkeypatch.setattr(scores, "RUN_MOST", 300)
    part = scored()
    assert part.scenarios[0].q == pytest.approx(every.scenarios[0].q, abs=NOISE / 3)
    assert len(part.trajectories[0].y) == 3000
    np.testing.assert_allclose(part.free, every.free, rtol=0.05)
    assert np.sqrt(part.free[0]) == pytest.approx(NOISE, rel=0.1)
