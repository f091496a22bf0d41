"""Where a curve needs points, and how many: by what they are worth in the linear problem.

A fine line is smoothed; beginning with its ends and its middle, the point is added that is worth
most, as long as a few more may be. The set of the largest evidence is put right: its points move to
where they are worth most, and one leaves if the set is worth more without it.
Sizes: G points of the fine line, P points of a curve.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from symhyb.correction.adequacy.classes.columns import LENGTHS
from symhyb.correction.adequacy.curves.courses import Line
from symhyb.correction.adequacy.curves.products import Products
from symhyb.discrepancy.places.hypotheses import CurvePoint
from symhyb.laws.cardinal import cardinals
from symhyb.numeric.kernels.buffers import Array

POINTS_MOST = 12
PATIENCE = 2  # points that are worth nothing, one after the other, before no more are added
PASSES = 3  # over the points of a set, each of which moves
AGAIN = 2  # times that a curve is made linear about what it was fitted to


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points (``x``, ``y``) (P,) of a curve, SI, and what they are ``worth`` in ln evidence beside
    the numbers of sets that were ``tried``. ``shift`` (P,), SI, is what a smooth line without
    points says otherwise there and how well it knows that: what few points cannot follow bends
    their values."""

    x: Array
    y: Array
    worth: float
    tried: int
    shift: Array

    @property
    def listed(self) -> tuple[CurvePoint, ...]:
        """The points as a cause has them."""
        rows = zip(self.x.tolist(), self.y.tolist(), self.shift.tolist(), strict=True)
        return tuple(rows)


@dataclass(frozen=True, slots=True, eq=False)
class _Set:
    """Points by their numbers (``chosen``) on the fine line, with values (P,), SI, and what they
    are worth in ln evidence."""

    chosen: tuple[int, ...]
    y: Array
    worth: float


def placed(line: Line) -> Points:
    """The points of the largest evidence."""
    zero = int(np.flatnonzero(line.x == 0.0)[0]) if line.through_zero else None
    smooth, covariance = smoothed(line, zero)
    now = best = _judged(line, _first(line), smooth)
    tried, since = 1, 0
    while len(now.chosen) < POINTS_MOST and since < PATIENCE:
        more = _with_one_more(line, now.chosen, smooth)
        if more is None:
            break
        now, tried = more, tried + 1
        since = 0 if now.worth > best.worth else since + 1
        best = max(best, now, key=_worth)
    best = _put_right(line, best, smooth)
    at = list(best.chosen)
    shift = np.hypot(smooth[at] - best.y, np.sqrt(np.maximum(np.diag(covariance)[at], 0.0)))
    return Points(line.x[at], best.y, best.worth, tried, shift)


def _worth(one: _Set) -> float:
    return one.worth


def _with_one_more(line: Line, chosen: tuple[int, ...], smooth: Array) -> _Set | None:
    """A set with the point more that is worth most; None where all points are in it."""
    rest = [i for i in range(line.x.size) if i not in chosen]
    offers = [_judged(line, sorted((*chosen, i)), smooth, again=0) for i in rest]
    if not offers:
        return None
    return _judged(line, max(offers, key=_worth).chosen, smooth)


def _put_right(line: Line, best: _Set, smooth: Array) -> _Set:
    """A set whose points stand where they are worth most, without those that are worth nothing."""
    best = _moved(line, best, smooth)
    while len(best.chosen) > 2:
        less = [
            _judged(line, [*best.chosen[:k], *best.chosen[k + 1 :]], smooth, again=0)
            for k in range(1, len(best.chosen) - 1)
            if not line.stays(line.x[best.chosen[k]])
        ]
        if not less:
            break
        fewer = _moved(line, max(less, key=_worth), smooth)
        if fewer.worth <= best.worth:
            break
        best = fewer
    return best


def _moved(line: Line, best: _Set, smooth: Array) -> _Set:
    """A set each of whose inner points stands where it is worth most between its neighbours."""
    best = _judged(line, best.chosen, smooth)
    for _ in range(PASSES):
        before = best.worth
        for k in range(1, len(best.chosen) - 1):
            at = best.chosen
            if line.stays(line.x[at[k]]):
                continue
            offers = [
                _judged(line, [*at[:k], i, *at[k + 1 :]], smooth, again=0)
                for i in range(at[k - 1] + 1, at[k + 1])
            ]
            here = _judged(line, max(offers, key=_worth).chosen, smooth)
            best = max(best, here, key=_worth)
        if best.worth <= before:
            break
    return best


def _first(line: Line) -> list[int]:
    """The ends, and between them where nothing moves, or the middle."""
    x = line.x
    centre = 0.0 if x[0] < 0 < x[-1] else 0.5 * (x[0] + x[-1])
    middle = 1 + int(np.argmin(np.abs(x[1:-1] - centre)))
    return [0, middle, x.size - 1]


def _judged(line: Line, chosen: Sequence[int], smooth: Array, again: int = AGAIN) -> _Set:
    """A set of points with the values of the largest evidence, and that."""
    x, y = line.x[list(chosen)], smooth[list(chosen)]
    worth = -np.inf
    for _ in range(again + 1):
        curved = np.stack([part(line.x) for part in cardinals("", x.tolist(), y.tolist())], axis=1)
        free = [k for k, i in enumerate(chosen) if not line.stays(line.x[i])]
        worth, values = worth_of(line, curved[:, free])
        y = np.zeros_like(x)
        y[free] = values
    return _Set(tuple(chosen), y, worth)


class Weighed(Protocol):
    """A fine line over ``x`` (G,) in the linear problem: the products of its values, and their
    size, SI."""

    @property
    def x(self) -> Array:
        """Where its values stand (G,), SI."""

    @property
    def products(self) -> tuple[Products, ...]:
        """The products of its values, for every size of the unknown force."""

    @property
    def size(self) -> float:
        """The prior deviation of a value, SI."""


def worth_of(line: Weighed, columns: Array) -> tuple[float, Array]:
    """What columns (G, P) of the fine line are worth, and their coefficients (P,), SI."""
    return solved(line, columns)[:2]


def solved(line: Weighed, columns: Array) -> tuple[float, Array, Array]:
    """What columns (G, P) of the fine line are worth, their coefficients (P,) and the covariance of
    these (P, P), SI, at the best size of the unknown force; each coefficient is of the size of what
    moves the place."""
    found = []
    for products, more in line.products:
        block = line.size**2 * columns.T @ products[:-1, :-1] @ columns
        toward = -line.size * columns.T @ products[:-1, -1]  # residual + columns · values is left
        seen = block + np.eye(toward.size)
        values = np.linalg.solve(seen, toward)
        worth = 0.5 * float(toward @ values - np.linalg.slogdet(seen)[1]) + more
        found.append((worth, values, seen))
    worth, values, seen = max(found, key=lambda one: one[0])
    return worth, np.asarray(line.size * values), np.asarray(line.size**2 * np.linalg.inv(seen))


def smoothed(line: Weighed, zero: int | None = None) -> tuple[Array, Array]:
    """The fine line (G,) and its covariance (G, G), SI, as a Gaussian process (Matérn 5/2) of what
    moves the place, of the length of the largest evidence; 0 at its point of the number ``zero``.
    """
    x = (2 * line.x - line.x[0] - line.x[-1]) / (line.x[-1] - line.x[0])
    found = []
    for length in LENGTHS:
        far = np.sqrt(5.0) * np.abs(x[:, None] - x) / length
        kernel = (1 + far + far**2 / 3) * np.exp(-far)
        if zero is not None:
            kernel = kernel - np.outer(kernel[:, zero], kernel[zero]) / kernel[zero, zero]
        spread, along = np.linalg.eigh(kernel)
        columns = along * np.sqrt(np.maximum(spread, 0.0))
        worth, values, covariance = solved(line, columns)
        found.append((worth, columns @ values, columns @ covariance @ columns.T))
    _, mean, covariance = max(found, key=lambda one: one[0])
    return np.asarray(mean), np.asarray(covariance)
