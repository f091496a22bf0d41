"""The channels of a model as a file has them, row by row."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

FEWEST = 10  # samples that show a rate
NEAR = 0.5  # of a step, about which a bus may delay samples
MOSTLY = 0.9  # of the steps are within that of their median
SLOWER = 0.8  # of the rows: a channel with more samples than that has dropouts, no slower rate


@dataclass(frozen=True, slots=True)
class Channels:
    """What a file says about a model: ``t`` (N,) in s, inputs and sensors (N,) in SI.

    Nothing is cleaned yet. Among the inputs are the imposed coordinates. ``notes`` are sentences on
    what was left out.
    """

    t: NDArray[np.float64]
    inputs: Mapping[str, NDArray[np.float64]]
    sensors: Mapping[str, NDArray[np.float64]]
    notes: tuple[str, ...]


def take(channels: Channels, keep: NDArray[np.bool_] | slice, note: str = "") -> Channels:
    """Return the rows that are flagged in ``keep`` (N,), or in that slice, with a note if there is
    one."""
    notes = (*channels.notes, note) if note else channels.notes
    if not isinstance(keep, slice) and keep.all():
        return replace(channels, notes=notes)
    return Channels(
        channels.t[keep],
        {name: values[keep] for name, values in channels.inputs.items()},
        {name: values[keep] for name, values in channels.sensors.items()},
        notes,
    )


def own_step(values: NDArray[np.float64], t: NDArray[np.float64]) -> float | None:
    """Return the step in s at which a channel (N,) is sampled, if that is slower than the rows are.

    ``t`` (N,) in s; NaN in ``values`` where there is no sample. A slow channel has samples in few
    of the rows, at about even distances; dropped samples lie otherwise, and give None. Of samples
    that are lost at random, each alike, fewer than half of the steps are within half a step of
    their median (their lengths are geometric).
    """
    times = t[~np.isnan(values)]
    if times.size < FEWEST or times.size > SLOWER * t.size:
        return None
    steps = np.diff(times)
    step = float(np.median(steps))
    if step < 1.2 * float(np.median(np.diff(t))):
        return None
    even = np.count_nonzero(np.abs(steps - step) < NEAR * step) > MOSTLY * steps.size
    return step if even else None
