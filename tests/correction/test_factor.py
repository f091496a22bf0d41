"""Rows reduced to a factor: the same least squares, however alike the columns are."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.correction.learning.factor import Blocks, factor_of, pieces_of
from symhyb.errors import InputError

Array = NDArray[np.float64]


def in_blocks(joined: Array, size: int) -> Blocks:
    return lambda: (joined[i : i + size] for i in range(0, len(joined), size))


def names_of(joined: Array) -> list[str]:
    return [f"c{i}" for i in range(joined.shape[1] - 1)] + ["right"]


def reported(joined: Array, names: Sequence[str] = ()) -> list[str]:
    factor = factor_of(in_blocks(joined, 16), names or names_of(joined))
    return [problem.text for problem in factor.problems()]


def apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).max() / np.abs(other).max())


def powers(rows: int, degree: int = 10) -> tuple[Array, Array]:
    """Powers of a signal of mean 3 and deviation 0.5, and a right-hand side whose coefficients,
    of the columns at unit length, are all 1; the last of [columns, right]."""
    q = 3 + 0.5 * np.random.default_rng(4).standard_normal(rows)
    columns = np.stack([q**k for k in range(degree + 1)]).T
    length = np.linalg.norm(columns, axis=0)
    right = np.sum(columns / length, axis=1)
    return np.column_stack([columns, right]), 1 / length


@pytest.mark.parametrize(("rows", "columns", "block"), [(300, 1, 7), (500, 12, 64), (90, 40, 200)])
def test_the_factor_keeps_all_products_of_the_rows(rows: int, columns: int, block: int) -> None:
    rng = np.random.default_rng(rows)
    joined = rng.standard_normal((rows, columns + 1))
    factor = factor_of(in_blocks(joined, block), names_of(joined))
    assert factor.by_gram
    assert factor.rows == rows
    assert apart(factor.triangle.T @ factor.triangle, joined.T @ joined) < 1e-13
    exact = np.linalg.lstsq(joined[:, :-1], joined[:, -1:], rcond=None)[0]
    assert apart(factor.least_squares(), exact) < 1e-11
    fast = factor.back_substituted()
    assert fast is not None
    assert apart(fast, exact) < 1e-11


def test_what_no_candidate_explains_keeps_its_size() -> None:
    joined = np.random.default_rng(1).standard_normal((200, 6))
    factor = factor_of(in_blocks(joined, 30), names_of(joined))
    left = factor.right - factor.columns @ factor.least_squares()
    exact = np.linalg.lstsq(joined[:, :-1], joined[:, -1], rcond=None)[1][0]
    assert np.sum(left**2) == pytest.approx(exact, rel=1e-12)


def test_an_offset_a_million_times_the_signal_is_no_reason_to_factor() -> None:
    rng = np.random.default_rng(2)
    signal = rng.standard_normal((400, 3))
    right = signal @ [2.0, -1.0, 0.5] + 0.1 * rng.standard_normal(400)
    joined = np.column_stack([np.ones(400), signal + 1e6, right])
    factor = factor_of(in_blocks(joined, 50), names_of(joined))
    assert factor.by_gram
    centred = signal - signal.mean(axis=0)
    exact = np.linalg.lstsq(centred, right - right.mean(), rcond=None)[0]
    assert factor.least_squares()[1:, 0] == pytest.approx(exact, rel=1e-8)


def test_powers_of_a_signal_with_an_offset_defeat_normal_equations_but_not_the_factor() -> None:
    joined, truth = powers(4000)
    columns, right = joined[:, :-1], joined[:, -1]
    scale = np.linalg.norm(columns, axis=0)
    unit = columns / scale
    normal = np.linalg.solve(unit.T @ unit, unit.T @ right) / scale
    factor = factor_of(in_blocks(joined, 500), names_of(joined))
    assert not factor.by_gram
    assert not factor.problems()
    assert np.abs(normal / truth - 1).max() > 0.3
    # κ of these columns at unit length is 5e8: ε κ is 1e-7 of the coefficients
    assert np.abs(factor.least_squares()[:, 0] / truth - 1).max() < 1e-5


def test_a_right_hand_side_that_is_met_almost_exactly_is_factored() -> None:
    """The Gram matrix would lose what is left of it."""
    rng = np.random.default_rng(3)
    columns = rng.standard_normal((300, 4))
    joined = np.column_stack([columns, columns.sum(axis=1) + 1e-7 * rng.standard_normal(300)])
    factor = factor_of(in_blocks(joined, 40), names_of(joined))
    assert not factor.by_gram
    exact = np.linalg.norm(joined[:, -1] - columns @ np.linalg.lstsq(columns, joined[:, -1])[0])
    assert abs(factor.triangle[-1, -1]) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("alike", [False, True])
def test_drawn_blocks_are_the_rows_repeated(alike: bool) -> None:
    joined, _ = powers(1200)
    rng = np.random.default_rng(5)
    if not alike:
        joined = rng.standard_normal((1200, 6)) + np.arange(6)
    pieces = pieces_of(in_blocks(joined, 100), names_of(joined))
    assert pieces.factor.by_gram is not alike
    weights = rng.multinomial(12, np.full(12, 1 / 12), size=3)
    for weight, factor in zip(weights, pieces.drawn(weights.astype(float)), strict=True):
        which = np.repeat(np.arange(12), weight)
        rows = np.concatenate([joined[100 * k : 100 * (k + 1)] for k in which])
        assert factor.rows == len(rows)
        scale = np.linalg.norm(rows, axis=0)
        gram = (factor.triangle / scale).T @ (factor.triangle / scale)
        assert np.abs(gram - (rows / scale).T @ (rows / scale)).max() < 1e-12
        columns = rows[:, :-1] / scale[:-1]
        exact = np.linalg.lstsq(columns, rows[:, -1:], rcond=None)[0] / scale[:-1, None]
        assert apart(factor.least_squares(), exact) < (1e-5 if alike else 1e-11)


def test_a_draw_that_loses_a_column_still_has_its_products() -> None:
    rng = np.random.default_rng(6)
    joined = rng.standard_normal((60, 4))
    joined[:40, 1] = 0.0  # shows in the last block alone
    pieces = pieces_of(in_blocks(joined, 20), names_of(joined))
    (factor,) = pieces.drawn(np.array([[2.0, 1.0, 0.0]]))
    rows = np.concatenate([joined[:20], joined[:20], joined[20:40]])
    assert np.abs(factor.triangle.T @ factor.triangle - rows.T @ rows).max() < 1e-12
    assert factor.back_substituted() is None
    assert not factor.columns[:, 1].any()
    exact = np.linalg.lstsq(rows[:, [0, 2]], rows[:, 3], rcond=None)[0]
    assert factor.least_squares()[[0, 2], 0] == pytest.approx(exact, rel=1e-9)


def test_candidates_that_depend_on_each_other_are_named() -> None:
    rng = np.random.default_rng(7)
    x = rng.standard_normal((50, 3))
    joined = np.column_stack([x, 2 * x[:, 1], x[:, 0] - x[:, 2], 0 * x[:, 0], x[:, 0]])
    names = ["a", "b", "c", "twice", "difference", "nothing", "right"]
    assert reported(joined, names) == [
        "candidate 'twice' is 2 × 'b' in every row; leave one of them out",
        "candidate 'difference' is 1 × 'a' + -1 × 'c' in every row; leave one of them out",
        "candidate 'nothing' is zero in every row; leave it out",
    ]
    with pytest.raises(InputError, match="'twice' is 2 × 'b'"):
        pieces_of(in_blocks(joined, 10), names)


def test_fewer_rows_than_candidates_are_refused() -> None:
    (text,) = reported(np.random.default_rng(8).standard_normal((5, 9)))
    assert text.startswith("5 rows cannot tell 8 candidates apart")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_found(bad: float) -> None:
    joined = np.random.default_rng(9).standard_normal((50, 4))
    joined[33, 2] = bad
    with pytest.raises(InputError, match=f"'c2' is {bad:g} in row 33; leave out rows"):
        factor_of(in_blocks(joined, 8), names_of(joined))


def test_no_rows_are_refused() -> None:
    with pytest.raises(InputError, match="there are no rows"):
        factor_of(lambda: [np.empty((0, 3))], ["a", "b", "right"])
