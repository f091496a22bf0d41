"""The rows of a recording: time that increases, inputs without holes, ends that hold something.

Whatever is changed is said in a sentence; what cannot be repaired honestly is refused.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from symhyb.data.channels import Channels, own_step, take
from symhyb.data.files.table import Table
from symhyb.errors import InputError, Problem
from symhyb.limits import LASTING, ROWS, SHORT, VALUE

SHORTEST = 20  # samples: below that no noise level can be measured
LONGEST_HOLE = 3  # samples of an input that a straight line may bridge


Span = tuple[float | None, float | None]


@dataclass(frozen=True, slots=True)
class Block:
    """Consecutive samples ``first`` to ``last``, both included."""

    first: int
    last: int

    @property
    def size(self) -> int:
        """The number of samples."""
        return self.last - self.first + 1

    def span(self, t: NDArray[np.float64]) -> str:
        """Say when, by the times ``t`` (N,) in s: ``t = 1.25 s`` or ``t = 1.2 … 1.4 s``."""
        first, last = t[self.first], t[self.last]
        return f"t = {first:g} s" if first == last else f"t = {first:.6g} … {last:.6g} s"


def blocks(flags: NDArray[np.bool_]) -> list[Block]:
    """Return the runs of True in ``flags`` (N,), dimensionless, in their order."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [Block(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def tidy(
    channels: Channels,
    table: Table,
    span: Span = (None, None),
    held: frozenset[str] = frozenset(),
) -> Channels:
    """Drop rows that say nothing new, check the time, and bridge short holes of the inputs.

    ``span`` = (start, end) in s drops what is outside, None: to that end of the file. ``held`` are
    inputs that keep each value until the next sample.

    Raises:
        InputError: more rows than are read, time that is missing or does not increase, an input
            with a long hole or that stops before the sensors do, or fewer than 20 samples left.
    """
    if channels.t.size > ROWS:
        text = f"has {channels.t.size} rows; at most {ROWS} are read: cut the file into parts"
        raise InputError(Problem(text, file=table.file))
    channels = finite_or_missing(channels)
    if all(np.isnan(values).all() for values in channels.sensors.values()):
        text = f"no sensor ({', '.join(channels.sensors)}) has a finite sample"
        raise InputError(Problem(text, file=table.file))
    rows = np.arange(channels.t.size)
    channels, driven = _between_samples(channels, held)
    channels, rows = take(channels, driven), rows[driven]
    for drop in (partial(outside, span=span), empty_rows, repeated_rows, _unmeasured_ends):
        keep, note = drop(channels)
        rows = rows[keep]
        channels = take(channels, keep, note)
    check_time(channels.t, rows, table)
    if channels.t.size < SHORTEST:
        text = f"usable samples: {channels.t.size}; at least {SHORTEST} are needed"
        text += f" ({note})" if (note := outside(channels, span)[1]) else ""
        raise InputError(Problem(text, file=table.file))
    return without_silent_sensors(_fill_inputs(channels, table, held))


def without_silent_sensors(channels: Channels) -> Channels:
    """Leave out the sensors that have a column but not one sample in it."""
    silent = [name for name, values in channels.sensors.items() if np.isnan(values).all()]
    sensors = {name: values for name, values in channels.sensors.items() if name not in silent}
    notes = (f"sensor {name} has no finite sample: left out" for name in silent)
    return replace(channels, sensors=sensors, notes=(*channels.notes, *notes))


def finite_or_missing(channels: Channels) -> Channels:
    """Write NaN for infinity and for what is as good as that: neither is a measurement."""

    def clean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(np.abs(values) <= VALUE, values, np.nan)

    inputs = {name: clean(values) for name, values in channels.inputs.items()}
    sensors = {name: clean(values) for name, values in channels.sensors.items()}
    t = np.where(np.isfinite(channels.t), channels.t, np.nan)  # how long it lasts is judged later
    return replace(channels, t=t, inputs=inputs, sensors=sensors)


def _between(
    at: NDArray[np.float64], t: NDArray[np.float64], values: NDArray[np.float64], held: bool
) -> NDArray[np.float64]:
    """An input (K,) sampled at ``t`` (K,), s, at other times (N,): along lines, or held; NaN before
    its first and after its last sample."""
    line = np.interp(at, t, values, left=np.nan, right=np.nan)
    if not held:
        return line
    last = np.clip(np.searchsorted(t, at, side="right") - 1, 0, t.size - 1)
    return np.where(np.isnan(line), np.nan, values[last])


def _between_samples(
    channels: Channels, held: frozenset[str]
) -> tuple[Channels, NDArray[np.bool_]]:
    """Draw straight lines between the samples of inputs that are slower than the rows, or hold them
    where they are ``held``.

    Flags the rows to keep: beyond the first and last sample of such an input, by less than its own
    step, its values are not known.
    """
    t = channels.t
    keep = np.ones(t.size, dtype=bool)
    if np.isnan(t).any() or np.any(np.diff(t) <= 0):
        return channels, keep  # complained about later
    inputs, notes = dict(channels.inputs), list(channels.notes)
    for name, values in channels.inputs.items():
        step = own_step(values, t)
        if step is None:
            continue
        known = ~np.isnan(values)
        first, *_, last = t[known]
        line = _between(t, t[known], values[known], name in held)
        for gap in np.flatnonzero(np.diff(t[known]) > (LONGEST_HOLE + 1.5) * step):
            line[(t > t[known][gap]) & (t < t[known][gap + 1])] = np.nan
        inputs[name] = line
        keep &= (t >= first) | (t <= first - step)
        keep &= (t <= last) | (t >= last + step)
        rates = f"{1 / step:.4g} Hz beside rows at {1 / np.median(np.diff(t)):.4g} Hz"
        how = "held" if name in held else "straight lines"
        notes.append(f"input {name}: {rates}; {how} in between")
    return replace(channels, inputs=inputs, notes=tuple(notes)), keep


def _all_signals(channels: Channels) -> NDArray[np.float64]:
    return np.vstack([channels.t, *channels.inputs.values(), *channels.sensors.values()])


def outside(channels: Channels, span: Span) -> tuple[NDArray[np.bool_], str]:
    """Flag (N,), dimensionless, the rows within ``span``, in s; one without a time is kept, to be
    complained about."""
    start, end = span
    if start is None and end is None:
        return np.ones(channels.t.size, dtype=bool), ""
    first, last = -np.inf if start is None else start, np.inf if end is None else end
    beyond = (channels.t < first) | (channels.t > last)
    return ~beyond, f"only t = {first:g} … {last:g} s was read"


def empty_rows(channels: Channels) -> tuple[NDArray[np.bool_], str]:
    """Flag (N,), dimensionless, the rows that hold a number, and say how many do not."""
    if not np.isnan(channels.t).any():
        return np.ones(channels.t.size, dtype=bool), ""
    signals = _all_signals(channels)
    empty = np.count_nonzero(np.isnan(signals), axis=0) == len(signals)
    return ~empty, _dropped(int(empty.sum()), "without any number")


def repeated_rows(channels: Channels) -> tuple[NDArray[np.bool_], str]:
    """Flag (N,), dimensionless, the rows that do not repeat the row before them, the time included,
    and say how many do."""
    if np.all(np.diff(channels.t) > 0):
        return np.ones(channels.t.size, dtype=bool), ""
    signals = _all_signals(channels)
    before, after = signals[:, :-1], signals[:, 1:]
    same = ((before == after) | (np.isnan(before) & np.isnan(after))).all(axis=0)
    repeated = np.concatenate([[False], same])[: channels.t.size]
    return ~repeated, _dropped(int(repeated.sum()), "that repeat the row before them")


def _unmeasured_ends(channels: Channels) -> tuple[NDArray[np.bool_], str]:
    """Flag the rows before the first and after the last sample of any sensor."""
    measured = np.flatnonzero(~np.isnan([*channels.sensors.values()]).all(axis=0))
    keep = np.zeros(channels.t.size, dtype=bool)
    if measured.size:
        keep[measured[0] : measured[-1] + 1] = True
    count = int((~keep).sum())
    return keep, _dropped(count, "before the first or after the last sample of a sensor")


def _dropped(count: int, which: str) -> str:
    return f"{count} row{'s' * (count > 1)} {which}: dropped" if count else ""


def check_time(t: NDArray[np.float64], rows: NDArray[np.intp], table: Table) -> None:
    """Check that ``t`` (N,) in s is there, increases and is not longer than a machine lasts;
    ``rows`` (N,) are the rows of the file.

    Raises:
        InputError: it does not.
    """
    missing = np.flatnonzero(np.isnan(t))
    if missing.size:
        text = f"time is missing at {table.row(rows[missing[0]])}" + _more(missing.size)
        raise InputError(Problem(text, "t", table.file))
    first, last = (float(t.min()), float(t.max())) if t.size else (0.0, 0.0)
    if last / 2 - first / 2 > LASTING / 2:
        text = (
            f"time runs from {first:.9g} to {last:.9g} s, longer than any machine; check its unit"
        )
        raise InputError(Problem(text, "t", table.file))
    if t.size > 1 and 0 < last - first < SHORT:
        text = f"time runs over {last - first:.3g} s alone, faster than any machine; check its unit"
        raise InputError(Problem(text, "t", table.file))
    wrong = np.flatnonzero(np.diff(t) <= 0) + 1
    if wrong.size:
        now, before = t[wrong[0]], t[wrong[0] - 1]
        text = f"time does not increase at {table.row(rows[wrong[0]])}: {now:.9g} s after"
        cure = "; sort the rows, or cut the file there"
        runs = np.diff([0, *wrong, t.size])
        if runs.min() >= SHORTEST and now - t[0] < 0.1 * (before - t[0]):
            cure = f"; if these are {runs.size} runs, read one of them, as in '{table.file}#2'"
        raise InputError(
            Problem(f"{text} {before:.9g} s{_more(wrong.size)}{cure}", "t", table.file)
        )


def _more(count: int) -> str:
    return f" (and {count - 1} more)" if count > 1 else ""


def _fill_inputs(channels: Channels, table: Table, held: frozenset[str]) -> Channels:
    inputs: dict[str, NDArray[np.float64]] = {}
    notes: list[str] = []
    problems: list[Problem] = []
    for name, values in channels.inputs.items():
        missing = np.isnan(values)
        holes = blocks(missing)
        complaints = list(_complaints(name, holes, channels.t))
        problems.extend(Problem(text, f"input {name}", table.file) for text in complaints)
        if holes and not complaints:
            notes.append(
                f"input {name}: {missing.sum()} missing sample{'s' * (int(missing.sum()) > 1)}"
                f" {'held over' if name in held else 'interpolated'},"
                f" first at {holes[0].span(channels.t)}"
            )
            values = _between(channels.t, channels.t[~missing], values[~missing], name in held)
        inputs[name] = values
    if problems:
        raise InputError(problems)
    return replace(channels, inputs=inputs, notes=(*channels.notes, *notes))


def _complaints(name: str, holes: list[Block], t: NDArray[np.float64]) -> Iterator[str]:
    """Say why an input cannot be repaired, if so: the simulation needs it from end to end."""
    for hole in holes:
        if hole.size == t.size:
            yield "has no finite sample"
        elif hole.last == t.size - 1:
            end = t[hole.first - 1]
            yield (
                f"stops at t = {end:.6g} s, before the sensors do at t = {t[-1]:.6g} s;"
                f" crop the recording to end at {end:.6g} s"
            )
        elif hole.first == 0:
            start = t[hole.last + 1]
            yield (
                f"begins only at t = {start:.6g} s, after the sensors do at t = {t[0]:.6g} s;"
                f" crop the recording to start at {start:.6g} s"
            )
        elif hole.size > LONGEST_HOLE:
            yield (
                f"is missing for {hole.size} samples, {hole.span(t)}; crop the recording to the"
                " part before or after it"
            )
