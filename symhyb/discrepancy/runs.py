"""A recording made ready for windows: its motion, the noise of its sensors, fine enough steps."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.motion import Motion
from symhyb.discrepancy.windows import Laid, lay, reversals
from symhyb.numeric.buffers import Array
from symhyb.numeric.machine import Machine
from symhyb.numeric.windows import WindowModel

FINE_STEPS = 8  # near a reversal, for one elsewhere
STEPS_MOST = 16
SIGNAL_LEAST = 3.0  # spread of a channel over its noise, for a recording that shows something
SAMPLES_TELL = 100  # that recordings have together
PERIODS_LEAST = 2.0  # of the slowest motion, that recordings last together
STEP_SHARE = 0.1  # of the noise: the error of integration that is allowed
SD_FLOOR = 1e-6  # of a sensor's range: the accuracy of the integration
RANGE_SHARE = 2e-5  # of a sensor's range: an error of integration that is always allowed


@dataclass(frozen=True, slots=True)
class Run:
    """One recording with its smoothed motion, the noise ``sd`` (m,) of its sensors, SI, and the
    integration ``steps`` between two samples."""

    recording: Recording
    motion: Motion
    sd: Array
    steps: int = 1


def laid_on(run: Run, machine: Machine, length_s: float) -> Laid | None:
    """Windows of one run, ``length_s`` in s, with finer steps near reversals of a coordinate."""
    parts = run.steps * np.where(reversals(run.motion.v), FINE_STEPS, 1)
    return lay(run.recording, machine, run.motion, length_s, parts)


def noise_sd(runs: Sequence[Run], machine: Machine) -> Array:
    """Noise (m,) by sensor over all runs, SI; 1 for a sensor without samples."""
    sd = np.ones(len(machine.model.sensors))
    for j, sensor in enumerate(machine.model.sensors):
        seen = [run for run in runs if np.isfinite(run.motion.sd[j])]
        if not seen:
            continue
        signals = [run.recording.sensors[sensor.name] for run in seen]
        reach = max(float(np.nanmax(signal) - np.nanmin(signal)) for signal in signals)
        spread = float(np.sqrt(np.mean([run.motion.sd[j] ** 2 for run in seen])))
        sd[j] = max(spread, SD_FLOOR * reach) or 1.0  # a channel that stands still weighs 1
    return sd


def too_poor(runs: Sequence[Run], sensors: Sequence[str]) -> str:
    """Why these runs cannot show that nothing is missing, as half a sentence; empty if they can.

    ``sensors`` are the names of the model's sensors, in their order.
    """
    signals = []
    for run in runs:
        for sensor, noise in zip(sensors, run.motion.sd, strict=True):
            values = run.recording.sensors.get(sensor)
            if values is not None and np.isfinite(noise):
                signals.append(float(np.nanstd(values)) > SIGNAL_LEAST * noise)
    if not any(signals):
        return "no channel moves by more than a few times its noise"
    samples = sum(run.recording.t.size for run in runs)
    if samples < SAMPLES_TELL:
        return f"they have {samples} samples, less than {SAMPLES_TELL}"
    longest = max(float(run.motion.periods().max()) for run in runs)
    total = sum(run.recording.duration for run in runs)
    if total < PERIODS_LEAST * longest:
        return f"they last {total:.3g} s, less than {PERIODS_LEAST:g} periods of the motion"
    return ""


def with_noise(runs: Sequence[Run], sd: Array, model: WindowModel) -> tuple[Run, ...]:
    """The runs with this noise (m,), SI, and as many integration steps as it asks for."""
    told = [replace(run, sd=sd) for run in runs]
    return tuple(replace(run, steps=_steps_needed(model, run)) for run in told)


def _steps_needed(model: WindowModel, run: Run) -> int:
    """Steps between samples at which twice as many change the outputs by less than a tenth of the
    noise, over windows of one period along the measured motion."""
    length = float(run.motion.periods().min())
    values = model.machine.values
    y = [run.recording.sensors.get(s.name) for s in model.machine.model.sensors]
    reach = np.array([0.0 if c is None else np.nanmax(c) - np.nanmin(c) for c in y])
    allowed = np.maximum(STEP_SHARE * run.sd, RANGE_SHARE * reach)
    parts = np.ones(run.recording.t.size - 1, np.int64)
    coarse: Array | None = None
    steps = 1
    while steps <= 2 * STEPS_MOST:
        laid = lay(run.recording, model.machine, run.motion, length, steps * parts)
        if laid is None:
            return 1
        with np.errstate(over="ignore", invalid="ignore"):
            _, fine = model.simulate(laid.block, laid.start, values)
            if coarse is not None:
                change = (fine - coarse).reshape(-1, allowed.size)
                error = np.sqrt(np.mean(change[np.isfinite(change).all(axis=1)] ** 2, axis=0))
                if not np.any(error > allowed):
                    return steps // 2
        coarse, steps = fine, 2 * steps
    return STEPS_MOST
