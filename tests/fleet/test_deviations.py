"""Units that deviate: which, by which numbers, and how seldom one is named that does not."""

import numpy as np
import pytest
from fleets import drawn

from symhyb.fleet.deviations import Deviation, judged, shifted
from symhyb.fleet.means import Unit

MEAN = np.array([1.0, 2.0, 3.0])
BETWEEN = np.diag([0.02, 0.03, 0.05]) ** 2
ERROR = np.diag([0.01, 0.01, 0.01]) ** 2
FREEDOM = 500.0


def moved(units: list[Unit], at: int, by: list[float]) -> None:
    units[at] = Unit(units[at].y + np.array(by), units[at].s, units[at].x)


def noise(seed: int, count: int) -> np.ndarray:
    return np.exp(0.05 * np.random.default_rng(seed).standard_normal(count))


def test_units_that_are_off_are_named_with_the_number_that_is() -> None:
    units = drawn(0, 80, MEAN, BETWEEN, ERROR)
    moved(units, 7, [0.2, 0, 0])
    moved(units, 31, [0, 0, -0.5])
    moved(units, 60, [0, 0.3, 0.4])
    found = judged(units, noise(0, 80), np.full(80, FREEDOM))
    assert found.tested
    named = [at for at in range(80) if found.deviates(at)]
    assert {7, 31, 60} <= set(named)
    assert len(named) <= 4
    reasons = {at: shifted(found.deviations[at]) for at in (7, 31, 60)}
    assert {at: one.numbers for at, one in reasons.items()} == {7: (0,), 31: (2,), 60: (1, 2)}
    assert abs(reasons[7].by[0] - 0.2) < 4 * reasons[7].sd[0] < 0.12
    assert not found.kept[[7, 31, 60]].any()
    spread = np.sqrt(np.diag(found.population.between))
    assert (abs(spread / np.sqrt(np.diag(BETWEEN)) - 1) < 0.3).all()  # they do not widen it


def test_a_third_of_the_units_does_not_hide_itself() -> None:
    units = drawn(1, 60, MEAN, BETWEEN, ERROR)
    for at in range(18):
        moved(units, at, [0.3, 0, 0])
    found = judged(units, noise(1, 60), np.full(60, FREEDOM))
    assert [at for at in range(60) if found.deviates(at)][:18] == list(range(18))
    assert found.kept.sum() >= 40


def test_what_the_fit_leaves_says_that_the_structure_does_not_hold() -> None:
    units, left = drawn(2, 60, MEAN, BETWEEN, ERROR), noise(2, 60)
    left[11] *= 4
    found = judged(units, left, np.full(60, FREEDOM))
    assert [at for at in range(60) if found.structure(at)] == [11]
    left[11] /= 4
    left[12] = 1.08 * np.exp(np.log(left).mean())
    quiet = judged(units, np.where(np.arange(60) == 12, left, 1.0), np.full(60, 1e9))
    assert not quiet.structure(12)  # no more than how well the noise is known


def test_what_a_fit_leaves_is_compared_among_peers() -> None:
    units, left = drawn(2, 60, MEAN, BETWEEN, ERROR), noise(2, 60)
    peers = np.where(np.arange(60) < 20, 1.0, -1.0)
    grouped = [
        Unit(one.y, one.s, np.array([[1.0, code]])) for one, code in zip(units, peers, strict=True)
    ]
    left[:20] *= 50  # a motion that the structure follows badly in all units alike
    left[[7, 40]] *= 4
    found = judged(grouped, left, np.full(60, FREEDOM))
    assert [at for at in range(60) if found.structure(at)] == [7, 40]
    assert left[[7, 40]] / found.usual[[7, 40]] == pytest.approx(4.0, rel=0.2)


def test_few_are_named_where_all_are_alike() -> None:
    fleets, named = 15, 0
    for seed in range(fleets):
        units = drawn(100 + seed, 50, MEAN, BETWEEN, ERROR)
        found = judged(units, noise(seed, 50), np.full(50, FREEDOM))
        named += sum(found.deviates(at) or found.structure(at) for at in range(50))
    assert named <= 3  # one of twenty fleets names any, and then often one


def test_two_numbers_that_explain_it_as_well_are_both_named() -> None:
    ridge = np.array([[100.0, -99.9], [-99.9, 100.0]])  # only their sum is known
    shift = np.array([3.0, 2.0])
    one = Deviation(shift, ridge, float(shift @ np.linalg.solve(ridge, shift)), 1e-6)
    found = shifted(one)
    assert len(found.numbers) == 1
    assert found.rivals == ((1 - found.numbers[0],),)


def test_a_few_units_are_not_judged() -> None:
    found = judged(drawn(5, 4, MEAN, BETWEEN, ERROR), np.ones(4), np.full(4, FREEDOM))
    assert not found.tested
    assert not any(found.deviates(at) or found.structure(at) for at in range(4))
