"""Groups of peers that scatter by more, or less, than others: how much, and who deviates there."""

from pathlib import Path

import numpy as np
import pytest
from fleets import write_fits

from symhyb.fleet.fleet import Fleet, fleet_of
from symhyb.fleet.uneven import population_of_scales
from symhyb.tasks.outcome import read_outcomes

MOTIONS, MOUNTS, EACH = 6, 10, 4
GROUPS = MOTIONS * MOUNTS
COVARIANCE = np.diag([0.1, 0.002, 0.0005]) ** 2
SPREAD = np.array([1.0, 0.02, 0.005])


def drawn_squares(seed: int, at: np.ndarray, before: float) -> tuple[np.ndarray, np.ndarray]:
    """Q and ν of groups whose scales are drawn around ``at``, known as from ``before`` samples."""
    chance = np.random.default_rng(seed)
    freedom = np.full(at.size, 12.0)
    scale = at / (chance.chisquare(before, at.size) / before) if before < np.inf else at
    return scale * chance.chisquare(freedom), freedom


def test_groups_that_do_not_differ_are_even() -> None:
    none = np.zeros((200, 0))
    found = [population_of_scales(*drawn_squares(i, np.ones(200), np.inf), none) for i in range(8)]
    assert min(float(before.min()) for _, before in found) > 30
    assert sum(np.isinf(before).all() for _, before in found) >= 2


def test_the_population_of_scales_is_found() -> None:
    at, before = population_of_scales(
        *drawn_squares(0, np.full(2000, 0.5), 8.0), np.zeros((2000, 0))
    )
    assert at[0] == pytest.approx(0.5, rel=0.1)
    assert before[0] == pytest.approx(8.0, rel=0.2)


def test_what_groupings_explain_is_no_scatter_of_scales() -> None:
    effects = np.repeat(np.eye(3), 40, axis=0)[:, 1:]
    true = np.repeat([0.2, 1.0, 5.0], 40)
    square, freedom = drawn_squares(1, true, 30.0)
    at, before = population_of_scales(square, freedom, effects)
    assert at == pytest.approx(true, rel=0.3)
    assert before.min() > 12
    assert population_of_scales(square, freedom, np.zeros((120, 0)))[1].max() < 3


def test_groups_that_hardly_scatter_do_not_spoil_the_others() -> None:
    none = np.zeros((200, 0))
    square, freedom = drawn_squares(2, np.ones(200), 5.0)
    at, before = population_of_scales(square, freedom, none)
    square[::10] *= 1e-4
    quiet = population_of_scales(square, freedom, none)
    assert quiet[0].min() > at.min() / 2
    assert quiet[1].min() > before.min() / 2


def test_too_few_groups_are_even() -> None:
    at, before = population_of_scales(np.array([1.0, 9.0]), np.array([9.0, 9.0]), np.zeros((2, 0)))
    assert (at.tolist(), before.tolist()) == ([1.0, 1.0], [np.inf, np.inf])


def fleet(folder: Path, seed: int, odd: dict[int, float]) -> Fleet:
    """Units that were recorded by motion and mount; a unit that is ``odd`` is off by so many
    spreads of its own group."""
    chance = np.random.default_rng(seed)
    motion = np.repeat(np.arange(MOTIONS), MOUNTS * EACH)
    mount = np.tile(np.repeat(np.arange(MOUNTS), EACH), MOTIONS)
    scale = np.exp(0.5 * motion - 1.25) * np.repeat(np.exp(0.2 * chance.normal(size=GROUPS)), EACH)
    off = chance.normal(size=(motion.size, 3))
    for at, by in odd.items():
        off[at, 1] = by
    values = np.array([100.0, 2.0, 1.0]) + scale[:, None] * SPREAD * off
    said = [{"motion": f"a{i}", "mount": f"b{j}"} for i, j in zip(motion, mount, strict=True)]
    write_fits(folder, values, COVARIANCE, said)
    return fleet_of(read_outcomes(folder), among=["motion", "mount"])


def test_a_group_that_scatters_widely_is_not_full_of_odd_units(tmp_path: Path) -> None:
    assert len(fleet(tmp_path, 0, {}).deviating) <= 1  # of 240


def test_a_unit_of_a_quiet_group_is_named_by_what_differs_there(tmp_path: Path) -> None:
    found = fleet(tmp_path, 7, {5: 8.0, 230: 8.0})
    reasons = {one.name: one.reason for one in found.deviating}
    assert set(reasons) == {"r5.csv", "r230.csv"}
    assert all(one is not None and one.names == ("d",) for one in reasons.values())
