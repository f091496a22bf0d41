"""The units that the population of a fleet begins with, and how many of a group of peers it keeps.

Sizes: N units, K numbers, G groups of peers, P conditions.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from symhyb.fleet.means import Array, Unit, groups_of

Mask = NDArray[np.bool_]
ROUNDS = 20  # of least absolute deviations
NORMAL = 1.4826  # of a median deviation: the standard deviation of normal errors
LEAST = 1e-9  # of the largest value: a deviation that is smaller is none


def begun(units: Sequence[Unit], left: Array) -> Mask:
    """The units (N,) to begin with: those within the median deviations, number by number, that
    normal ones of so many reach, and of a group of peers of which these are no majority those next
    to its median. As many of the smallest as there are numbers in β beside the mean
    do not count for the median, since least absolute deviations pass through units (DuMouchel &
    O'Brien, Proceedings of the 21st Symposium on the Interface, 1989)."""
    values = np.column_stack([[one.y.mean(axis=0) for one in units], np.log(left)])
    x = np.array([one.columns for one in units])
    columns = values - _expected(x, values)
    columns = columns - np.median(columns, axis=0)
    free = np.sort(np.abs(columns), axis=0)[x.shape[1] - 1 :]
    scale = NORMAL * np.median(free, axis=0)
    noise = np.sqrt([np.diagonal(one.s, axis1=1, axis2=2).mean(axis=0) for one in units])
    numerics = np.array([one.numerics.mean(axis=0) for one in units])
    wide = np.hypot(np.maximum(scale[:-1], numerics), noise)
    wide = np.column_stack([wide, np.full(len(left), scale[-1])])
    reach = float(t.isf(0.5 / columns.size, len(units) - x.shape[1]))
    far = np.abs(columns) / np.maximum(wide, 1e-300)
    kept = np.all(far <= reach, axis=1)
    groups = groups_of(units)
    near = np.empty(len(units))
    for members in groups.T:
        inside = columns[members] - np.median(columns[members], axis=0)
        near[members] = -np.max(np.abs(inside) / np.maximum(wide[members], 1e-300), axis=1)
    kept, _ = of_majorities(kept, near, groups)
    return kept if determined(x[kept]) else np.ones(len(units), dtype=bool)


def determined(x: Array) -> bool:
    """Whether units with these columns (N, G + P) show all means and slopes."""
    return bool(np.linalg.matrix_rank(x) == x.shape[1])


def of_majorities(kept: Mask, near: Array, groups: Mask) -> tuple[Mask, Mask]:
    """Units (N,) of which every one of the ``groups`` (N, G: of which each unit has recordings)
    keeps more than half, those that are missing being the ``near`` ones (N,: the larger the
    nearer), and which units are of a group that kept no more than half by itself."""
    kept, disputed = kept.copy(), np.zeros(len(kept), dtype=bool)
    for members in map(np.flatnonzero, groups.T):
        least = len(members) // 2 + 1
        if kept[members].sum() < least:
            disputed[members] = True
            order = members[np.argsort(-np.where(kept[members], np.inf, near[members]))]
            kept[order[:least]] = True
    return kept, disputed


def _expected(x: Array, values: Array) -> Array:
    """What least absolute deviations expect of ``values`` (N, K), by weights; x (N, G + P)."""
    beta = np.linalg.lstsq(x, values, rcond=None)[0]
    least = LEAST * np.abs(values).max(axis=0) + 1e-300
    for _ in range(ROUNDS):
        weights = 1 / np.maximum(np.abs(values - x @ beta), least)
        columns = zip(weights.T, values.T, strict=True)
        beta = np.stack([_weighed(x, y, weight) for weight, y in columns], axis=1)
    return np.asarray(x @ beta)


def _weighed(x: Array, y: Array, weight: Array) -> Array:
    """Least squares of y (N,) by x (N, C) under a weight (N,)."""
    gram = x.T @ (weight[:, None] * x)
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    balanced = gram / np.outer(size, size)
    found = np.linalg.lstsq(balanced, x.T @ (weight * y) / size, rcond=None)[0]
    return np.asarray(found / size)
