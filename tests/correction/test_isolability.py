"""What candidates can imitate of an effect, also where their columns are alike or unusable."""

import numpy as np
import pytest

from symhyb.correction.advice.isolability import computable, imitated
from symhyb.discrepancy.fitting.normal import shortest_solution

RANDOM = np.random.default_rng(4)
COLUMNS = RANDOM.standard_normal((200, 3)) * [1.0, 1e6, 1e-9]  # units of their own


def test_the_rest_is_that_of_least_squares() -> None:
    effect = np.array([0.0, 0.0, 2e9])
    rest, values = imitated(COLUMNS.T @ COLUMNS, effect, [0, 1])
    target = COLUMNS @ effect
    fitted, (left,), *_ = np.linalg.lstsq(COLUMNS[:, :2], target, rcond=None)
    assert rest == pytest.approx(left, rel=1e-9)
    assert values == pytest.approx(fitted, rel=1e-9)


def test_columns_that_are_the_same_share_what_they_imitate() -> None:
    joined = np.column_stack([COLUMNS, 5 * COLUMNS[:, 0]])
    rest, values = imitated(joined.T @ joined, np.array([1.0, 0.0, 0.0, 0.0]), [0, 3])
    assert rest == pytest.approx(0.0, abs=1e-9 * 200)
    assert values == pytest.approx([0.5, 0.1])


@pytest.mark.parametrize("bad", [np.nan, np.inf, 0.0])
def test_a_column_that_says_nothing_imitates_nothing(bad: float) -> None:
    gram = np.zeros((4, 4))
    gram[:3, :3] = COLUMNS.T @ COLUMNS
    gram[3], gram[:, 3] = bad, bad
    clean = computable(gram)
    effect = np.array([0.0, 0.0, 2e9, 0.0])
    rest, values = imitated(clean, effect, [0, 1, 3])
    alone, others = imitated(clean[:3, :3], effect[:3], [0, 1])
    assert rest == pytest.approx(alone)
    assert values == pytest.approx([*others, 0.0])


def test_nothing_imitates_nothing() -> None:
    gram = COLUMNS.T @ COLUMNS
    effect = np.array([3.0, 0.0, 0.0])
    rest, values = imitated(gram, effect, [])
    assert rest == pytest.approx(9 * gram[0, 0])
    assert values.size == 0
    assert shortest_solution(np.zeros((2, 2)), np.zeros(2)) == pytest.approx([0.0, 0.0])
