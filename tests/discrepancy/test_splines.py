"""Rows of sensors on splines: as many entries a coordinate as a spline has, and what they say."""

import numpy as np

from symhyb.discrepancy.recorded.splines import DEGREE, design, spline_basis


def test_rows_are_the_slopes_times_the_splines_of_every_coordinate() -> None:
    draws = np.random.default_rng(3)
    t = np.sort(draws.random(200)) * 3
    basis = spline_basis(t, 0.2)
    slopes = [draws.standard_normal((200, 3, 2)) for _ in basis]
    for slope in slopes:
        slope[:, 1, 0] = 0.0  # the second sensor sees the second coordinate alone
    slopes[2][:, 0] = 0.0
    used = draws.random((200, 3)) > 0.3
    used[:, 2] = False  # the third recorded nothing
    weights = np.array([1.0, 2.0, 3.0])
    rows = design(basis, slopes, used, weights)
    size = basis[0].shape[1]
    expected = [
        np.concatenate(
            [
                sum(
                    slope[k, j, i] * weights[j] * b.toarray()[k]
                    for slope, b in zip(slopes, basis, strict=True)
                )
                for i in range(2)
            ]
        )
        for j in range(3)
        for k in np.flatnonzero(used[:, j])
    ]
    assert rows.shape == (used.sum(), 2 * size)
    assert np.abs(rows.toarray() - expected).max() < 1e-9 * np.abs(expected).max()
    count = np.diff(rows.indptr)
    assert set(count[: used[:, 0].sum()]) == {2 * (DEGREE + 1)}
    assert set(count[used[:, 0].sum() :]) == {DEGREE + 1}
