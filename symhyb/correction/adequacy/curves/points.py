"""Where a curve needs points, and how many: by what they are worth in the linear problem.

A fine line is smoothed; beginning with its ends and its middle, the point is added that is worth
most, as long as a few more may be. The best set is put right: its points move to where they are
worth most, and one leaves that is not worth 1 of ln evidence, for the prior is a guess, and what is
fitted to a point errs by its noise (Akaike, IEEE Trans. Automatic Control 19, 1974).
Sizes: G points of the fine line, P points of a curve.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from symhyb.correction.adequacy.classes.columns import LENGTHS
from symhyb.correction.adequacy.curves.courses import Line
from symhyb.correction.adequacy.curves.prior import covariance, factor
from symhyb.correction.adequacy.curves.products import Products
from symhyb.discrepancy.places.hypotheses import CurvePoint
from symhyb.laws.cardinal import cardinal_values
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

    @property
    def paid(self) -> float:
        """What they are worth, 1 less for each."""
        return self.worth - len(self.chosen)


class _Along(NamedTuple):
    """A fine ``line``, its ``smooth`` values (G,), SI, and the ``length`` of that, in half
    ranges, which is the prior of the values of all sets."""

    line: Line
    smooth: Array
    length: float


def placed(line: Line) -> Points:
    """The points of the largest evidence, 1 less for each."""
    smooth, covered, length = smoothed(line, 0.0 if line.through_zero else None)
    along = _Along(line, smooth, length)
    now = best = _best_of(along, [_first(line)], AGAIN)
    tried, since = 1, 0
    while len(now.chosen) < POINTS_MOST and since < PATIENCE:
        more = _with_one_more(along, now.chosen)
        if more is None:
            break
        now, tried = more, tried + 1
        since = 0 if now.paid > best.paid else since + 1
        best = max(best, now, key=_paid)
    best = _put_right(along, best)
    at = list(best.chosen)
    shift = np.hypot(smooth[at] - best.y, np.sqrt(np.maximum(np.diag(covered)[at], 0.0)))
    return Points(line.x[at], best.y, best.worth, tried, shift)


def _paid(one: _Set) -> float:
    return one.paid


def _with_one_more(along: _Along, chosen: tuple[int, ...]) -> _Set | None:
    """A set with the point more that is worth most; None where all points are in it."""
    rest = [i for i in range(along.line.x.size) if i not in chosen]
    if not rest:
        return None
    best = _best_of(along, [sorted((*chosen, i)) for i in rest])
    return _best_of(along, [best.chosen], AGAIN)


def _put_right(along: _Along, best: _Set) -> _Set:
    """A set whose points stand where they are worth most, without those that are not worth 1."""
    line, best = along.line, _moved(along, best)
    while len(best.chosen) > 2:
        less = [
            [*best.chosen[:k], *best.chosen[k + 1 :]]
            for k in range(1, len(best.chosen) - 1)
            if not line.stays(line.x[best.chosen[k]])
        ]
        if not less:
            break
        fewer = _moved(along, _best_of(along, less))
        if fewer.paid <= best.paid:
            break
        best = fewer
    return best


def _moved(along: _Along, best: _Set) -> _Set:
    """A set each of whose inner points stands where it is worth most between its neighbours."""
    line, best = along.line, _best_of(along, [best.chosen], AGAIN)
    for _ in range(PASSES):
        before = best.worth
        for k in range(1, len(best.chosen) - 1):
            at = best.chosen
            if line.stays(line.x[at[k]]):
                continue
            offers = [[*at[:k], i, *at[k + 1 :]] for i in range(at[k - 1] + 1, at[k + 1])]
            moved = _best_of(along, offers)
            here = _best_of(along, [moved.chosen], AGAIN)
            best = max(best, here, key=_paid)
        if best.worth <= before:
            break
    return best


def _first(line: Line) -> list[int]:
    """The ends, and between them where nothing moves, or the middle."""
    x = line.x
    centre = 0.0 if x[0] < 0 < x[-1] else 0.5 * (x[0] + x[-1])
    middle = 1 + int(np.argmin(np.abs(x[1:-1] - centre)))
    return [0, middle, x.size - 1]


def _best_of(along: _Along, sets: Sequence[Sequence[int]], again: int = 0) -> _Set:
    """Of sets of as many points the one that is worth most, with the values of the largest
    evidence."""
    line, chosen = along.line, np.array(sets)
    x, y = line.x[chosen], along.smooth[chosen]
    free = np.array([[not line.stays(at) for at in row] for row in x])
    spread = factor(x, along.length, 0.0 if line.through_zero else None)
    worth = np.full(len(x), -np.inf)
    for _ in range(again + 1):
        columns = cardinal_values(x, y, line.x) * free[:, None]
        worth, numbers = worth_of(line, columns @ spread)
        y = (spread @ numbers[..., None])[..., 0]
    best = int(np.argmax(worth))
    return _Set(
        tuple(chosen[best].tolist()), np.where(free[best], y[best], 0.0), float(worth[best])
    )


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


def worth_of(line: Weighed, columns: Array) -> tuple[Array, Array]:
    """What columns (G, P) of the fine line are worth, and their coefficients (P,), SI; or those of
    many sets (…, G, P) at once."""
    worth, values, _ = _at_best(line, columns)
    return worth, values


def solved(line: Weighed, columns: Array) -> tuple[Array, Array, Array]:
    """What columns (G, P) of the fine line are worth, their coefficients (P,) and the covariance of
    these (P, P), SI; or those of many sets (…, G, P) at once."""
    worth, values, seen = _at_best(line, columns)
    return worth, values, np.asarray(line.size**2 * np.linalg.inv(seen))


def _at_best(line: Weighed, columns: Array) -> tuple[Array, Array, Array]:
    """What columns (…, G, P) are worth (…,) at the best size of the unknown force, their
    coefficients (…, P), SI, and how well these are seen (…, P, P), in units of their prior; each
    coefficient is of the size of what moves the place."""
    across, found = np.swapaxes(columns, -1, -2), []
    for products, more in line.products:
        block = line.size**2 * across @ products[:-1, :-1] @ columns
        toward = -line.size * across @ products[:-1, -1]  # residual + columns · values is left
        seen = block + np.eye(toward.shape[-1])
        values = np.linalg.solve(seen, toward[..., None])[..., 0]
        sizes = np.linalg.slogdet(seen)[1]
        worth = 0.5 * (np.sum(toward * values, axis=-1) - sizes) + more
        found.append((worth, values, seen))
    worth, values, seen = (np.stack(parts) for parts in zip(*found, strict=True))
    best = np.argmax(worth, axis=0)[None]
    worth = np.take_along_axis(worth, best, 0)[0]
    values = np.take_along_axis(values, best[..., None], 0)[0]
    seen = np.take_along_axis(seen, best[..., None, None], 0)[0]
    return worth, line.size * values, seen


def smoothed(line: Weighed, zero: float | None = None) -> tuple[Array, Array, float]:
    """The fine line (G,) and its covariance (G, G), SI, as a Gaussian process, of the length of the
    largest evidence, which is given too, in half ranges; 0 at ``zero``, SI."""
    found = []
    for length in LENGTHS:
        spread, along = np.linalg.eigh(covariance(line.x, length, zero))
        columns = along * np.sqrt(np.maximum(spread, 0.0))
        worth, values, seen = solved(line, columns)
        found.append((float(worth), columns @ values, columns @ seen @ columns.T, length))
    _, mean, covered, length = max(found, key=lambda one: one[0])
    return np.asarray(mean), np.asarray(covered), length
