"""A sensor that is refreshed by a clock of its own, and read at other times.

Servos, buses and inertial units measure every T seconds. Who reads them gets the last value, and
stamps it with the time at which it was read:

    y_i = x(t_i − a_i) + noise        a_i = (t_i − φ) mod T, the age of the value

      x |          _,-o             o  measured, at φ, φ + T, …
        |      _,-'   :             :  read at t_i, a_i later
        |  o--'   :   :
        +--|------:---|---:---> t

So steps of the signal are too short and too long in a pattern, in proportion to its speed. Now and
then the clock is read in another way, and φ is another one. Ages are known up to a constant, which
is a delay like any other. Sizes: N samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_lsq_spline

from symhyb.judgement import FEW, LARGE, NOTABLE, SMALL, SURE, UNEXPLAINED

Signal = NDArray[np.float64]
Flags = NDArray[np.bool_]

DEGREE = 5  # of the spline that stands for the motion
APART = 4.5  # samples between two of its knots
WINDOW = 60  # samples, the fastest of a recording, in which a period is looked for
SHORTEST, LONGEST = 1 / 3, 1.5  # of the time between two samples: periods that are tried
PHASES = 40  # of a period that are distinguished
FINE = 0.1  # of a period: two periods that are tried differ by as much at the end of a window
ROUNDS = 6  # of motion and ages, in turn
TRIED = 11  # periods about the one that was found
MEASURED = 3  # recordings by which a period is measured: those that show it best
LONGER = 50_000  # samples: in longer recordings no clock is looked for
ROUNDING = 1e-9  # of the range of a signal
TINY = 1e-300  # so that nothing is divided by 0
NORMAL = 0.6745  # deviations: half of normal errors are smaller


@dataclass(frozen=True, slots=True)
class Aged:
    """Ages (N,) of the samples of one recording in s, those that were read at a time that does not
    fit (``wrong``, (N,)), and how far (N,) the signal goes on in the age of each, less that in the
    mean age, in its unit. ``before`` and ``after`` are the mean squares of what a smooth motion
    leaves of samples that move, without and with the ages."""

    ages: Signal
    wrong: Flags
    further: Signal
    before: float
    after: float


@dataclass(frozen=True, slots=True)
class Refresh:
    """The ``period`` (s) in which a sensor is refreshed, and what that makes of each recording;
    None of one in which it moves too little to show it."""

    period: float
    each: tuple[Aged | None, ...]


def refresh(signals: Sequence[tuple[Signal, Signal]]) -> Refresh | None:
    """How one sensor is refreshed, from its recordings: times (N,) in s and values (N,), NaN where
    missing. None unless ages by a clock take nine tenths of what a smooth motion leaves of the
    samples that move, in all recordings together, and they all but a few."""
    found = [_searched(*_known(t, y)) for t, y in signals]
    shown = sorted((share, i) for i, (share, _) in enumerate(found) if share < LARGE)
    if not shown:
        return None
    best = [_known(*signals[i]) for _, i in shown[:MEASURED]]
    period = _measured(best, found[shown[0][1]][1])
    each = tuple(_aged(t, y, period) for t, y in signals)
    seen = [one for one in each if one is not None]
    left = sum(one.after for one in seen)
    if not seen or left > SMALL * sum(one.before for one in seen):
        return None
    return Refresh(period, tuple(one if one and _fits(one) else None for one in each))


def _fits(one: Aged) -> bool:
    """Whether the ages explain one recording, all but a few samples of it."""
    return one.after < SMALL * one.before and bool(one.wrong.mean() <= NOTABLE)


def _known(t: Signal, y: Signal) -> tuple[Signal, Signal]:
    """Times and values without the missing ones."""
    seen = np.isfinite(y)
    return t[seen], y[seen]


def _knots(t: Signal) -> Signal:
    """The knots of a spline along times (N,), every few samples."""
    count = max(int(t.size / APART), 2)
    inner = np.quantile(t, np.linspace(0, 1, count + 1)[1:-1])
    return np.concatenate(([t[0]] * (DEGREE + 1), inner, [t[-1]] * (DEGREE + 1)))


def _searched(t: Signal, y: Signal) -> tuple[float, float]:
    """The share of the squares that one period leaves where the signal (N,) is fastest, and that
    period, s; a share of 1 where none is found."""
    if not WINDOW <= t.size <= LONGER:
        return 1.0, 0.0
    t, y = _fastest(t, y, WINDOW)
    linear = _linear(t, y)
    if linear is None or not linear.whole > 0:
        return 1.0, 0.0
    best = 1.0, 0.0
    for period in _periods(float(np.median(np.diff(t))), float(t[-1] - t[0])):
        left = linear.left(np.mod(t[:, None] - _phases(period)[::2], period))
        best = min(best, (float(left.min()) / linear.whole, float(period)))
    return best


def _fastest(t: Signal, y: Signal, count: int) -> tuple[Signal, Signal]:
    """The samples (at most ``count``), one after the other, along which a signal goes furthest."""
    count = min(count, t.size)
    path = np.r_[0.0, np.cumsum(np.abs(np.diff(y)))]
    first = int(np.argmax(path[count - 1 :] - path[: path.size - count + 1]))
    return t[first : first + count], y[first : first + count]


def _periods(step: float, lasting: float) -> Signal:
    """Periods, s, so close that neighbours differ by little at the end of a window."""
    per_second = np.arange(1 / (LONGEST * step), 1 / (SHORTEST * step), FINE / lasting)
    return 1 / per_second


def _phases(period: float) -> Signal:
    """The phases (s) that are distinguished."""
    return np.arange(PHASES) / PHASES * period


def _measured(best: Sequence[tuple[Signal, Signal]], near: float) -> float:
    """The period (s) near one that fits best, where the recordings are fastest."""
    some = [_fastest(t, y, 4 * WINDOW) for t, y in best]
    lasting = float(np.median([t[-1] - t[0] for t, _ in some]))
    steps = np.linspace(-1, 1, TRIED) * near**2 * FINE * 4 / lasting

    def left(period: float) -> float:
        return sum(_cost(t, _aged(t, y, period), period) for t, y in some)

    return float(min(near + steps, key=left))


def _cost(t: Signal, aged: Aged | None, period: float) -> float:
    """−2 ln of the likelihood of ages along times (N,), s, with what the changes of their phase
    cost, up to a constant."""
    if aged is None:
        return np.inf
    phase = np.mod(t - aged.ages, period)
    changes = np.abs(np.diff(phase)) > period / PHASES / 2
    after = max(aged.after, TINY)
    return float(t.size * np.log(after) + 2 * np.log(2 * t.size) * changes.sum())


def _aged(t: Signal, y: Signal, period: float) -> Aged | None:
    """The ages of the samples of one recording, with motion and ages determined in turn."""
    seen = np.isfinite(y)
    known, values = t[seen], y[seen]
    least = ROUNDING * float(np.ptp(values)) if known.size else 0.0
    if not (WINDOW <= known.size <= LONGER and least > 0):
        return None
    fresh = np.mod(known[:, None] - _phases(period), period)
    ages = _by_parts(known, values, fresh)
    for _ in range(ROUNDS):
        smooth = _smooth(known - ages, values)
        if smooth is None:
            return None
        sd = max(_spread(values - smooth(known - ages)), least)
        ages = _along_clock(known, values, fresh, (smooth, sd, period))
    motions = _smooth(known, values), _smooth(known - ages, values)
    if motions[0] is None or motions[1] is None:
        return None
    return _of_all(t, seen, ages, values, (motions[0], motions[1]), period)


def _along_clock(
    t: Signal, y: Signal, fresh: Signal, motion: tuple[BSpline, float, float]
) -> Signal:
    """The likeliest ages (N,), s, of values (N,) along a smooth motion, with its noise and with the
    period, of those ``fresh`` (N, PHASES) and of those of a value that was read once more."""
    smooth, sd, period = motion
    again = 2 * np.log(t.size)  # the price of a sample that is one period older
    chi2 = [
        np.square((y[:, None] - smooth(_within(smooth, t[:, None] - fresh - old))) / sd)
        for old in (0.0, period)
    ]
    rows, path = np.arange(t.size), _path(np.minimum(chi2[0], chi2[1] + again))
    older = chi2[1][rows, path] + again < chi2[0][rows, path]
    return np.asarray(fresh[rows, path] + period * older)


def _of_all(
    t: Signal,
    seen: Flags,
    ages: Signal,
    values: Signal,
    motions: tuple[BSpline, BSpline],
    period: float,
) -> Aged | None:
    """What ages say of all samples, also those that are missing."""
    known, (plain, smooth) = t[seen], motions
    left = values - smooth(known - ages)
    speed = np.abs(smooth.derivative()(known - ages))
    moves = speed * period > SURE * _spread(left)
    if moves.sum() < FEW:
        return None
    wrong, every, further = np.zeros(t.size, bool), np.zeros(t.size), np.zeros(t.size)
    beyond = np.abs(left) > SURE * _spread(left[moves])
    wrong[seen], every[seen] = beyond, ages
    now, then = _within(smooth, known - period / 2), _within(smooth, known - ages)
    further[seen] = smooth(now) - smooth(then)
    most = SURE * _spread(left[moves])  # what does not fit counts no more than this
    before = float(np.mean(np.square(values - plain(known))[moves]))
    after = float(np.mean(np.square(np.clip(left, -most, most))[moves]))
    return Aged(every, wrong, further, before, after)


def _within(smooth: BSpline, t: Signal) -> Signal:
    """Times, s, that a spline covers."""
    return np.clip(t, smooth.t[0], smooth.t[-1])


def _spread(left: Signal) -> float:
    """The deviation of normal errors (N,) of which a few are none."""
    return max(float(np.median(np.abs(left))) / NORMAL, TINY)


def _smooth(t: Signal, y: Signal) -> BSpline | None:
    """A spline through values (N,) at times (N,) of which some may be the same, in any order."""
    times, which, counts = np.unique(t, return_inverse=True, return_counts=True)
    means = np.bincount(which, y) / counts  # a time that is there twice has twice the weight
    try:
        return make_lsq_spline(times, means, _knots(np.sort(t)), DEGREE, np.sqrt(counts))
    except (ValueError, np.linalg.LinAlgError):
        return None


@dataclass(frozen=True, slots=True, eq=False)
class _Linear:
    """What a smooth motion ``rest`` (N,) leaves of values, its ``speed`` (N,), and an orthonormal
    ``basis`` (N, K) of smooth motions."""

    rest: Signal
    speed: Signal
    basis: Signal

    @property
    def whole(self) -> float:
        """The squares that are left without ages."""
        return float(self.rest @ self.rest)

    def left(self, ages: Signal) -> Signal:
        """The squares (K,) that are left with each of some ages (N, K), s, to first order."""
        told = self.speed[:, None] * ages
        told -= self.basis @ (self.basis.T @ told)
        return np.asarray(np.sum(np.square(self.rest[:, None] + told), axis=0))


def _linear(t: Signal, y: Signal) -> _Linear | None:
    """The linear problem of ages along times (N,), s, and values (N,)."""
    smooth = _smooth(t, y)
    if smooth is None:
        return None
    basis = np.linalg.qr(BSpline.design_matrix(t, smooth.t, DEGREE).toarray())[0]
    return _Linear(y - smooth(t), smooth.derivative()(t), basis)


def _by_parts(t: Signal, y: Signal, fresh: Signal) -> Signal:
    """Ages (N,), s, to begin with, of those ``fresh`` (N, PHASES): in every part of a recording
    those of the phase that leaves least of all values (N,), or else of the part before, unless
    another one leaves much less there. Phases between which no sample is refreshed leave alike."""
    edges = np.linspace(0, t.size, max(2 * t.size // WINDOW, 1) + 1).astype(int)
    left = np.ones((edges.size - 1, fresh.shape[1]))
    for i, (first, last) in enumerate(pairwise(edges)):
        low = int(np.clip((first + last - WINDOW) // 2, 0, t.size - WINDOW))
        part = slice(low, low + WINDOW)
        linear = _linear(t[part], y[part])
        left[i] = 1.0 if linear is None else linear.left(fresh[part])
    usual = before = int(np.argmin(left.sum(axis=0)))
    ages = np.empty(t.size)
    for squares, first, last in zip(left, edges, edges[1:], strict=False):
        near = [one for one in (usual, before) if squares[one] <= UNEXPLAINED * squares.min()]
        before = near[0] if near else int(np.argmin(squares))
        ages[first:last] = fresh[first:last, before]
    return ages


def _path(chi2: Signal) -> NDArray[np.int64]:
    """The phase (N,) at every sample by which the sum of ``chi2`` (N, PHASES) and of what changes
    cost is the least (Viterbi). A change costs where it is, and which phase follows: any one, or a
    neighbour; a sample that fits no phase counts no more than one that hardly does."""
    count, phases = chi2.shape
    own = np.minimum(chi2, SURE**2)
    change, drift = 2 * np.log(count * phases), 2 * np.log(2 * count)
    total, came = own[0], np.zeros(chi2.shape, np.int64)
    at = np.arange(phases)
    for i in range(1, count):
        any_one = np.full(phases, total.argmin())
        before = np.stack((at, (at - 1) % phases, (at + 1) % phases, any_one))
        cost = total[before] + np.array([0.0, drift, drift, change])[:, None]
        least = cost.argmin(axis=0)
        came[i], total = before[least, at], cost[least, at] + own[i]
    path = np.empty(count, np.int64)
    path[-1] = total.argmin()
    for i in range(count - 1, 0, -1):
        path[i - 1] = came[i, path[i]]
    return path
