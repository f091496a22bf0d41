"""Slopes of integration steps from those of the rates: the variational equation, by collocation.

    δq' = δv,   δy' = R_q δq + R_y δy + R_c θ,   y = (v, z)

is linear, so that the implicit method of Lobatto IIIC with three stages (order 4, L-stable as the
steps themselves) is one linear system of 3 m equations a step, positions eliminated. A step that
is differentiated as a whole is far longer, because it contains the second derivatives of the rates.

Sizes: S steps, f positions, m speeds and inner states, X = f + m, C columns of θ.
Source: Hairer & Wanner, Solving ODEs II, IV.5 (Lobatto IIIC).
"""

from collections.abc import Sequence

import numpy as np

from symhyb.numeric.kernels.buffers import Array

_A = np.array([[1 / 6, -1 / 3, 1 / 6], [1 / 6, 5 / 12, -1 / 12], [1 / 6, 2 / 3, 1 / 6]])


def collocated(slopes: Sequence[Array], h: Array, positions: int) -> Array:
    """Slopes (S, X, X + C) of the states after steps of ``h`` (S,) s by those before them and by θ.

    ``slopes`` are those of the rates y' by (q, y, θ), (S, m, X + C), at the beginning, in the
    middle and at the end of the steps, SI. A step whose equations have no solution, or along which
    a run has diverged, has slopes that are no numbers.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return _collocated(slopes, h, positions)


def _collocated(slopes: Sequence[Array], h: Array, positions: int) -> Array:
    f, (steps, m, width) = positions, slopes[0].shape
    states = f + m
    h = h[:, None, None]
    matrix = np.empty((steps, 3 * m, 3 * m))
    right = np.zeros((steps, 3 * m, width))
    for i in range(3):
        rows = slice(i * m, (i + 1) * m)
        total = h * sum(_A[i, j] * slopes[j] for j in range(3))
        right[:, rows, :f], right[:, rows, states:] = total[..., :f], total[..., states:]
        right[:, rows, f:states] = np.eye(m)
        for k in range(3):
            block = -h * _A[i, k] * slopes[k][..., f:states]
            block[..., :f] -= h**2 * sum(_A[i, j] * _A[j, k] * slopes[j][..., :f] for j in range(3))
            matrix[:, rows, k * m : (k + 1) * m] = block
    matrix += np.eye(3 * m)
    stages = _solved(matrix, right)
    after = np.empty((steps, states, width))
    after[:, f:] = stages[:, 2 * m :]
    after[:, :f] = h * sum(_A[2, k] * stages[:, k * m : k * m + f] for k in range(3))
    after[:, :f, :f] += np.eye(f)
    return after


def _solved(matrix: Array, right: Array) -> Array:
    """The solutions (S, 3 m, C) of equations; not a number where there is none."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        able = np.linalg.slogdet(matrix)[0] != 0
        found = np.full_like(right, np.nan)
        found[able] = np.linalg.solve(matrix[able], right[able])
        return found
