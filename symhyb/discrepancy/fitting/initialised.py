"""The score of benchmarks: a free run whose first samples only set its initial state.

The initial state is fitted to the first samples, the rest is simulated in one go, and the RMSE is
that of the rest. Sizes: N samples, m sensors, X states.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import starts_only
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run, cut_into_windows, noise_sd, with_noise
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import acting, measured
from symhyb.errors import InputError, Problem
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.between import bent_columns, finer
from symhyb.numeric.runs.windows import Block, WindowModel

SAMPLES = 50  # that set the initial state, as the published scores of the Silverbox have it
LEAST = 20  # of them


@dataclass(frozen=True, slots=True)
class FreeRun:
    """A free run of a whole recording: ``error`` (N, m), measured less simulated, in the units of
    the sensors; the first ``samples`` set the initial state and do not count."""

    sensors: tuple[str, ...]
    error: NDArray[np.float64]
    samples: int

    def rmse(self, end: int | None = None) -> Mapping[str, float]:
        """RMSE by sensor, in its unit, up to the sample ``end`` (default: the last)."""
        counted = self.error[self.samples : end]
        root = np.sqrt(np.nanmean(counted**2, axis=0))
        return dict(zip(self.sensors, map(float, root), strict=True))


def initialised_run(model: Model, recording: Recording, samples: int = SAMPLES) -> FreeRun:
    """Simulate a recording from an initial state that its first ``samples`` determine.

    Raises:
        InputError: fewer than 20 samples to begin with, a recording that has no more than them, or
            a model whose motion is imposed.
    """
    if not LEAST <= samples < recording.t.size:
        text = f"an initial state needs {LEAST} samples at least and some to score, not {samples}"
        raise InputError(Problem(text, file=recording.name))
    machine = build(as_sampled(model, [recording]))
    if machine.imposed:
        raise InputError(Problem("imposed motion has no initial state to set", file=model.file))
    head = recording.crop(end=float(recording.t[samples - 1]))
    first = Run(head, motion_of(head, machine), np.empty(0))
    (run,) = with_noise([first], noise_sd([first], machine), WindowModel(machine))
    cuts = cut_into_windows(run, machine, head.duration)
    if cuts is None:
        raise InputError(Problem("its first samples have gaps", file=recording.name))
    whole = _whole(recording, machine, run.steps)
    cuts = replace(cuts.first(), block=replace(cuts.first().block, record=whole.record))
    cuts = cuts.suited(machine)
    window = WindowModel(machine)
    start = fit(window, starts_only(cuts, run.sd), machine.values).starts[0]
    _, y = window.simulate(whole, start, machine.values)
    sensors = machine.model.sensors
    factors = np.array([sensor.unit.factor for sensor in sensors])
    error = (measured(recording, machine) - y[0]) / factors
    return FreeRun(tuple(sensor.name for sensor in sensors), error, samples)


def _whole(recording: Recording, machine: Machine, steps: int) -> Block:
    """The whole recording as one window."""
    inputs = machine.model.inputs
    u: Array = acting(recording, machine)
    raw = [recording.inputs[item.name] for item in inputs]
    record = recording.t, np.column_stack(raw) if raw else u
    return Block(
        recording.t[None],
        u[None],
        measured(recording, machine)[None],
        np.full((1, recording.t.size - 1), steps),
        finer(*record, *bent_columns(inputs)),
        known=recording.parameters,
    )
