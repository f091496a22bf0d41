"""Best subsets on Gram matrices against least squares done by hand."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from symhyb.correction.search.conventions import indistinguishable
from symhyb.correction.search.selection import Problem, best_subsets, solve, without
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On

TERMS = ("constant", "stiffness", "cubic", "damping", "drag", "quadratic")


def problem(columns: np.ndarray, right: np.ndarray, positive: bool = False) -> Problem:
    count = columns.shape[1]
    joined = np.column_stack([columns, right])
    gram = joined.T @ joined
    return Problem(
        gram=gram,
        held=gram,
        hypotheses=tuple(
            Hypothesis("law", On(f"x{i}"), (TERMS[i],), (positive,)) for i in range(count)
        ),
        columns=tuple((i,) for i in range(count)),
        always=(),
        prior=np.zeros(count),
        lower=np.full(count, 0.0 if positive else -np.inf),
        upper=np.full(count, np.inf),
        least=np.zeros(count),
    )


@pytest.fixture
def data() -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(5)
    columns = random.standard_normal((400, 6)) * [1, 1e3, 1e-3, 1, 10, 1]
    right = 3 * columns[:, 1] * 1e-3 - 2 * columns[:, 4] / 10 + 0.1 * random.standard_normal(400)
    return columns, right


def test_every_size_has_the_subset_of_exhaustive_search(
    data: tuple[np.ndarray, np.ndarray],
) -> None:
    columns, right = data
    for size, subsets in enumerate(best_subsets(problem(columns, right), largest=4)):
        costs = {}
        for chosen in combinations(range(6), size):
            part = columns[:, chosen]
            left = right - part @ np.linalg.lstsq(part, right)[0] if chosen else right
            costs[chosen] = float(left @ left)
        best = min(costs, key=lambda chosen: costs[chosen])
        assert subsets[0].causes == best
        assert subsets[0].chi2 == pytest.approx(costs[best], rel=1e-9)


def test_sets_that_are_solved_side_by_side_are_those_that_are_solved_alone() -> None:
    """With priors, bounds, least sizes, equals, a column that is always in, a cause of two columns
    and one of which every recording has its own number."""
    random = np.random.default_rng(11)
    columns = random.standard_normal((300, 12)) * np.exp(random.normal(size=12))
    columns[:, 11] = 3 * columns[:, 10]
    right = columns @ random.normal(size=12) + random.standard_normal(300)
    joined, other = (
        np.column_stack([part, rest])
        for part, rest in ((columns[:200], right[:200]), (columns[200:], right[200:]))
    )
    law = [Hypothesis("law", On(f"x{i}"), (TERMS[i % 6],), (i % 3 == 0,)) for i in range(7)]
    pair = Hypothesis("law", On("y"), ("stiffness", "damping"), (False, False))
    reduced = Problem(
        gram=joined.T @ joined,
        held=other.T @ other,
        hypotheses=(*law, pair, law[0]),
        columns=(*((i,) for i in (0, 1, 2, 3, 4, 10, 11)), (5, 6), (7, 8)),
        always=(9,),
        prior=random.uniform(0, 3, 12),
        lower=np.where(np.arange(12) % 3, -np.inf, 0.0),
        upper=np.full(12, 5.0),
        least=np.full(12, 0.05),
        recordings=("a", "b"),
    )
    sizes = best_subsets(reduced, largest=4)
    for size, subsets in enumerate(sizes):
        alone = {}
        for chosen in combinations(range(9), size):
            subset = solve(reduced, chosen)
            if subset is not None and not {0, 8} <= {*chosen}:
                alone[chosen] = subset
        best = sorted(alone.values(), key=lambda one: one.chi2)[: len(subsets)]
        assert [one.causes for one in subsets] == [one.causes for one in best]
        for one, expected in zip(subsets, best, strict=True):
            assert one.values == pytest.approx(expected.values, rel=1e-9)
            assert (one.chi2, one.held) == pytest.approx((expected.chi2, expected.held), rel=1e-9)
            assert one.numbers == expected.numbers
    assert len(sizes) == 5


def test_friction_with_and_without_memory_never_act_together_at_one_place(
    data: tuple[np.ndarray, np.ndarray],
) -> None:
    here = problem(*data)
    plain, memory = (
        Hypothesis(kind, On("x"), ("coulomb",), (False,))
        for kind in ("friction", "friction_dynamic")
    )
    elsewhere = replace(memory, place=On("y"))
    pairs = {}
    for name, other in (("here", memory), ("elsewhere", elsewhere)):
        both = replace(here, hypotheses=(plain, other), columns=((1,), (4,)))
        pairs[name] = len(best_subsets(both)) - 1
    assert pairs == {"here": 1, "elsewhere": 2}


def test_the_planted_coefficients_come_back(data: tuple[np.ndarray, np.ndarray]) -> None:
    subset = solve(problem(*data), (1, 4))
    assert subset is not None
    assert subset.values == pytest.approx([3e-3, -0.2], rel=0.02)


def test_a_forbidden_sign_is_refused(data: tuple[np.ndarray, np.ndarray]) -> None:
    assert solve(problem(*data, positive=True), (1,)) is not None
    assert solve(problem(*data, positive=True), (4,)) is None


def test_columns_that_are_alike_are_refused_together_and_named_as_twins() -> None:
    random = np.random.default_rng(1)
    first = random.standard_normal(300)
    columns = np.column_stack([first, -2 * first, random.standard_normal(300)])
    reduced = problem(columns, first)
    assert solve(reduced, (0, 1)) is None
    assert indistinguishable(reduced) == ((0, 1),)
    assert solve(without(reduced, {1}), (1,)) is None


def test_a_prior_holds_a_coefficient_back() -> None:
    column = np.ones((100, 1))
    reduced = problem(column, np.ones(100))
    held = Problem(
        reduced.gram,
        reduced.held,
        reduced.hypotheses,
        reduced.columns,
        (),
        np.array([100.0]),
        reduced.lower,
        reduced.upper,
        reduced.least,
    )
    subset = solve(held, (0,))
    assert subset is not None
    assert subset.values == pytest.approx([0.5])


def test_a_coefficient_too_small_for_a_name_is_refused() -> None:
    reduced = problem(np.ones((100, 1)), np.full(100, 1e-4))
    small = Problem(
        reduced.gram,
        reduced.held,
        reduced.hypotheses,
        reduced.columns,
        (),
        reduced.prior,
        reduced.lower,
        reduced.upper,
        np.array([1e-3]),
    )
    assert solve(reduced, (0,)) is not None
    assert solve(small, (0,)) is None


def test_a_column_of_rounding_alone_is_never_chosen(data: tuple[np.ndarray, np.ndarray]) -> None:
    """Its coefficient would be 1e150 and more, whose square is no number."""
    columns, right = data
    columns = columns.copy()
    columns[:, 4] *= 1e-160
    sets = [
        subset.causes
        for sizes in best_subsets(problem(columns, right), largest=3)
        for subset in sizes
    ]
    assert sets
    assert all(4 not in causes for causes in sets)
    assert solve(problem(columns, right), (4,)) is None
