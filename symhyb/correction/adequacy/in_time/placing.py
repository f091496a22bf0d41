"""Where a course begins: each shape as the linear problem has it.

A fine broken line over the time is linear in its values, and so is every shape through some of its
points: the pair of points of a step, the ends of a drift, a line through as many points as are
worth something.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.curves.points import smoothed, worth_of
from symhyb.correction.adequacy.in_time.changing_number import (
    Number,
    TimeLine,
    abscissae,
    beyond,
    channels,
    hats,
    line_through,
    waves_at,
)
from symhyb.correction.adequacy.in_time.shapes import Shape, ShapeName
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.numeric.kernels.buffers import Array

FINE = 64  # points of the fine line
AGAIN = 40  # points between the neighbours of a step, for its time
POINTS_MOST = 12
PATIENCE = 2  # points that are worth nothing, one after the other, before no more are added
PASSES = 3  # over the points of a set, each of which moves
SHORTEST = 2.0  # samples: between two points
NEAR = (-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75)  # of an even distance: points beside a known one
OFF = (-0.25, 0.0, 0.25)  # over the length of a recording: frequencies beside the best one


class Begun(NamedTuple):
    """A shape with the values of the linear problem, and the ``price``, in ln, of having chosen it
    among so many; ``shift`` (P,), without a unit, of a free line is what a smooth line without
    points says otherwise at its points and how well it knows that."""

    shape: Shape
    price: float
    shift: Array | None = None


def begun(ground: Recorded, trial: Fitted, number: Number) -> Iterator[Begun]:
    """The shapes that a number may have around a structure."""
    ends = _ends(ground)
    line = line_through(ground, trial, number, np.linspace(*ends, FINE))
    yield _straight(line)
    for pair in _steps(ground, trial, number, line):
        yield Begun(pair, float(np.log(2)))  # as fast as samples show, or slower
    if np.isfinite(number.frequency):
        yield Begun(_period(ground, trial, number, ends[1] - ends[0]), float(np.log(len(OFF))))
    free = _free(line)
    if free is not None:
        yield free
    beside = channels(ground)
    for name in beside:
        x = np.linspace(*_ends(ground, name), FINE)
        along = line_through(ground, trial, number, x, over=name)
        for offer in filter(None, (_straight(along), _free(along))):
            yield offer._replace(price=offer.price + float(np.log(len(beside))))


def _straight(line: TimeLine) -> Begun:
    return Begun(_through(line, (0, FINE - 1), "drift"), 0.0)


def _ends(ground: Recorded, over: str = "") -> tuple[float, float]:
    """The first and the last time, s, or the least and the largest value of a channel, SI."""
    at = abscissae(ground, over)
    return float(min(one.min() for one in at)), float(max(one.max() for one in at))


def again(
    ground: Recorded, trial: Fitted, number: Number, shape: Shape, held: Sequence[str]
) -> Begun | None:
    """A line through points around a structure in which the number has a broken line already, whose
    numbers are ``held``: there less is left, so that points are worth more. None where its ends are
    all that it needs."""
    ends = _ends(ground, shape.over)
    even = np.linspace(*ends, FINE)
    near = np.add.outer(np.array(shape.times), (even[1] - even[0]) * np.array(NEAR)).ravel()
    x = np.unique(np.concatenate([even, np.clip(near, *ends)]))
    step = (ends[1] - ends[0]) / (FINE * AGAIN) if shape.over else ground.step_s
    x = x[np.append(True, np.diff(x) > SHORTEST * step)]
    x[-1] = ends[1]
    line = line_through(ground, trial, number, x, held, shape.over)
    return _free(beyond(line, shape.at(x)))


def ended(shape: Shape) -> bool:
    """Whether the search for points ended by itself, not at the most that there may be: what asks
    for more is no line through points."""
    return len(shape.times) < POINTS_MOST


def _free(line: TimeLine) -> Begun | None:
    chosen, tried = _points(line)
    if len(chosen) == 2:
        return None
    free = _through(line, chosen, "free")
    return Begun(free, float(np.log(tried)), _shift(line, chosen, free))


def _through(line: TimeLine, chosen: Sequence[int], name: ShapeName) -> Shape:
    """A broken line through some points of the fine one, with the values of the linear problem."""
    x = line.x[list(chosen)]
    _, values = worth_of(line, hats(line.x, x))
    return Shape(name, tuple(x.tolist()), tuple((1 + values).tolist()), over=line.over)


def worth_along(ground: Recorded, trial: Fitted, number: Number, shape: Shape) -> float:
    """What a number with such a shape, of any values, is worth in ln evidence around a
    structure."""
    if shape.name == "period":
        line = waves_at(ground, trial, number, shape.values[2])
    else:
        line = line_through(ground, trial, number, np.array(shape.times), over=shape.over)
    return float(worth_of(line, np.eye(line.x.size))[0])


def _shift(line: TimeLine, chosen: Sequence[int], free: Shape) -> Array:
    smooth, covariance, _ = smoothed(line)
    at = list(chosen)
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return np.asarray(np.hypot(1 + smooth[at] - np.array(free.values), deviation[at]))


def _worth(line: TimeLine, chosen: Sequence[int]) -> float:
    return float(worth_of(line, hats(line.x, line.x[list(chosen)]))[0])


def _best_pair(line: TimeLine) -> tuple[int, int]:
    pairs = list(combinations(range(line.x.size), 2))
    return max(pairs, key=lambda pair: _worth(line, pair))


def _steps(ground: Recorded, trial: Fitted, number: Number, line: TimeLine) -> Iterator[Shape]:
    """A step that takes as long as is likeliest, and one that is as fast as samples show."""
    first, last = _best_pair(line)
    low, high = line.x[max(first - 1, 0)], line.x[min(last + 1, line.x.size - 1)]
    near = np.linspace(low, high, AGAIN)
    finer = line_through(ground, trial, number, near)
    found = _through(finer, _best_pair(finer), "step")
    yield found
    shortest = SHORTEST * ground.step_s
    if found.duration > shortest:
        ends = (found.middle - shortest / 2, found.middle + shortest / 2)
        yield Shape("step", ends, found.values, held=True)


def _period(ground: Recorded, trial: Fitted, number: Number, lasts: float) -> Shape:
    offers = []
    for off in OFF:
        frequency = number.frequency + off / lasts
        if frequency > 0:
            line = waves_at(ground, trial, number, frequency)
            offers.append((*worth_of(line, np.eye(3)), frequency))
    _, (sine, cosine, level), frequency = max(offers, key=lambda one: one[0])
    amplitude, phase = float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
    return Shape("period", (), (1 + float(level), amplitude, frequency, phase))


def _points(line: TimeLine) -> tuple[tuple[int, ...], int]:
    """The points of the largest evidence, and how many sets were tried one after the other."""
    now: tuple[int, ...] = (0, line.x.size - 1)
    best = now
    most, tried, since = _worth(line, now), 1, 0
    while len(now) < POINTS_MOST and since < PATIENCE:
        rest = [i for i in range(line.x.size) if i not in now]
        offers = [tuple(sorted((*now, i))) for i in rest]
        now = max(offers, key=lambda one: _worth(line, one))
        worth, tried = _worth(line, now), tried + 1
        since = 0 if worth > most else since + 1
        if worth > most:
            best, most = now, worth
    best, most = _moved(line, best, most)
    while len(best) > 2:
        less = [(*best[:k], *best[k + 1 :]) for k in range(1, len(best) - 1)]
        fewer = max(less, key=lambda one: _worth(line, one))
        fewer, worth = _moved(line, fewer, _worth(line, fewer))
        if worth <= most:
            break
        best, most = fewer, worth
    return best, tried


def _moved(line: TimeLine, chosen: tuple[int, ...], most: float) -> tuple[tuple[int, ...], float]:
    """A set each of whose inner points stands where it is worth most between its neighbours, and
    what it is worth."""
    for _ in range(PASSES):
        before = most
        for k in range(1, len(chosen) - 1):
            at = range(chosen[k - 1] + 1, chosen[k + 1])
            offers = [(*chosen[:k], i, *chosen[k + 1 :]) for i in at]
            chosen = max(offers, key=lambda one: _worth(line, one))
            most = _worth(line, chosen)
        if most <= before:
            break
    return chosen, most
