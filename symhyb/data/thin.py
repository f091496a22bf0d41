"""Fewer samples where a recording has far more than its motion needs, and stretches of one."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording

PERIOD_LEAST = 20  # samples that averaging in blocks leaves in the shortest period of a motion


def coarsest(recording: Recording, most: int, period: float) -> int:
    """How many samples at most a block may average, so that about ``most`` samples are left but no
    motion of a ``period`` in s is averaged away."""
    step = float(np.median(np.diff(recording.t)))
    return max(min(recording.t.size // most, int(period / PERIOD_LEAST / step)), 1)


def thinned(recording: Recording, factor: int) -> Recording:
    """Average blocks of ``factor`` samples (time in s, channels in SI; missing samples skipped).

    The same average acts on inputs and sensors, so a linear model sees no difference; noise falls
    by the square root of the factor. A factor of 1 returns the recording itself.
    """
    if factor <= 1:
        return recording
    count = recording.t.size // factor

    def blocks(values: NDArray[np.float64]) -> NDArray[np.float64]:
        rows = values[: count * factor].reshape(count, factor)
        seen = np.isfinite(rows)
        total = np.where(seen, rows, 0.0).sum(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.where(seen.any(axis=1), total / seen.sum(axis=1), np.nan))

    return replace(
        recording,
        t=blocks(recording.t),
        inputs={name: blocks(values) for name, values in recording.inputs.items()},
        sensors={name: blocks(values) for name, values in recording.sensors.items()},
    )


def stretch(recording: Recording, rows: slice) -> Recording:
    """Some consecutive samples of a recording, with its notes."""
    return replace(
        recording,
        t=recording.t[rows],
        inputs={name: values[rows] for name, values in recording.inputs.items()},
        sensors={name: values[rows] for name, values in recording.sensors.items()},
    )
