"""A recorded signal as an actuator passes it on, with its slopes by the numbers of the actuator.

    y = quantum·round(u/quantum)                   steps (:mod:`.quantised`)
    y = u − min(max(u, −dead_band), dead_band)     nothing acts below, and it is missing above
    y = min(max(y, u − backlash/2), u + backlash/2), from y before (:mod:`.backlash`)
    y = min(max(u, −limit), limit)
    lag·y' = u − y, but |y'| ≤ rate_limit          without a lag y = u, but for its rate

one after the other, each from what comes out of the one before. A lag whose rate is limited is one
step (Klyde, McRuer & Myers, J. Guidance, Control, and Dynamics 20, 1997). All begin as if the first
value had acted for long. A number of 0 does nothing. Between its times a signal is a line, or held:
times are added where a line gets a kink. Sizes: K times, B numbers by which slopes are asked for.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.backlash import with_backlash
from symhyb.numeric.kernels.buffers import Array, held_at
from symhyb.numeric.kernels.jit import jitted
from symhyb.numeric.kernels.quantised import quantised

Mask = NDArray[np.bool_]
Rows = NDArray[np.int64]

PARTS = 8  # of the time between two samples: a lag or a rate limit bends the line between them
JUMP = 1e-9  # of a sample: how long a jump takes, of a held signal or of slopes at a kink
TWICE = 1e-6  # of a sample: times that are so near are those of a jump
_Shape = Callable[[Array, Mask, float, int | None], Array]
MOVING = ("rate_limit", "lag")  # what makes a held signal one that moves between its samples


@dataclass(frozen=True, slots=True, eq=False)
class Acted:
    """A signal ``u`` (K,) in its unit at times ``t`` (K,), s, lines between them or ``held``, and
    its slopes ``by`` (K, B) by the numbers that were asked for."""

    t: Array
    u: Array
    by: Array
    held: bool = False

    def at(self, t: Array) -> Array:
        """The signal at other times (any shape), s; its first and last value hold outside."""
        return self._follow(self.u, t)

    def by_at(self, t: Array) -> Array:
        """The slopes at other times (any shape), s, behind that shape (…, B)."""
        each = [self._follow(column, t) for column in self.by.T]
        return np.stack(each, axis=-1) if each else np.empty((*t.shape, 0))

    def _follow(self, values: Array, t: Array) -> Array:
        return held_at(self.t, values, t) if self.held else np.asarray(np.interp(t, self.t, values))


def acted(
    t: Array,
    u: Array,
    numbers: Mapping[str, float],
    held: bool = False,
    fine: bool = False,
    asked: Sequence[str] = (),
) -> Acted:
    """A signal ``u`` (K,) recorded at times ``t`` (K,), s, as it acts, in its unit; ``numbers`` of
    the actuator by key, SI. ``held``: from each sample to the next; ``fine``: its times are close
    enough for what a lag or a rate limit makes of it. Slopes by the keys ``asked``."""
    given = {key: value for key, value in numbers.items() if value > 0}
    moves = any(key in given for key in MOVING)
    columns = np.column_stack([u, np.zeros((u.size, len(asked)))])  # the signal, then its slopes
    keys = {key: 1 + i for i, key in enumerate(asked)}
    if "quantum" in given:
        over = PARTS if fine else 1
        columns[:, 0], by_quantum = quantised(t, u, given["quantum"], held, over)
        if "quantum" in keys:
            columns[:, keys["quantum"]] = by_quantum
    if moves and not (fine or held):
        t, columns = _parted(t, columns)
    if "dead_band" in given:
        t, columns = _shaped(t, columns, _banded, given["dead_band"], held, keys.get("dead_band"))
    if "backlash" in given:
        t, columns = with_backlash(t, columns, given["backlash"], held, keys.get("backlash"))
    if "limit" in given:
        t, columns = _shaped(t, columns, _limited, given["limit"], held, keys.get("limit"))
    if moves and held:
        t, columns = _ramps(t, columns)
        t, columns = (t, columns) if fine else _parted(t, columns)
    rate, by_rate = given.get("rate_limit", np.inf), keys.get("rate_limit")
    if "lag" in given:
        columns = _lagged(t, columns, given["lag"], rate, keys.get("lag"), by_rate)
    elif "rate_limit" in given:
        columns = _slewed(t, columns, rate, by_rate, not held)
    return Acted(t, columns[:, 0].copy(), columns[:, 1:].copy(), held and not moves)


def _shaped(
    t: Array, columns: Array, make: _Shape, level: float, held: bool, own: int | None
) -> tuple[Array, Array]:
    """Times and columns (K, 1 + B) behind what acts otherwise beyond ± a ``level``."""
    beyond = np.abs(columns[:, 0]) > level
    if not held:
        t, columns, beyond = _with_crossings(t, columns, beyond, level)
    return t, make(columns, beyond, level, own)


def _banded(columns: Array, beyond: Mask, band: float, own: int | None) -> Array:
    u = columns[:, 0]
    made = np.where(beyond[:, None], columns, 0.0)
    made[:, 0] = u - np.clip(u, -band, band)
    if own is not None:
        made[:, own] -= np.where(beyond, np.sign(u), 0.0)
    return made


def _limited(columns: Array, beyond: Mask, limit: float, own: int | None) -> Array:
    u = columns[:, 0]
    made = np.where(beyond[:, None], 0.0, columns)
    made[:, 0] = np.clip(u, -limit, limit)
    if own is not None:
        made[:, own] += np.where(beyond, np.sign(u), 0.0)
    return made


def _slewed(t: Array, columns: Array, rate: float, own: int | None, kinks: bool) -> Array:
    """Columns (K, 1 + B) of a signal that moves no faster than a ``rate``, and where it does not
    catch up the slopes of where it last did. At a kink that moves in time, where the signal is L
    before and R behind, that is the share (L' − rate)/(L' − R') of those of R."""
    steps = np.diff(t)
    y, side, source = columns[:, 0].copy(), np.zeros(t.size), np.arange(t.size)
    _slew(rate * steps, y, side, source)
    made = columns[source]
    if kinks and columns.shape[1] > 1:
        made[:, 1:] += _at_kinks(t, columns, source, rate * side)
    made[:, 0] = y
    if own is not None:
        ran = np.concatenate([[0.0], np.cumsum(side[1:] * steps)])
        made[:, own] += ran - ran[source]
    return made


@jitted
def _slew(most: Array, y: Array, side: Array, source: Rows) -> None:
    """Write what follows ``y`` (K,) by no more than ``most`` (K − 1,) from one time to the next in
    its place, in which direction it runs at its rate, and since when."""
    for i in range(1, y.size):
        away = y[i] - y[i - 1]
        if abs(away) > most[i - 1]:
            side[i] = 1.0 if away > 0 else -1.0
            y[i] = y[i - 1] + side[i] * most[i - 1]
            source[i] = source[i - 1]


def _at_kinks(t: Array, columns: Array, source: Rows, rates: Array) -> Array:
    """What the slopes (K, B) of a signal that runs at its ``rates`` (K,) have more where it left
    the other one, at ``source`` (K,), at a kink that moves in time."""
    more = np.zeros((t.size, columns.shape[1] - 1))
    steps = np.diff(t)
    twice = np.append(steps < TWICE * np.median(steps), False)
    rises = np.diff(columns[:, 0]) / steps
    for i in np.unique(source[rates != 0]):
        first = i if twice[i] else i - 1  # of the two times at the kink
        if not (first > 0 and twice[first] and first + 1 < rises.size):
            continue
        runs = np.flatnonzero((source == i) & (rates != 0))
        before, behind, now = rises[first - 1], rises[first + 1], rates[runs[0]]
        share = np.clip((before - now) / (before - behind), 0.0, 1.0)
        left, right = columns[first, 1:], columns[first + 1, 1:]
        more[runs] = (1 - share) * left + share * right - columns[i, 1:]
    return more


def _lagged(
    t: Array, columns: Array, lag: float, rate: float, by_lag: int | None, by_rate: int | None
) -> Array:
    """Columns (K, 1 + B) behind a first-order lag, exact for lines between the times, that moves no
    faster than a ``rate``."""
    steps = np.diff(t)
    keeps = np.exp(-steps / lag)
    gone = -np.expm1(-steps / lag)
    moves = gone * lag / steps  # mean of what is kept over a step
    comes = (moves - keeps)[:, None] * columns[:-1] + (1 - moves)[:, None] * columns[1:]
    y, ways = _followed(float(columns[0, 0]), keeps, comes[:, 0], rate * steps)
    runs = ways != 0
    if by_lag is not None:
        u = columns[:, 0]
        longer = keeps * steps / lag**2  # slopes by the lag, of ``keeps`` and of ``moves``
        more = gone / steps - longer * lag / steps
        comes[:, by_lag] += longer * y[:-1] + (more - longer) * u[:-1] - more * u[1:]
    comes[runs], keeps[runs] = 0.0, 1.0
    if by_rate is not None:
        comes[:, by_rate] += ways * steps
    slopes = [
        _kept(column[0], keeps, come.copy())
        for column, come in zip(columns.T, comes.T, strict=True)
    ]
    return np.column_stack([y, *slopes[1:]])


@jitted
def _followed(first: float, keeps: Array, comes: Array, most: Array) -> tuple[Array, Array]:
    """z(i + 1) = keeps(i)·z(i) + comes(i) from z(0) on, (K,), but never by more than ``most`` from
    one to the next, and in which direction it went by as much (K − 1,), else 0."""
    z, ways = np.empty(keeps.size + 1), np.zeros(keeps.size)
    z[0] = first
    for i in range(keeps.size):
        change = keeps[i] * z[i] + comes[i] - z[i]
        if abs(change) > most[i]:
            ways[i] = 1.0 if change > 0 else -1.0
            change = ways[i] * most[i]
        z[i + 1] = z[i] + change
    return z, ways


@jitted
def _kept(first: float, keeps: Array, comes: Array) -> Array:
    """z(i + 1) = keeps(i)·z(i) + comes(i) from z(0) on, (K,) in the unit of what comes."""
    z = np.empty(keeps.size + 1)
    z[0] = first
    for i in range(keeps.size):
        z[i + 1] = keeps[i] * z[i] + comes[i]
    return z


def _with_crossings(
    t: Array, columns: Array, beyond: Mask, level: float
) -> tuple[Array, Array, Mask]:
    """Times, columns and what is ``beyond`` ± ``level`` (K,), with two times more wherever the
    signal crosses one of these: the slopes jump there."""
    times, sides = [t], [beyond]
    step = float(np.median(np.diff(t)))
    for way in (level, -level):
        off = (columns[:, 0] - way) * np.sign(way)
        i = np.flatnonzero(off[:-1] * off[1:] < 0)
        at = t[i] + (t[i + 1] - t[i]) * off[i] / (off[i] - off[i + 1])
        times += [at, at + JUMP * step]
        sides += [off[i] > 0, off[i] < 0]
    order = np.argsort(np.concatenate(times), kind="stable")
    at = np.concatenate(times)[order]
    return at, _on_lines(t, columns, at), np.concatenate(sides)[order]


def _on_lines(t: Array, columns: Array, at: Array) -> Array:
    return np.column_stack([np.interp(at, t, column) for column in columns.T])


def _parted(t: Array, columns: Array) -> tuple[Array, Array]:
    """Signals of lines at ``PARTS`` times as many times."""
    inner = t[:-1, None] + np.diff(t)[:, None] * np.arange(PARTS) / PARTS
    at = np.append(inner, t[-1:])
    return at, _on_lines(t, columns, at)


def _ramps(t: Array, columns: Array) -> tuple[Array, Array]:
    """Held signals as lines, with one time more right before each jump."""
    jumps = 1 + np.flatnonzero(np.any(np.diff(columns, axis=0) != 0, axis=1))
    before = t[jumps] - JUMP * (t[jumps] - t[jumps - 1])
    return np.insert(t, jumps, before), np.insert(columns, jumps, columns[jumps - 1], axis=0)
