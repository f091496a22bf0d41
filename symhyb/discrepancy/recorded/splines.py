"""Quintic splines for least squares: their values and derivatives, and the rows of sensors on them.

Sizes: N samples, n coordinates, m sensors, B coefficients a coordinate.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import SuperLU

from symhyb.numeric.kernels.buffers import Array

DEGREE = 5
SWING_MOST = np.pi / 2  # RMS speed over that from sample to sample: a sine of two samples a period


def spline_basis(t: Array, spacing: float) -> tuple[sparse.csr_array, ...]:
    """Sparse (N, B) matrices of the values, first and second derivatives of quintic B-splines at
    ``t`` (N,), with knots about ``spacing`` apart, s."""
    pieces = max(round((t[-1] - t[0]) / spacing), 1)
    inner = np.linspace(t[0], t[-1], pieces + 1)
    knots = np.concatenate([np.full(DEGREE, t[0]), inner, np.full(DEGREE, t[-1])])
    result = [sparse.csr_array(BSpline.design_matrix(t, knots, DEGREE))]
    lowered = sparse.eye_array(knots.size - DEGREE - 1, format="csr")
    for degree in (DEGREE, DEGREE - 1):
        # c'_i = degree (c_{i+1} − c_i) / (τ_{i+degree+1} − τ_{i+1})
        rise = degree / (knots[degree + 1 : -1] - knots[1 : -degree - 1])
        count = rise.size
        differ = sparse.diags_array([-rise, rise], offsets=[0, 1], shape=(count, count + 1))
        lowered = sparse.csr_array(differ @ lowered)
        knots = knots[1:-1]
        result.append(sparse.csr_array(BSpline.design_matrix(t, knots, degree - 1) @ lowered))
    return tuple(result)


def design(
    basis: Sequence[sparse.csr_array],
    slopes: Sequence[Array],
    used: NDArray[np.bool_],
    weights: Array,
) -> sparse.csr_array:
    """Rows of the measurements that are ``used`` (N, m), by their ``slopes`` (N, m, n) by q, v and
    a, times ``weights`` (m,), one over the sensor's unit."""
    first, values = _compact(basis)
    n, size = slopes[0].shape[2], basis[0].shape[1]
    data, columns, counts = [], [], []
    for j in range(used.shape[1]):
        keep = np.flatnonzero(used[:, j])
        leans = np.stack([slope[keep, j] * weights[j] for slope in slopes])  # (3, K, n)
        acting = np.flatnonzero(leans.any(axis=(0, 1)))
        entries = sum(
            lean[:, acting, None] * own[keep, None] for lean, own in zip(leans, values, strict=True)
        )
        places = (acting * size)[:, None] + np.arange(DEGREE + 1)
        data.append(np.ravel(entries))
        columns.append(np.ravel(first[keep, None, None] + places))
        counts.append(np.full(keep.size, places.size))
    ends = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    entries = np.concatenate(data), np.concatenate(columns), ends
    return sparse.csr_array(entries, shape=(ends.size - 1, n * size))


def _compact(basis: Sequence[sparse.csr_array]) -> tuple[NDArray[np.int64], list[Array]]:
    """The first of the coefficients (N,) that each row of the ``basis`` depends on, and its
    factors (N, 6) of that and the next five."""
    rows = [np.repeat(np.arange(b.shape[0]), np.diff(b.indptr)) for b in basis]
    least = [np.minimum.reduceat(b.indices, b.indptr[:-1]) for b in basis]  # no row is empty
    first = np.minimum.reduce([*least, np.full(least[0].size, basis[0].shape[1] - DEGREE - 1)])
    values = [np.zeros((first.size, DEGREE + 1)) for _ in basis]
    for b, row, own in zip(basis, rows, values, strict=True):
        own[row, b.indices - first[row]] = b.data
    return first, values


def ridge(normal: sparse.csc_array) -> sparse.csc_array:
    """A hair of stiffness, so that what no sensor sees (the place, from an accelerometer alone)
    stays at its start."""
    return sparse.csc_array(sparse.diags_array(1e-9 + 1e-12 * normal.diagonal()))


def bands(basis: Sequence[sparse.csr_array], solver: SuperLU, n: int) -> tuple[Array, Array, Array]:
    """Typical sd of q, v, a (n,) each for unit noise, SI, from rows in the middle of the record, by
    the factored normal equations."""
    total, size = basis[0].shape
    rows = np.unique(np.linspace(total * 0.3, total * 0.7, 15).astype(int))
    bands = []
    for b in basis:
        chosen = b[rows].toarray()
        spread = np.empty(n)
        for i in range(n):
            right = np.zeros((n * size, rows.size))
            right[i * size : (i + 1) * size] = chosen.T
            variance = np.sum(right * solver.solve(right), axis=0)
            spread[i] = np.sqrt(np.median(variance))
        bands.append(spread)
    return bands[0], bands[1], bands[2]


def swings(t: Array, q: Array, v: Array) -> bool:
    """Whether a spline through few samples swings between them: its speeds (N, n) are then larger
    than places (N, n) at the times (N,) can show. SI."""
    seen = np.sqrt(np.mean(np.square(np.diff(q, axis=0) / np.diff(t)[:, None]), axis=0))
    return bool(np.any(np.sqrt(np.mean(v**2, axis=0)) > SWING_MOST * seen))
