"""Which rows of constraints hold nothing, or only what rows before them hold.

A pin in space has three rows. In a loop that moves in one plane the one across it is zero wherever
the machine is, as an exact zero or as what rounding leaves: it holds nothing beside the others.
Sizes: n coordinates, m rows.
"""

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array

DEPENDENT = 1e-5  # of the length of a row of J: what is left of it beside the rows before. Where
# a loop locks, Newton's method finds the place, a double root, to the square root of rounding only
NOTHING = 1e-12  # of the longest row of the same constraint: what rounding leaves of a zero
# what hinges leave that are parallel to the digits of a file, of the longest row of the same pin: a
# quaternion of four digits is off by up to 1.7e-4 rad, 1.5708 for a right angle by 4e-6
SLIGHT = 2e-4


def dependent(whole: Array, free: NDArray[np.bool_], labels: Sequence[str]) -> dict[int, list[int]]:
    """Rows of J (m, n) that, in the free coordinates, depend on rows before them or hold nothing,
    each with those; ``labels`` (m,) say which rows are of one constraint."""
    kept_rows: list[int] = []
    found: dict[int, list[int]] = {}
    slope, floor = whole[:, free], _rounding(whole, labels)
    for i, row in enumerate(slope):
        size = float(np.linalg.norm(whole[i]))
        before = slope[kept_rows]
        weights = np.linalg.lstsq(before.T, row, rcond=DEPENDENT)[0] if kept_rows else np.zeros(0)
        left = float(np.linalg.norm(row - weights @ before if kept_rows else row))
        if size > floor[i] and left > DEPENDENT * size:
            kept_rows.append(i)
            continue
        shares = np.abs(weights) * np.linalg.norm(before, axis=1) if kept_rows else weights
        several = size > floor[i]
        found[i] = [kept_rows[j] for j in np.flatnonzero(shares > 1e-6 * size) if several]
    return found


def slight(
    slopes: Sequence[Array], labels: Sequence[str], names: Sequence[str], share: float = SLIGHT
) -> tuple[int, ...]:
    """Rows of the constraints of these ``names`` that are no longer than a ``share`` of the longest
    row of the same one, in all J (m, n) given, SI; ``labels`` (m,) say which are of one
    constraint."""
    of = np.array([constraint_of(label) for label in labels])
    small = np.isin(of, list(names))
    for slope in slopes:
        sizes = np.linalg.norm(slope, axis=1)
        small &= sizes <= share * np.array([sizes[of == name].max() for name in of])
    return tuple(int(row) for row in np.flatnonzero(small))


def _rounding(whole: Array, labels: Sequence[str]) -> Array:
    """What rounding may leave (m,) of rows of J (m, n) that are zero."""
    names, sizes = np.array([constraint_of(one) for one in labels]), np.linalg.norm(whole, axis=1)
    return NOTHING * np.array([sizes[names == name].max() for name in names])


def constraint_of(label: str) -> str:
    """The name of the constraint that a row is of."""
    return label.split(".")[0]


def idle(closure: ca.Function, labels: Sequence[str], free: NDArray[np.bool_]) -> list[str]:
    """The rows, by label (m,), that hold nothing which is ``free`` (n,) to move and are no part of
    a constraint that does. A part that is driven by time or by imposed motion cannot give way, so
    that it is one of them whatever the others hold."""
    slope = closure.jac_sparsity(1, 1)
    entries = list(zip(*slope.get_triplet(), strict=True))
    held = {int(row) for row, column in entries if free[column]}
    driven = {int(row) for row, column in entries if not free[column]}
    driven |= {int(row) for row in closure.jac_sparsity(0, 3).row()}
    holding = {constraint_of(labels[row]) for row in held}
    return [
        label
        for i, label in enumerate(labels)
        if i not in held and (i in driven or constraint_of(label) not in holding)
    ]
