"""Slopes of steps by collocation: of linear rates their exponential; calm where they are stiff."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm

from symhyb.numeric.kernels.collocation import AT_ONCE, collocated

Array = NDArray[np.float64]
LOBATTO = np.array([[2, -4, 2], [2, 5, -1], [2, 8, 2]]) / 12


def exact(rates: Array, h: float, positions: int) -> Array:
    """Slopes (X, X + C) after ``h`` s of a system with constant slopes ``rates`` (m, X + C)."""
    m, width = rates.shape
    whole = np.zeros((width, width))
    whole[:positions, positions : 2 * positions] = np.eye(positions)
    whole[positions : positions + m] = rates
    return np.asarray(expm(h * whole)[: positions + m])


def stepped(slopes: Sequence[Array], h: Array, positions: int) -> Array:
    """The same slopes (S, X, X + C) from those at the three nodes of each step, (S, m, X + C)."""
    nodes = np.concatenate([one.swapaxes(1, 2) for one in slopes])
    where = np.arange(len(nodes)).reshape(3, -1).T
    return collocated(nodes, np.ascontiguousarray(where), h, positions).swapaxes(1, 2)


def test_constant_slopes_give_their_exponential_to_fourth_order() -> None:
    rates = np.random.default_rng(1).standard_normal((3, 5 + 2))  # two places, an inner state
    steps = np.array([0.4, 0.2])
    made = stepped([np.stack([rates, rates])] * 3, steps, 2)
    errors = [np.abs(one - exact(rates, h, 2)).max() for one, h in zip(made, steps, strict=True)]
    assert errors[0] < 2e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5, abs=0.4)


def test_slopes_that_change_within_a_step_are_followed_to_fourth_order() -> None:
    """δv' = −c(t) δv with c = 1 + t: δv = exp(−t − t²/2)."""
    errors = []
    for h in (0.1, 0.05):
        nodes = [np.array([[[0.0, -1 - t]]]) for t in (0.0, h / 2, h)]
        (made,) = stepped(nodes, np.array([h]), 1)
        errors.append(abs(made[1, 1] - np.exp(-h - h**2 / 2)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5, abs=0.5)


def test_what_is_stiff_dies_within_a_step() -> None:
    (made,) = stepped([np.array([[[0.0, -1e8]]])] * 3, np.array([0.01]), 1)
    assert made[1, 1] == pytest.approx(0, abs=1e-5)
    assert made[0] == pytest.approx([1, 0], abs=1e-5)


def test_a_step_of_no_length_changes_nothing() -> None:
    rates = np.random.default_rng(2).standard_normal((1, 2, 6))
    (made,) = stepped([rates] * 3, np.zeros(1), 2)
    assert made == pytest.approx(np.eye(4, 6))


def test_steps_without_a_solution_and_diverged_ones_have_no_slopes_and_harm_no_others() -> None:
    """δv' = c δv with c = 12/(5 h) in the middle and 0 elsewhere: there 0·δv is to be what it was
    before. The third step begins where nothing is finite."""
    fine, none = np.array([0.0, -1.0]), np.array([0.0, np.inf])
    singular = 1 / (5 / 12)
    nodes = [
        np.array([[fine], [np.zeros(2)], [none]]),
        np.array([[fine], [[0.0, singular]], [none]]),
        np.array([[fine], [np.zeros(2)], [none]]),
    ]
    made = stepped(nodes, np.ones(3), 1)
    assert made[0, 1, 1] == pytest.approx(np.exp(-1), abs=2e-3)
    assert np.isnan(made[1:, 1]).any(axis=1).all()


def test_nodes_are_shared_between_steps_and_more_steps_than_go_side_by_side_are_the_same() -> None:
    """Steps that follow each other have a node in common; each is what it is alone."""
    count, chance = 2 * AT_ONCE + 5, np.random.default_rng(4)
    rates = chance.standard_normal((2 * count + 1, 6, 3))
    first = np.arange(count)
    nodes = np.stack([first, count + 1 + first, first + 1], axis=1)
    h = chance.uniform(0.01, 0.1, count)
    together = collocated(rates, nodes, h, 2)
    for i in (0, AT_ONCE - 1, AT_ONCE, count - 1):
        alone = collocated(rates[nodes[i]], np.arange(3)[None], h[i : i + 1], 2)
        np.testing.assert_array_equal(together[i], alone[0])


def test_a_small_pivot_costs_no_digits() -> None:
    """Two inner states that only exchange what they have: by themselves they have no pivot where
    h c = 1/A₁₁."""
    c, h = 6.0, 1.0
    rates = np.array([[1e-14 + c, -2 * c], [2 * c, c]])
    (made,) = stepped([rates[None]] * 3, np.array([h]), 0)
    system = np.kron(np.eye(3), np.eye(2)) - h * np.kron(LOBATTO, rates)
    right = np.tile(np.eye(2), (3, 1))
    assert made == pytest.approx(np.linalg.solve(system, right)[4:], rel=1e-12)
