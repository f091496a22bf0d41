"""Recordings as noisier sensors would have made them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.data.recording import Recording


def noisier(recordings: Sequence[Recording], level: float, seed: int) -> tuple[Recording, ...]:
    """The recordings with white Gaussian noise added to every sensor.

        y(i) + level·sd(y)·e(i),  e ~ N(0, 1)

    The random numbers follow from ``seed``, the file and the name of the sensor, so that one
    recording gets the same ones whichever others stand beside it, and at every level. A level of
    0 changes nothing.
    """
    return tuple(_noisier(one, level, seed) for one in recordings) if level else tuple(recordings)


def _noisier(recording: Recording, level: float, seed: int) -> Recording:
    sensors = {}
    for name, values in recording.sensors.items():
        origin = [seed, int(recording.sha256[:16], 16), *name.encode()]
        size = level * float(np.nanstd(values)) if np.isfinite(values).any() else 0.0
        drawn = np.random.default_rng(origin).standard_normal(values.size)
        sensors[name] = values + size * drawn
        sensors[name].setflags(write=False)
    note = f"noise of {100 * level:g} % of its standard deviation was added to each sensor"
    return replace(recording, sensors=sensors, notes=(*recording.notes, note))
