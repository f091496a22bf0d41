"""Units that are compared with their peers alone: those that share some groupings."""

from pathlib import Path

import numpy as np
import pytest
from fleets import write_fits

from symhyb.errors import InputError
from symhyb.fleet.begun import begun
from symhyb.fleet.fleet import fleet_of
from symhyb.fleet.means import Unit
from symhyb.fleet.written import fleet_facts
from symhyb.tasks.outcome import read_outcomes

COVARIANCE = np.diag([0.04, 1e-4, 1e-6])
GROUPS, EACH = 6, 6


def folder_of(folder: Path, odd: float = 6.0) -> Path:
    """Six mounts whose stiffness differs by tens, and one unit that is ``odd`` in its mount but
    between the others."""
    chance = np.random.default_rng(1)
    mount = np.repeat(np.arange(GROUPS), EACH)
    values = np.array([100.0, 2.0, 1.0]) + np.array([0.5, 0.05, 0.003]) * chance.standard_normal(
        (GROUPS * EACH, 3)
    )
    values[:, 0] += 10.0 * mount
    values[8, 0] += odd
    said = [{"mount": f"m{which}", "run": str(i)} for i, which in enumerate(mount)]
    return write_fits(folder, values, COVARIANCE, said)


def test_a_unit_is_named_among_its_peers(tmp_path: Path) -> None:
    outcomes = read_outcomes(folder_of(tmp_path))
    assert fleet_of(outcomes).deviating == ()
    fleet = fleet_of(outcomes, among=["mount"])
    (one,) = fleet.deviating
    assert one.name == "r8.csv"
    assert one.reason is not None
    assert one.reason.names == ("k",)
    own = [float(unit.values[0]) for unit in fleet.units[EACH : 2 * EACH]]
    others = own[:2] + own[3:]
    assert one.reason.off[0].by == pytest.approx(own[2] - np.mean(others), abs=0.1)
    stiffness = fleet.numbers[0]
    assert stiffness.mean == pytest.approx(125, abs=1)
    assert stiffness.spread == pytest.approx(0.5, rel=0.5)
    assert stiffness.slopes == ()
    assert fleet_facts(fleet)["among"] == ["mount"]


def test_peers_and_conditions_go_together(tmp_path: Path) -> None:
    outcomes = read_outcomes(folder_of(tmp_path))
    fleet = fleet_of(outcomes, conditions=["run"], among=["mount"])
    assert [one.condition for one in fleet.numbers[0].slopes] == ["run"]
    assert [one.name for one in fleet.deviating] == ["r8.csv"]


def test_too_few_peers_are_refused(tmp_path: Path) -> None:
    outcomes = read_outcomes(folder_of(tmp_path))
    with pytest.raises(InputError, match=r"1 units with '0'.*and 35 more"):
        fleet_of(outcomes, among=["run"])
    with pytest.raises(InputError, match="did you mean 'mount'"):
        fleet_of(outcomes, among=["mounts"])


def test_a_condition_that_is_the_same_in_each_group_has_no_slope(tmp_path: Path) -> None:
    values = np.tile([100.0, 2.0, 1.0], (12, 1)) + np.random.default_rng(0).normal(0, 0.1, (12, 3))
    said = [{"mount": str(i % 3), "kind": f"k{i % 3}"} for i in range(12)]
    outcomes = read_outcomes(write_fits(tmp_path, values, COVARIANCE, said))
    with pytest.raises(InputError, match="do not vary within the groups of peers"):
        fleet_of(outcomes, "", ["mount"], ["kind"])


def test_few_peers_are_begun_with_but_for_those_that_are_odd() -> None:
    chance = np.random.default_rng(2)
    peers = np.vstack([np.eye(19), -np.ones(19)])[np.repeat(np.arange(20), 3)]
    values = chance.standard_normal((60, 5))
    odd = list(range(1, 30, 3))
    values[odd, 0] += 20.0
    error = 1e-6 * np.eye(5)[None]
    units = [
        Unit(y[None], error, np.concatenate([[1.0], x])[None])
        for y, x in zip(values, peers, strict=True)
    ]
    left = np.exp(0.3 * chance.standard_normal(60))
    kept = begun(units, left)
    assert not kept[odd].any()
    assert np.delete(kept, odd).mean() > 0.8
