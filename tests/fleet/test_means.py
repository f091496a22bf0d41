"""Means of groups of peers and slopes, against least squares written out."""

import numpy as np
import pytest
from scipy.linalg import block_diag

from symhyb.fleet.means import Unit, batches_of, layout_of, means_of

K = 2


def units_of(groups: list[list[int]], count: int, conditions: int) -> list[Unit]:
    """Units with recordings in such groups, of so many in all."""
    chance = np.random.default_rng(0)
    found = []
    for own in groups:
        root = chance.normal(size=(len(own), K, K))
        s = root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(K)
        x = np.column_stack([np.ones(len(own)), chance.normal(size=(len(own), conditions))])
        found.append(Unit(chance.normal(size=(len(own), K)), s, x, np.eye(count)[own]))
    return found


@pytest.mark.parametrize("conditions", [0, 2])
@pytest.mark.parametrize(
    "groups",
    [
        [[0], [0], [1], [1], [2], [2], [2]],  # every group by itself
        [[0, 1], [1], [1, 0], [2, 3, 3], [3], [2]],  # two pairs that share units
        [[0], [0, 0], [0], [0, 0, 0]],
    ],
)
def test_means_and_slopes_are_those_of_least_squares(
    groups: list[list[int]], conditions: int
) -> None:
    count = 1 + max(max(own) for own in groups)
    units = units_of(groups, count, conditions)
    layout = layout_of(units)
    batches = list(batches_of(units, layout))
    found = means_of(batches, [np.linalg.inv(one.s) for one in batches], layout)

    each = [np.kron(np.column_stack([one.peers, one.x[:, 1:]]), np.eye(K)) for one in units]
    x, y = np.concatenate(each), np.concatenate([one.y.ravel() for one in units])
    weight = np.linalg.inv(block_diag(*(s for one in units for s in one.s)))
    gram = x.T @ weight @ x
    covariance = np.linalg.inv(gram)
    beta = covariance @ x.T @ weight @ y
    assert found.logdet == pytest.approx(np.linalg.slogdet(gram)[1])
    for one, columns in zip(units, each, strict=True):
        (batch,) = batches_of([one], layout)
        assert found.rest(batch)[0] == pytest.approx(one.y.ravel() - columns @ beta)
        assert found.error(batch)[0] == pytest.approx(columns @ covariance @ columns.T)
    to_mean = np.kron(
        np.block(
            [
                [np.full((1, count), 1 / count), np.zeros((1, conditions))],
                [np.zeros((conditions, count)), np.eye(conditions)],
            ]
        ),
        np.eye(K),
    )
    overall, of_overall = found.overall(K)
    assert overall.ravel() == pytest.approx(to_mean @ beta)
    assert of_overall == pytest.approx(to_mean @ covariance @ to_mean.T)
