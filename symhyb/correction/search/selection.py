"""Which few causes explain the mismatch: best subsets on the reduced linear problem.

Everything happens on Gram matrices of whitened columns with initial states projected out, so that
thousands of subsets cost milliseconds. A beam of the best subsets grows by one cause at a time;
forbidden signs drop out. Sizes: F columns, the residual is column F.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.search.owners import Layout
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.numeric.kernels.buffers import Array

BEAM = 24
TOGETHER = 5  # causes: more are weighed on Gram matrices alone, not fitted to try
AT_ONCE = 2000  # sets that are solved side by side
UNSEEN = 1e-100  # of the noise for one SI unit: a column that is rounding alone
CONDITION = 1e10  # of scaled columns: beyond, a subset cannot be distinguished


@dataclass(frozen=True, slots=True)
class Subset:
    """Causes by their index, coefficients ``values`` (one a column: shape (C,)) in SI, χ² on fitted
    and held windows, and how many ``numbers`` the causes fit."""

    causes: tuple[int, ...]
    values: Array
    chi2: float
    held: float
    numbers: int

    @property
    def left(self) -> float:
        """χ² of all windows."""
        return self.chi2 + self.held


@dataclass(frozen=True, slots=True)
class Problem:
    """The reduced problem: Gram matrices (F + 1, F + 1) of the fitted and the held windows,
    ``columns`` of each cause, columns that are ``always`` in, priors 1/sd² (F,), bounds of the
    coefficients (F,) in SI, beyond which a subset is not physics, and the ``least`` size (F,) of a
    coefficient that is worth a name. A cause with numbers that not all ``recordings`` (their names)
    share has a column for each of them, at the ``places`` that say whose it is."""

    gram: Array
    held: Array
    hypotheses: tuple[Hypothesis, ...]
    columns: tuple[tuple[int, ...], ...]
    always: tuple[int, ...]
    prior: Array
    lower: Array
    upper: Array
    least: Array
    recordings: tuple[str, ...] = ()
    places: Layout | None = None


def many(causes: Sequence[object]) -> bool:
    """Whether these are more causes than are tried by fits rather than weighed on Gram matrices."""
    return len(causes) > TOGETHER


def best_subsets(problem: Problem, largest: int = TOGETHER) -> list[list[Subset]]:
    """The best subsets of each size 0, 1, 2 … up to ``largest`` causes by χ², best first."""
    return list(islice(growing(problem, BEAM), largest + 1))


def growing(problem: Problem, beam: int) -> Iterator[list[Subset]]:
    """The best subsets of each size 0, 1, 2 … by χ², best first, as long as any grows; ``beam`` of
    each size grow."""
    empty = solve(problem, ())
    best = [empty] if empty is not None else []
    while best:
        yield best
        grown = {
            tuple(sorted((*parent.causes, cause)))
            for parent in best
            for cause in range(len(problem.hypotheses))
            if cause not in parent.causes
        }
        found = _solved(problem, [key for key in sorted(grown) if not _repeats(problem, key)])
        best = sorted(found, key=lambda subset: subset.chi2)[:beam]


def neighbours(problem: Problem, subset: Subset) -> list[Subset]:
    """The subsets with one cause less, but not none, and with another one in its place."""
    few = {tuple(sorted({*subset.causes} - {gone})) for gone in subset.causes}
    sets = few | {
        tuple(sorted((*kept, cause)))
        for kept in few
        for cause in range(len(problem.hypotheses))
        if cause not in subset.causes
    }
    return _solved(problem, [key for key in sorted(sets) if key and not _repeats(problem, key)])


def solve(problem: Problem, causes: Sequence[int]) -> Subset | None:
    """Least squares for one set of causes; None if a coefficient is out of its bounds or the data
    do not determine it."""
    columns = [c for cause in causes for c in problem.columns[cause]]
    own = [c for cause in causes if _apart(problem, cause) for c in _own(problem, cause)]
    none: set[int] = set()
    while True:  # own values that physics forbids are none, and the others fitted anew
        joined = [c for c in (*columns, *problem.always) if c not in none]
        fitted = _fitted(problem, joined)
        if fitted is None:
            return None
        forbidden = {c for c, x in zip(joined, fitted, strict=True) if x < problem.lower[c] == 0}
        if not forbidden <= {*own}:
            return None
        if not forbidden:
            break
        none |= forbidden
    coefficients = dict(zip(joined, fitted, strict=True))
    if not all(_sized(problem, coefficients, cause) for cause in causes):
        return None
    last = problem.gram.shape[0] - 1
    mix = np.zeros(last + 1)
    mix[joined], mix[last] = -fitted, 1
    chi2, held = float(mix @ problem.gram @ mix), float(mix @ problem.held @ mix)
    penalty = float(np.sum(problem.prior[joined] * fitted**2)) if joined else 0.0
    numbers = sum(problem.hypotheses[cause].numbers for cause in causes)
    values = np.array([coefficients.get(c, 0.0) for c in columns])
    return Subset(tuple(causes), values, chi2 + penalty, held, numbers)


def _solved(problem: Problem, sets: Sequence[tuple[int, ...]]) -> list[Subset]:
    """:func:`solve` for many sets of causes; those with as many columns side by side."""
    own = {cause for cause in range(len(problem.hypotheses)) if _apart(problem, cause)}
    alike: dict[int, list[tuple[int, ...]]] = {}
    found = []
    for causes in sets:
        if own.isdisjoint(causes):
            width = sum(len(problem.columns[cause]) for cause in causes)
            alike.setdefault(width, []).append(causes)
        elif (subset := solve(problem, causes)) is not None:  # its numbers are asked one by one
            found.append(subset)
    for group in alike.values():
        for begin in range(0, len(group), AT_ONCE):
            found += _side_by_side(problem, group[begin : begin + AT_ONCE])
    return found


def _side_by_side(problem: Problem, sets: Sequence[tuple[int, ...]]) -> list[Subset]:
    """The subsets (S) that the data determine and whose coefficients are in bounds and large
    enough; all sets have as many columns."""
    rows = [[c for cause in causes for c in problem.columns[cause]] for causes in sets]
    chosen = np.array(rows, np.int64)
    joined = np.hstack([chosen, np.tile(np.array(problem.always, int), (len(sets), 1))])
    width = joined.shape[1]
    block = problem.gram[joined[:, :, None], joined[:, None, :]]
    block[:, range(width), range(width)] += problem.prior[joined]
    scale = np.sqrt(np.diagonal(block, axis1=1, axis2=2))
    able: NDArray[np.int64] = np.flatnonzero(np.all(scale > UNSEEN, axis=1))
    unit = block[able] / (scale[able, :, None] * scale[able, None, :])
    eigen = np.linalg.eigvalsh(unit)
    clear = eigen[:, 0] >= eigen[:, -1] / CONDITION
    able, unit = able[clear], unit[clear]
    columns, size = joined[able], scale[able]
    right = problem.gram[columns, -1] / size
    values = np.linalg.solve(unit, right[..., None])[..., 0] / size
    good = np.all((values >= problem.lower[columns]) & (values <= problem.upper[columns]), axis=1)
    count = chosen.shape[1]
    good &= np.all(np.abs(values[:, :count]) >= problem.least[columns[:, :count]], axis=1)
    able, columns, values = able[good], columns[good], values[good]
    last = np.full((len(able), 1), len(problem.gram) - 1)
    mix, used = np.hstack([-values, np.ones((len(able), 1))]), np.hstack([columns, last])
    across = used[:, :, None], used[:, None, :]
    chi2, held = (
        np.einsum("si,sij,sj->s", mix, gram[across], mix) for gram in (problem.gram, problem.held)
    )
    chi2 = chi2 + np.sum(problem.prior[columns] * values**2, axis=1)
    return [
        Subset(
            sets[i],
            row[:count],
            float(fitted),
            float(apart),
            sum(problem.hypotheses[cause].numbers for cause in sets[i]),
        )
        for i, row, fitted, apart in zip(able.tolist(), values, chi2, held, strict=True)
    ]


def _fitted(problem: Problem, joined: Sequence[int]) -> Array | None:
    """Least squares (C,) of some columns; None if the data do not determine them, or one that no
    sign forbids is out of its bounds."""
    if not joined:
        return np.zeros(0)
    block = problem.gram[np.ix_(joined, joined)] + np.diag(problem.prior[joined])
    scale = np.sqrt(np.diag(block))
    if np.any(scale <= UNSEEN):
        return None
    unit = block / np.outer(scale, scale)
    eigen = np.linalg.eigvalsh(unit)
    if eigen[0] < eigen[-1] / CONDITION:
        return None
    values = np.linalg.solve(unit, problem.gram[joined, -1] / scale) / scale
    lower = problem.lower[joined]
    out = ((values < lower) & (lower != 0)) | (values > problem.upper[joined])
    return None if out.any() else np.asarray(values)


def _apart(problem: Problem, cause: int) -> bool:
    """Whether every recording has its own number of a cause. Of a fleet in which one machine lacks
    the cause, noise alone gives that one the wrong sign in half of all cases."""
    return len(problem.columns[cause]) > len(problem.hypotheses[cause].terms)


def _own(problem: Problem, cause: int) -> tuple[int, ...]:
    """The columns of a cause that not all recordings share."""
    columns = problem.columns[cause]
    if problem.places is None:
        return columns
    source = [problem.places.source[c] for c in columns]
    return tuple(c for c, one in zip(columns, source, strict=True) if source.count(one) > 1)


def _sized(problem: Problem, values: Mapping[int, float], cause: int) -> bool:
    """Whether the numbers of a cause, by column, are worth a name: all of them, or those of one
    recording at least where each has its own."""
    columns = problem.columns[cause]
    large = [c in values and abs(values[c]) >= problem.least[c] for c in columns]
    return any(large) if _apart(problem, cause) else all(large)


def _repeats(problem: Problem, causes: Sequence[int]) -> bool:
    """Whether two of the causes fit the same term of one subject (in another shape)."""
    terms = [
        (hypothesis.subject, term)
        for hypothesis in (problem.hypotheses[cause] for cause in causes)
        for term in hypothesis.terms
    ]
    return len(set(terms)) < len(terms)


def without(problem: Problem, dropped: set[int]) -> Problem:
    """The problem in which some causes can no longer be chosen."""
    return _bounded(problem, dropped, -np.inf)


def allowing(problem: Problem, causes: set[int]) -> Problem:
    """The problem in which some causes that could not be chosen can be, in any size."""
    return _bounded(problem, causes, np.inf)


def _bounded(problem: Problem, causes: set[int], upper: float) -> Problem:
    bounds = problem.upper.copy()
    for cause in causes:
        bounds[list(problem.columns[cause])] = upper
    return replace(problem, upper=bounds)
