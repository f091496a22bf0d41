"""Samples that a channel got wrong: spikes, dropouts and a saturated sensor, found from the signal.

Only what no motion can do is found here: one sample that leaves its neighbours and comes back, one
value that comes again and again far from its neighbours, a level that is run into at full speed.
Sizes: N samples; the unit of a signal does not matter.
"""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from symhyb.data.rows import blocks
from symhyb.judgement import CLIPPED, CREST, ENTRY, FEWEST, NOTABLE, SPIKE, SPIKE_PATTERN

Signal = NDArray[np.float64]
Flags = NDArray[np.bool_]

SPIKE_SHAPE = np.array([1 / 6, -2 / 3, 1.0, -2 / 3, 1 / 6])  # of e around one wrong sample
SPIKE_GAPS = (2, 3, 4)  # samples between two spikes that spoil each other's shape; 1 may be a jump
PAIR_ROOM = 5  # samples before and after, in which ringing would go on
DROPOUT_LEAST = 2  # times the same value


def spikes(values: Signal) -> Flags:
    """Flag (N,) single samples that stand alone; ``values`` (N,), NaN where missing.

    e_i = y_i − (−y_{i−2} + 4 y_{i−1} + 4 y_{i+1} − y_{i+2})/6, the deviation from the cubic through
    the neighbours. A spike s shows as e = s/6, −2s/3, s, −2s/3, s/6; a kink or a step of the motion
    leaves another pattern, however large it is. Two spikes with a good sample between them are
    found by the sum of their patterns.
    """
    flags = np.zeros(values.size, bool)
    if values.size < 25:
        return flags
    y = values
    e = np.full(y.size, np.nan)
    e[2:-2] = y[2:-2] - (-y[:-4] + 4 * y[1:-3] + 4 * y[3:-1] - y[4:]) / 6
    known = np.abs(e[np.isfinite(e)])
    if known.size < 20:
        return flags
    usual = max(float(np.quantile(known, 0.9)), 1e-9 * float(np.nanmax(y) - np.nanmin(y)))
    with np.errstate(invalid="ignore", divide="ignore"):
        before, after = e[1:-3] / e[2:-2], e[3:-1] / e[2:-2]
        alone = (np.abs(before + 2 / 3) < SPIKE_PATTERN) & (np.abs(after + 2 / 3) < SPIKE_PATTERN)
        flags[2:-2] = (np.abs(e[2:-2]) > SPIKE * usual) & alone
    flags |= pairs(e, SPIKE * usual)
    return flags if flags.sum() <= NOTABLE * values.size else np.zeros_like(flags)


def pairs(e: Signal, least: float) -> Flags:
    """Flag (N,) two spikes so close that their patterns overlap in the deviations ``e`` (N,) from
    the neighbours: what is left of ``e`` beside the two is small against either. Both are at least
    ``least``, in the unit of the signal."""
    flags = np.zeros(e.size, bool)
    large = np.abs(e) > least
    for gap in SPIKE_GAPS:
        first = np.flatnonzero(large[:-gap] & large[gap:])
        first = first[(first >= PAIR_ROOM) & (first + gap + PAIR_ROOM < e.size)]
        shapes = np.zeros((2 * PAIR_ROOM + 1 + gap, 2))
        for column, at in enumerate((PAIR_ROOM, PAIR_ROOM + gap)):
            shapes[at - 2 : at + 3, column] = SPIKE_SHAPE
        around = e[first[:, None] + np.arange(-PAIR_ROOM, gap + PAIR_ROOM + 1)]
        heights = around @ np.linalg.pinv(shapes).T
        rest = np.abs(around - heights @ shapes.T).max(axis=1)
        smaller = np.abs(heights).min(axis=1)
        good = first[(smaller > least) & (rest < SPIKE_PATTERN * smaller)]
        flags[good] = flags[good + gap] = True
    return flags


def dropouts(values: Signal) -> Flags:
    """Flag (N,) samples where a channel (N,), in any unit, fell to one and the same value, far from
    its neighbours.

    The value is the one that most of the samples share with another sample; at least two of its
    runs must leave and return by more than any step of the rest.
    """
    flags = np.zeros(values.size, bool)
    known = np.isfinite(values)
    levels, counts = np.unique(values[known], return_counts=True)
    if levels.size < 10 or counts.max() < DROPOUT_LEAST:
        return flags
    level = 0.0 if 0.0 in levels[counts >= DROPOUT_LEAST] else float(levels[np.argmax(counts)])
    at = values == level
    rest = np.flatnonzero(known & ~at)
    if at.sum() > 0.3 * values.size or rest.size < 20:
        return flags
    steps = np.abs(np.diff(values[rest])) / np.diff(rest)
    usual = float(np.quantile(steps, 0.98))
    line = np.interp(np.arange(values.size), rest, values[rest])
    fallen = [
        run
        for run in blocks(at)
        if np.abs(values[run.first : run.last + 1] - line[run.first : run.last + 1]).min()
        > 3 * usual * (1 + run.size / 2)
    ]
    if len(fallen) >= DROPOUT_LEAST:
        for run in fallen:
            flags[run.first : run.last + 1] = True
    return flags


def at_limit(values: Signal, upper: bool) -> Flags:
    """Flag (N,) the runs of at least three samples at the very extreme of a signal (N,), in any
    unit, where so many are there that it is no crest."""
    flags = np.zeros(values.size, bool)
    levels = np.unique(values[np.isfinite(values)])
    if levels.size < 2:
        return flags
    extreme, beside = (levels[-1], levels[-2]) if upper else (levels[0], levels[1])
    for run in blocks(values == extreme):
        if run.size >= FEWEST:
            flags[run.first : run.last + 1] = True
    # The crest of a coarse signal is populated too, but so is the level beside it.
    few = flags.sum() < max(CLIPPED * values.size, CREST * np.count_nonzero(values == beside))
    return np.zeros_like(flags) if few else flags


def saturated(values: Signal) -> Flags:
    """Flag (N,) the samples at a limit that the signal (N,), in any unit, runs into without slowing
    down: there the sensor ends, not the motion."""
    flags = np.zeros(values.size, bool)
    steps = np.diff(values)
    usual = float(np.sqrt(np.nanmean(steps**2))) if np.isfinite(steps).any() else 0.0
    for upper in (True, False):
        limit = at_limit(values, upper)
        entries = [
            abs(values[run.first - 1] - values[run.first - 4]) / 3
            for run in blocks(limit)
            if run.first >= 4
        ]
        entries = [step for step in entries if np.isfinite(step)]
        if entries and float(np.median(entries)) > ENTRY * usual:
            flags |= limit
    return flags


FAULTS: tuple[tuple[str, Callable[[Signal], Flags]], ...] = (
    ("is saturated", saturated),
    ("drops out", dropouts),
    ("has spikes", spikes),
)


def faulty(values: Signal) -> Iterator[tuple[str, Flags]]:
    """What is wrong with samples of a signal (N,), in any unit, each with its flags (N,); what one
    fault took is missing for the next."""
    left = values.copy()
    for words, find in FAULTS:
        flags = find(left)
        if flags.any():
            yield words, flags
            left[flags] = np.nan
