"""PySINDy's optimisers on reduced candidates find what they find on stored ones."""

import tracemalloc
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pysindy.optimizers import FROLS, SR3, SSR, STLSQ, EnsembleOptimizer

from symhyb.correction.learning.regression import Candidates, regress, resampled
from symhyb.errors import InputError

Array = NDArray[np.float64]


def problem(rows: int, columns: int, targets: int, seed: int = 0) -> tuple[Array, Array]:
    """Columns of very different size and offset, and right-hand sides of three of them each."""
    rng = np.random.default_rng(seed)
    found = rng.standard_normal((rows, columns)) + rng.uniform(-3, 3, columns)
    found[:, 0] = 1.0
    truth = np.zeros((columns, targets))
    for target in range(targets):
        truth[rng.choice(columns, 3, replace=False), target] = [1.5, -0.9, 0.4]
    return found, found @ truth + 0.05 * rng.standard_normal((rows, targets))


def candidates_of(columns: Array, right: Array) -> Candidates:
    joined = np.column_stack([columns, right])
    names = tuple(f"c{i}" for i in range(joined.shape[1]))
    return Candidates(lambda rows: joined[rows], len(joined), names, right.shape[1])


@pytest.mark.parametrize(
    "make",
    [
        lambda: STLSQ(threshold=0.2),
        lambda: STLSQ(threshold=0.2, alpha=1e-8, unbias=False),
        lambda: STLSQ(threshold=8.0, normalize_columns=True),
        lambda: SR3(reg_weight_lam=0.02, max_iter=3000),
        lambda: SR3(reg_weight_lam=0.02, regularizer="L1", max_iter=3000),
        lambda: SSR(alpha=1e-6),
        lambda: SSR(criteria="model_residual"),
        lambda: FROLS(kappa=1e-3),
    ],
)
@pytest.mark.parametrize("shape", [(2000, 8, 1), (700, 14, 3)])
def test_an_optimiser_finds_the_same_without_the_rows(
    make: Callable[[], Any], shape: tuple[int, int, int]
) -> None:
    columns, right = problem(*shape)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        plain = make().fit(columns, right).coef_
        ours = regress(candidates_of(columns, right), make())
    assert ours.shape == plain.shape == (shape[2], shape[1])
    assert 0 < np.count_nonzero(plain) < plain.size
    assert np.array_equal(ours != 0, plain != 0)
    assert np.abs(ours - plain).max() < 1e-10 * np.abs(plain).max()


def test_a_guess_that_was_given_stays_and_none_is_left_behind() -> None:
    columns, right = problem(300, 5, 1)
    given = np.full((1, 5), 0.3)
    optimizer = SR3(reg_weight_lam=0.02, initial_guess=given, max_iter=3000)
    regress(candidates_of(columns, right), optimizer)
    assert optimizer.initial_guess is given
    bare = STLSQ(threshold=0.2)
    regress(candidates_of(columns, right), bare)
    assert bare.initial_guess is None


def test_drawn_fits_are_those_of_repeated_chunks() -> None:
    columns, right = problem(1050, 12, 2)
    ours = resampled(candidates_of(columns, right), STLSQ(threshold=0.2), 100, 4, seed=3)
    weights = np.random.default_rng(3).multinomial(11, np.full(11, 1 / 11), size=4)
    for found, weight in zip(ours, weights, strict=True):
        parts = [np.arange(100 * k, min(100 * (k + 1), 1050)) for k in range(11)]
        rows = np.concatenate([parts[k] for k in np.repeat(np.arange(11), weight)])
        plain = STLSQ(threshold=0.2).fit(columns[rows], right[rows]).coef_
        assert np.abs(found - plain).max() < 1e-10 * np.abs(plain).max()


def test_drawn_coefficients_spread_as_the_noise_says() -> None:
    """White noise: the standard deviation is σ √(AᵀA)⁻¹, and chunks do not change that."""
    rng = np.random.default_rng(11)
    columns = rng.standard_normal((4000, 3))
    right = columns @ [[1.0], [-2.0], [0.5]] + 0.3 * rng.standard_normal((4000, 1))
    drawn = resampled(candidates_of(columns, right), STLSQ(threshold=0.1), 40, 120)[:, 0]
    exact = 0.3 * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    # 120 draws of 100 chunks know a standard deviation to 10 %: three times that
    assert drawn.std(axis=0) == pytest.approx(exact, rel=0.3)


def test_a_draw_without_the_chunk_that_tells_two_candidates_apart_shares_between_them() -> None:
    columns, right = problem(400, 5, 1)
    columns[:, 4] = columns[:, 3]
    columns[300:, 4] *= 2
    candidates = candidates_of(columns, columns[:, 3:4] + 0 * right)
    found = resampled(candidates, STLSQ(threshold=0.1), 100, 12)[:, 0]
    reported = np.abs(found - [0, 0, 0, 1, 0]).max(axis=1) < 1e-9
    shared = np.abs(found - [0, 0, 0, 0.5, 0.5]).max(axis=1) < 1e-9
    weights = np.random.default_rng(0).multinomial(4, np.full(4, 1 / 4), size=12)
    assert np.array_equal(reported, (weights[:, 3] > 0) & (weights[:, 3] < 4))
    assert np.array_equal(shared, weights[:, 3] == 0)


def test_alike_columns_keep_the_coefficients_that_normal_equations_lose() -> None:
    """Powers of a signal with mean 3 and deviation 0.5, nothing thresholded away."""
    q = 3 + 0.5 * np.random.default_rng(4).standard_normal(3000)
    columns = np.stack([q**k for k in range(11)]).T
    columns /= np.linalg.norm(columns, axis=0)
    right = columns.sum(axis=1, keepdims=True)
    normal = np.linalg.solve(columns.T @ columns, columns.T @ right)
    ours = regress(candidates_of(columns, right), STLSQ(threshold=0.0, alpha=1e-12))
    assert np.abs(normal - 1).max() > 0.3
    assert np.abs(ours - 1).max() < 1e-5


def test_no_candidate_matrix_is_stored() -> None:
    t = np.linspace(0, 100, 40_000)
    wave = np.sin(t) + np.sin(2.7 * t) + np.cos(0.3 * t * np.sqrt(t))

    def evaluate(rows: slice) -> Array:
        x = wave[rows]
        return np.stack([*(np.cos(k * x) for k in range(40)), 3 * np.cos(5 * x) + 1e-3 * x]).T

    candidates = Candidates(evaluate, t.size, tuple(f"cos {k}x" for k in range(41)))
    regress(candidates, STLSQ(threshold=0.1))  # what is imported and kept once does not count
    tracemalloc.start()
    found = regress(candidates, STLSQ(threshold=0.1))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert np.flatnonzero(found[0]).tolist() == [5]
    assert peak < 0.35 * t.size * 40 * 8  # a block of 2¹⁷ numbers and its copies; 13 MB in all


@pytest.mark.parametrize(
    "optimizer",
    [
        SR3(trimming_fraction=0.1),
        EnsembleOptimizer(STLSQ(), bagging=True, n_models=3),
    ],
)
def test_an_optimiser_that_picks_rows_is_refused(optimizer: Any) -> None:
    columns, right = problem(100, 4, 1)
    with pytest.raises(InputError, match=r"picks rows .* draw chunks with 'resampled' instead"):
        regress(candidates_of(columns, right), optimizer)


def test_candidates_that_are_one_are_named() -> None:
    columns, right = problem(100, 4, 1)
    columns[:, 3] = -0.5 * columns[:, 2]
    with pytest.raises(InputError, match=r"^candidate 'c3' is -0.5 × 'c2' in every row; leave one"):
        regress(candidates_of(columns, right), STLSQ())


def test_too_few_rows_are_refused() -> None:
    with pytest.raises(InputError, match=r"^6 rows cannot tell 8 candidates apart"):
        regress(candidates_of(*problem(6, 8, 1)), STLSQ())


@pytest.mark.parametrize("chunk", [0, -3, 51, 1000])
def test_a_chunk_that_cannot_be_drawn_is_refused(chunk: int) -> None:
    with pytest.raises(InputError, match="100 rows do not hold two of them; give between 1 and 50"):
        resampled(candidates_of(*problem(100, 4, 1)), STLSQ(), chunk, 3)


def test_a_hole_in_a_signal_is_reported_with_its_row() -> None:
    columns, right = problem(100, 4, 1)
    columns[77, 1] = np.nan
    for work in (
        lambda given: regress(given, STLSQ()),
        lambda given: resampled(given, STLSQ(), 10, 3),
    ):
        with pytest.raises(InputError, match=r"^'c1' is nan in row 77; leave out rows"):
            work(candidates_of(columns, right))
