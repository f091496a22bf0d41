"""Peers that agree far more closely than a fit is accurate: who deviates, and who does not."""

from pathlib import Path

import numpy as np
import pytest
from fleets import drawn, write_fits

from symhyb.fleet.begun import begun, of_majorities
from symhyb.fleet.deviations import deviation
from symhyb.fleet.fleet import Fleet, fleet_of
from symhyb.fleet.means import Unit
from symhyb.fleet.population import population_of, with_spreads_of
from symhyb.fleet.words import fleet_notes
from symhyb.tasks.outcome import read_outcomes

GROUPS, EACH, GAIN = 16, 4, 0.162975


def agreeing(seed: int = 0) -> np.ndarray:
    """A gain in groups of four, which agree to a millionth: by more in some groups than in
    others, with a straggler here and there."""
    chance = np.random.default_rng(seed)
    within = np.repeat(10 ** chance.uniform(-7, -5, GROUPS), EACH)
    level = np.repeat(1e-6 * chance.standard_normal(GROUPS), EACH)
    return GAIN * (1 + level + within * chance.standard_t(2, GROUPS * EACH))


def fleet(folder: Path, gains: np.ndarray) -> Fleet:
    said = [{"mount": f"m{i // EACH}"} for i in range(len(gains))]
    write_fits(folder, gains[:, None], np.array([[1e-16]]), said, names=("g",))
    return fleet_of(read_outcomes(folder), among=["mount"])


@pytest.mark.parametrize("seed", range(4))
def test_a_unit_that_is_3_percent_off_is_named_alone(tmp_path: Path, seed: int) -> None:
    gains = agreeing(seed)
    odd = [2, 21, 35, 40, 59]
    gains[odd] *= 1.03
    found = fleet(tmp_path, gains)
    assert sorted(one.name for one in found.deviating) == sorted(f"r{i}.csv" for i in odd)
    for one in found.deviating:
        assert one.reason is not None
        assert one.reason.off[0].part == pytest.approx(0.03, abs=1e-4)
    assert found.numbers[0].spread < 1e-4 * GAIN


def test_what_the_numerics_of_fits_may_err_by_is_no_deviation(tmp_path: Path) -> None:
    gains = agreeing()
    gains[7] *= 1.002
    assert fleet(tmp_path, gains).deviating == ()


def test_of_peers_half_of_whom_deviate_nobody_is_named(tmp_path: Path) -> None:
    gains = agreeing()
    gains[[4, 6]] *= 1.03
    gains[30] *= 1.03
    found = fleet(tmp_path, gains)
    assert [one.name for one in found.deviating] == ["r30.csv"]
    assert found.disputed == ("r4.csv", "r5.csv", "r6.csv", "r7.csv")
    assert any("no more than half of these peers are alike" in one for one in fleet_notes(found))


def test_a_unit_is_left_out_of_what_is_expected_of_it() -> None:
    units = drawn(0, 12, np.array([1.0, 2.0]), np.diag([0.01, 0.04]), 0.01 * np.eye(2), 2)
    units = [
        Unit(one.y, one.s, one.x, np.eye(3)[[i % 3, (i + 1) % 3]]) for i, one in enumerate(units)
    ]
    found = population_of(units)
    without = with_spreads_of(found, units[1:])
    inside, outside = deviation(found, units[0], True, 9), deviation(without, units[0], False, 9)
    assert inside.shift == pytest.approx(outside.shift)
    assert inside.covariance == pytest.approx(outside.covariance)
    assert inside.probability == pytest.approx(outside.probability)


def test_of_the_only_one_of_its_group_nothing_is_known() -> None:
    units = drawn(0, 9, np.array([1.0, 2.0]), np.diag([0.01, 0.04]), 0.01 * np.eye(2))
    alone = [Unit(one.y, one.s, one.x, np.eye(2)[[int(i == 0)]]) for i, one in enumerate(units)]
    found = population_of(alone)
    assert deviation(found, alone[0], True, 7).probability == 1.0
    assert deviation(found, alone[1], True, 7).covariance[0, 0] < 0.1


def test_a_group_without_a_majority_begins_with_those_next_to_its_median() -> None:
    groups = np.repeat(np.eye(2, dtype=bool), 4, axis=0)
    near = np.array([3.0, 1.0, 2.0, 4.0, 0.0, 0.0, 0.0, 0.0])
    kept = np.array([False, True, False, False, True, True, True, False])
    found, disputed = of_majorities(kept, near, groups)
    assert found.tolist() == [True, True, False, True, True, True, True, False]
    assert disputed.tolist() == 4 * [True] + 4 * [False]


def test_one_wide_group_does_not_bring_odd_ones_into_the_others() -> None:
    values = np.ones(12)
    values[:4] += [-0.3, -0.1, 0.1, 0.3]
    values[4] = 1.5
    units = [
        Unit(np.array([[y]]), np.full((1, 1, 1), 1e-12), np.ones((1, 1)), np.eye(3)[[i // 4]])
        for i, y in enumerate(values)
    ]
    kept = begun(units, np.exp(0.1 * np.random.default_rng(0).standard_normal(12)))
    assert not kept[4]
    assert kept[5:].all()
    assert kept[:4].sum() >= 3
