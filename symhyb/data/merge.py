"""Channels that were sampled at different times become rows of one table; one run out of several.

    laser  t = 0  1  2  3  4  5  6 ms         t      0  1  2  3  4  5  6
    accel  t = 0        3        6 ms    ->   laser  x  x  x  x  x  x  x
                                              accel  x  .  .  x  .  .  x

The rows are the union of all times. Where a channel has no sample it is NaN; what becomes of that
is decided in :mod:`symhyb.data.rows`.
"""

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from symhyb.data.channels import Channels, take
from symhyb.data.files.table import PART, Table, refusal
from symhyb.data.rows import check_time, empty_rows, finite_or_missing, repeated_rows

SAME = 1e-3  # of the shortest step: times that differ by less are one


def merged(groups: Sequence[Channels], table: Table) -> Channels:
    """Return the channels of all ``groups`` on the union of their times, each NaN elsewhere.

    Raises:
        InputError: the time of a group is missing or does not increase; it has no sample, unless
            the table is a piece of several.
    """
    if len(groups) == 1:
        return groups[0]
    if not groups:
        raise refusal(table.file, "no channel of the model is a column")
    groups = [_orderly(group, table) for group in groups]
    times = [group.t for group in groups if group.t.size]
    union = reduce(_union, times) if times else np.empty(0)
    inputs: dict[str, NDArray[np.float64]] = {}
    sensors: dict[str, NDArray[np.float64]] = {}
    for group in groups:
        rows = _nearest(group.t, union)
        for target, channels in ((inputs, group.inputs), (sensors, group.sensors)):
            for name, values in channels.items():
                target[name] = np.full(union.size, np.nan)
                target[name][rows] = values
    notes = [note for group in groups for note in group.notes]
    if any(group.t.size < union.size for group in groups):
        names = ["+".join([*group.inputs, *group.sensors]) for group in groups]
        notes.append(f"channels with times of their own are merged: {', '.join(names)}")
    return Channels(union, inputs, sensors, tuple(notes))


def one_run(channels: Channels, table: Table) -> Channels:
    """Return the run that ``table`` asks for; a new one begins where time goes back.

    Raises:
        InputError: there are fewer runs.
    """
    if not table.run:
        return channels
    filled = np.flatnonzero(np.isfinite(channels.t))
    back = filled[1:][np.diff(channels.t[filled]) < 0]
    edges = [0, *back, channels.t.size]
    if table.run >= len(edges):
        count = len(edges) - 1
        text = f"has no part '{table.run}', and no run of that number: "
        if count > 1:
            text += f"it holds {count} runs"
        else:
            text += f"time never starts anew; leave '{PART}{table.run}' out"
        raise refusal(table.file, text)
    keep = np.zeros(channels.t.size, dtype=bool)
    keep[edges[table.run - 1] : edges[table.run]] = True
    return take(channels, keep, f"run {table.run} of {len(edges) - 1} in the file")


def _orderly(group: Channels, table: Table) -> Channels:
    """Drop the rows that only pad a group, and check its time."""
    group = finite_or_missing(group)
    rows = np.arange(group.t.size)
    for drop in (empty_rows, repeated_rows):
        keep, _ = drop(group)
        rows, group = rows[keep], take(group, keep)
    if not group.t.size and not table.partial:
        raise refusal(table.file, f"{', '.join([*group.inputs, *group.sensors])}: no sample")
    check_time(group.t, rows, table)
    return group


def _union(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the times of both, those of ``second`` left out that are in ``first``."""
    rows = _nearest(second, first)
    new = np.abs(first[rows] - second) > SAME * min(_step(first), _step(second))
    return np.sort(np.concatenate([first, second[new]]))


def _nearest(times: NDArray[np.float64], union: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the row of ``union`` that is nearest to each of ``times``."""
    after = np.clip(np.searchsorted(union, times), 1, max(union.size - 1, 1))
    after = np.minimum(after, union.size - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.abs(union[before] - times) <= np.abs(union[after] - times)
    return np.where(nearer, before, after)


def _step(t: NDArray[np.float64]) -> float:
    return float(np.diff(t).min()) if t.size > 1 else np.inf
