"""Slopes of integration steps from those of the rates: the variational equation, by collocation.

    δq' = δv,   δy' = R_q δq + R_y δy + R_c θ,   y = (v, z)

is linear, so that the implicit method of Lobatto IIIC with three stages (order 4, L-stable as the
steps themselves) is one linear system of 3 m equations a step, positions eliminated. A step that
is differentiated as a whole is far longer, because it contains the second derivatives of the rates.

Many steps are solved side by side, in vector registers.
Sizes: S steps, N nodes, f positions, m speeds and inner states, X = f + m, C columns of θ.
Source: Hairer & Wanner, Solving ODEs II, IV.5 (Lobatto IIIC).
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.jit import jitted

_A = np.array([[1 / 6, -1 / 3, 1 / 6], [1 / 6, 5 / 12, -1 / 12], [1 / 6, 2 / 3, 1 / 6]])
AT_ONCE = 32  # steps side by side
PIVOT_LEAST = 0.1  # of the largest below it: less is exchanged


def collocated(slopes: Array, nodes: NDArray[np.int64], h: Array, positions: int) -> Array:
    """Slopes (S, X + C, X) of the states after steps of ``h`` (S,) s by those before them and by
    θ, column by column.

    ``slopes`` are those of the rates y' by (q, y, θ), (N, X + C, m), column by column, SI, of which
    ``nodes`` (S, 3) are at the beginning, in the middle and at the end of each step. A step whose
    equations have no solution, or along which a run has diverged, has slopes that are no numbers.
    """
    made: Array = _collocated(slopes, nodes, h, positions, _A)
    return made


@jitted
def _collocated(
    slopes: Array, nodes: NDArray[np.int64], h: Array, positions: int, factors: Array
) -> Array:  # pragma: no cover - compiled
    f, m = positions, slopes.shape[2]
    steps, width = h.size, slopes.shape[1]
    after = np.empty((steps, width, f + m))
    at_nodes = np.empty((3, width, m, AT_ONCE))
    matrix, right = np.empty((3 * m, 3 * m, AT_ONCE)), np.empty((3 * m, width, AT_ONCE))
    length = np.empty(AT_ONCE)
    for begin in range(0, steps, AT_ONCE):
        for lane in range(AT_ONCE):
            s = min(begin + lane, steps - 1)  # the last step fills what is left
            length[lane] = h[s]
            for k in range(3):
                for c in range(width):
                    for row in range(m):
                        at_nodes[k, c, row, lane] = slopes[nodes[s, k], c, row]
        _state(at_nodes, length, f, factors, matrix, right)
        _solve(matrix, right)
        for lane in range(min(AT_ONCE, steps - begin)):
            for c in range(width):
                for i in range(f):
                    moved = 0.0
                    for k in range(3):
                        moved += factors[2, k] * right[k * m + i, c, lane]
                    after[begin + lane, c, i] = length[lane] * moved + (1.0 if c == i else 0.0)
                for i in range(m):
                    after[begin + lane, c, f + i] = right[2 * m + i, c, lane]
    return after


@jitted
def _state(
    at_nodes: Array, h: Array, f: int, factors: Array, matrix: Array, right: Array
) -> None:  # pragma: no cover - compiled
    """Put the equations of the slopes of y at the three stages into ``matrix`` (3 m, 3 m, lanes)
    and ``right`` (3 m, X + C, lanes), from those ``at_nodes`` (3, X + C, m, lanes)."""
    _, width, m, lanes = at_nodes.shape
    for i in range(3):
        one, two, three = factors[i, 0], factors[i, 1], factors[i, 2]
        for row in range(m):
            at = i * m + row
            for c in range(width):
                own = f <= c < f + m  # of y itself: they are unknown along the step
                begins = 1.0 if c == f + row else 0.0
                for lane in range(lanes):
                    total = one * at_nodes[0, c, row, lane] + two * at_nodes[1, c, row, lane]
                    total += three * at_nodes[2, c, row, lane]
                    right[at, c, lane] = begins if own else h[lane] * total
            for k in range(3):
                by_one, by_two, by_three = (
                    one * factors[0, k],
                    two * factors[1, k],
                    three * factors[2, k],
                )
                for c in range(m):
                    same = 1.0 if at == k * m + c else 0.0
                    for lane in range(lanes):
                        total = factors[i, k] * at_nodes[k, f + c, row, lane]
                        if c < f:
                            through = by_one * at_nodes[0, c, row, lane]
                            through += by_two * at_nodes[1, c, row, lane]
                            through += by_three * at_nodes[2, c, row, lane]
                            total += h[lane] * through
                        matrix[at, k * m + c, lane] = same - h[lane] * total


@jitted
def _solve(matrix: Array, right: Array) -> None:  # pragma: no cover - compiled
    """Put the solutions of equations (N, N, lanes) into their right sides (N, C, lanes): by
    elimination, with an exchange of rows where a pivot is small; not a number where there is
    none."""
    size, width, lanes = right.shape
    by = np.empty(lanes)
    for j in range(size):
        for lane in range(lanes if _too_small(matrix, j) else 0):
            _exchange(matrix, right, j, lane)
        for lane in range(lanes):
            by[lane] = 1.0 / matrix[j, j, lane] if matrix[j, j, lane] != 0.0 else np.nan
        for c in range(j, size):
            for lane in range(lanes):
                matrix[j, c, lane] *= by[lane]
        for c in range(width):
            for lane in range(lanes):
                right[j, c, lane] *= by[lane]
        for i in range(j + 1, size):
            if _none(matrix, i, j):
                continue
            for c in range(j + 1, size):
                for lane in range(lanes):
                    matrix[i, c, lane] -= matrix[i, j, lane] * matrix[j, c, lane]
            for c in range(width):
                for lane in range(lanes):
                    right[i, c, lane] -= matrix[i, j, lane] * right[j, c, lane]
    for j in range(size - 1, 0, -1):
        for i in range(j):
            if _none(matrix, i, j):
                continue
            for c in range(width):
                for lane in range(lanes):
                    right[i, c, lane] -= matrix[i, j, lane] * right[j, c, lane]


@jitted
def _too_small(matrix: Array, j: int) -> bool:  # pragma: no cover - compiled
    """Whether the j-th pivot of any of the steps side by side is small beside an entry below it."""
    found = 0
    for i in range(j + 1, matrix.shape[0]):
        for lane in range(matrix.shape[2]):
            found += abs(matrix[i, j, lane]) > abs(matrix[j, j, lane]) / PIVOT_LEAST
    return found > 0


@jitted
def _exchange(
    matrix: Array, right: Array, j: int, lane: int
) -> None:  # pragma: no cover - compiled
    """Exchange row j of one step's equations with that below it whose entry is largest, where its
    own is small."""
    best, largest = j, abs(matrix[j, j, lane]) / PIVOT_LEAST
    for i in range(j + 1, matrix.shape[0]):
        if abs(matrix[i, j, lane]) > largest:
            best, largest = i, abs(matrix[i, j, lane])
    if best != j:
        for part in (matrix, right):
            for c in range(part.shape[1]):
                part[j, c, lane], part[best, c, lane] = part[best, c, lane], part[j, c, lane]


@jitted
def _none(matrix: Array, i: int, j: int) -> bool:  # pragma: no cover - compiled
    """Whether an entry is zero in all steps side by side."""
    total = 0.0
    for lane in range(matrix.shape[2]):
        total += abs(matrix[i, j, lane])
    return total == 0.0
