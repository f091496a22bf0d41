"""The Kalman filter and smoother against dense Gaussian algebra on small random systems."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.stats import multivariate_normal

from symhyb.discrepancy.likelihood.filter import smooth, whiten

Array = NDArray[np.float64]
N, X, FORCES, M = 40, 2, 1, 2
COLUMNS = 3


@dataclass(frozen=True)
class System:
    """A random linear system with measurements, in the order of the filter's arguments."""

    phi: Array
    left: Array
    right: Array
    C: Array
    D: Array
    seen: NDArray[np.bool_]
    b: Array  # (N − 1, X, K)
    e: Array  # (N, M, K)
    begin: Array  # (X, K)
    P0: Array
    keep: Array
    hold: Array
    force: Array
    white: Array
    colour: Array
    place: NDArray[np.int64]


def system(seed: int, coloured: bool, missing: float = 0.2) -> System:
    """Matrices that differ from step to step; a share of the measurements is missing."""
    random = np.random.default_rng(seed)
    turn = np.array([[0.9, 0.3], [-0.3, 0.9]])
    root = random.standard_normal((X, X))
    step = random.uniform(0.5, 1.5, N - 1)
    return System(
        turn + 0.1 * random.standard_normal((N - 1, X, X)),
        0.3 * random.standard_normal((N - 1, X, FORCES)),
        0.3 * random.standard_normal((N - 1, X, FORCES)),
        random.standard_normal((N, M, X)),
        random.standard_normal((N, M, FORCES)),
        random.random((N, M)) > missing,
        0.2 * random.standard_normal((N - 1, X, COLUMNS)),
        random.standard_normal((N, M, COLUMNS)),
        random.standard_normal((X, COLUMNS)),
        root @ root.T + 0.1 * np.eye(X),
        np.exp(-step[:, None] / 4.0),
        np.exp(-np.outer(step, np.ones(M if coloured else 0)) / 7.0),
        np.array([0.6]),
        np.array([0.04, 0.3]),
        np.array([0.5, 0.2][: M if coloured else 0]),
        np.arange(M) if coloured else np.full(M, -1),
    )


@dataclass(frozen=True)
class Dense:
    """Joint covariance of all states (N·d, N·d), how measurements see them (R, N·d), what columns
    are measured less computed (R, K), where they take the states (N·d, K), and the covariance of
    the measurements (R, R)."""

    states: Array
    seen: Array
    left: Array
    taken: Array
    covariance: Array


def dense(one: System) -> Dense:
    """The same system with every state of every sample in one vector."""
    sensed = one.hold.shape[1]
    d = X + FORCES + sensed
    P = block_diag(one.P0, np.diag(one.force), np.diag(one.colour[:sensed]))
    states = np.zeros((N * d, N * d))
    states[:d, :d] = P
    mean = np.zeros((N, d, COLUMNS))
    mean[0, :X] = one.begin
    for i in range(N - 1):
        lost = np.diag(one.force * (1 - one.keep[i] ** 2))
        A = block_diag(one.phi[i], np.diag(one.keep[i]), np.diag(one.hold[i]))
        A[:X, X : X + FORCES] = one.left[i] + one.right[i] * one.keep[i]
        g = np.vstack([one.right[i], np.eye(FORCES), np.zeros((sensed, FORCES))])
        Q = g @ lost @ g.T
        Q[X + FORCES :, X + FORCES :] += np.diag(one.colour[:sensed] * (1 - one.hold[i] ** 2))
        here, there = slice(i * d, (i + 1) * d), slice((i + 1) * d, (i + 2) * d)
        states[there, : (i + 1) * d] = A @ states[here, : (i + 1) * d]
        states[: (i + 1) * d, there] = states[there, : (i + 1) * d].T
        states[there, there] = A @ states[here, here] @ A.T + Q
        mean[i + 1] = A @ mean[i]
        mean[i + 1, :X] += one.b[i]
    rows = [np.hstack([one.C[i], one.D[i], np.eye(M)[:, :sensed]]) for i in range(N)]
    kept = one.seen.ravel()
    seen = block_diag(*rows)[kept]
    taken = mean.reshape(N * d, COLUMNS)
    left = one.e.reshape(N * M, COLUMNS)[kept] - seen @ taken
    noise = np.diag(np.tile(one.white, N)[kept])
    return Dense(states, seen, left, taken, seen @ states @ seen.T + noise)


def arguments(one: System, column: int) -> tuple[Array, ...]:
    """What the smoother takes: one column, from no deviation on."""
    parts = (one.phi, one.left, one.right, one.C, one.D, one.seen)
    driven = (np.ascontiguousarray(one.b[:, :, column]), np.ascontiguousarray(one.e[:, :, column]))
    rest = (one.P0, one.keep, one.hold, one.force, one.white, one.colour, one.place)
    return (*parts, *driven, *rest)


def white_of(one: System) -> tuple[Array, float]:
    return whiten(*(getattr(one, name) for name in System.__dataclass_fields__))


CASES = pytest.mark.parametrize(
    ("seed", "coloured", "missing"),
    [(1, False, 0.0), (2, True, 0.0), (3, False, 0.3), (4, True, 0.3)],
)


@CASES
def test_the_likelihood_is_that_of_the_joint_normal_distribution(
    seed: int, coloured: bool, missing: float
) -> None:
    one = system(seed, coloured, missing)
    full, (white, logs) = dense(one), white_of(one)
    joint = multivariate_normal(np.zeros(len(full.left)), full.covariance)
    for column in range(COLUMNS):
        power = float(np.sum(white[:, :, column] ** 2))
        here = -0.5 * (logs + power + one.seen.sum() * np.log(2 * np.pi))
        assert here == pytest.approx(joint.logpdf(full.left[:, column]), rel=1e-9)


@CASES
def test_white_columns_have_the_products_of_generalized_least_squares(
    seed: int, coloured: bool, missing: float
) -> None:
    one = system(seed, coloured, missing)
    full, (white, _) = dense(one), white_of(one)
    flat = white.reshape(-1, COLUMNS)
    expected = full.left.T @ np.linalg.solve(full.covariance, full.left)
    np.testing.assert_allclose(flat.T @ flat, expected, rtol=1e-8)
    assert np.all(white[~one.seen] == 0.0)


@CASES
def test_smoothed_states_are_conditional_means_and_variances(
    seed: int, coloured: bool, missing: float
) -> None:
    one = replace(system(seed, coloured, missing), begin=np.zeros((X, COLUMNS)))
    full = dense(one)
    mean, variance, logs, chi2, *_ = smooth(*arguments(one, 1), True)
    gain = np.linalg.solve(full.covariance, full.seen @ full.states).T
    expected = full.taken[:, 1] + gain @ full.left[:, 1]
    spread = np.diag(full.states) - np.sum(gain * (full.seen @ full.states).T, axis=1)
    np.testing.assert_allclose(mean.ravel(), expected, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(variance.ravel(), spread, rtol=1e-7, atol=1e-9)
    white, there = white_of(one)
    assert (logs, chi2) == pytest.approx((there, float(np.sum(white[:, :, 1] ** 2))), rel=1e-10)


@CASES
def test_the_score_is_the_slope_of_the_likelihood(
    seed: int, coloured: bool, missing: float
) -> None:
    one = system(seed, coloured, missing)
    *_, by_force, by_white, by_colour, by_times = smooth(*arguments(one, 0), True)

    def likelihood(name: str, row: int, change: float) -> float:
        moved = getattr(one, name).copy()
        moved[row] += change
        _, _, logs, chi2, *_ = smooth(*arguments(replace(one, **{name: moved}), 0), False)
        return -0.5 * (logs + chi2)

    scores = {"force": by_force, "white": by_white, "colour": by_colour}
    for name, score in scores.items():
        for row, value in enumerate(getattr(one, name)):
            step = 1e-5 * value
            slope = likelihood(name, row, step) - likelihood(name, row, -step)
            assert score[row] == pytest.approx(slope / (2 * step), rel=1e-5, abs=1e-6)
    assert np.any(by_colour != 0) == coloured

    def remembered(name: str, change: float) -> float:
        longer = np.power(getattr(one, name), np.exp(-change))
        _, _, logs, chi2, *_ = smooth(*arguments(replace(one, **{name: longer}), 0), False)
        return -0.5 * (logs + chi2)

    for name, score in zip(("keep", "hold"), by_times, strict=True):
        slope = remembered(name, 1e-5) - remembered(name, -1e-5)
        assert score == pytest.approx(slope / 2e-5, rel=1e-5, abs=1e-6)
    assert by_times[0] != 0
    assert (by_times[1] != 0) == coloured


def test_a_force_that_forgets_at_once_has_no_slope_by_its_memory() -> None:
    one = system(6, coloured=True)
    *_, by_times = smooth(*arguments(replace(one, keep=np.zeros_like(one.keep)), 0), False)
    assert by_times[0] == 0
    assert np.isfinite(by_times[1])


def test_what_is_not_wanted_changes_no_score() -> None:
    one = system(6, coloured=True)
    full, brief = smooth(*arguments(one, 2), True), smooth(*arguments(one, 2), False)
    assert np.any(full[0] != 0)
    assert not np.any(brief[0])
    for a, b in zip(full[2:], brief[2:], strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_last_digit_does_not_depend_on_where_arrays_lie() -> None:
    one, random = system(6, coloured=True), np.random.default_rng(1)
    between, found = [], set()
    for _ in range(500):
        between.append(np.zeros(random.integers(1, 400)))
        del between[random.integers(len(between)) :: 50]
        given = [np.array(a) if isinstance(a, np.ndarray) else a for a in arguments(one, 2)]
        found.add(tuple(np.asarray(a).tobytes() for a in smooth(*given, True)))
    assert len(found) == 1
