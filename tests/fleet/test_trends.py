"""Units whose numbers change otherwise than those of the others."""

import numpy as np
from fleets import drawn, write_fits

from symhyb.fleet.fleet import fleet_of
from symhyb.fleet.means import Unit
from symhyb.fleet.population import population_of
from symhyb.fleet.trends import own_trends
from symhyb.fleet.words import reason_sentence
from symhyb.tasks.outcome import read_outcomes

SLOPE = np.array([0.5, 0.0])


def units_of(seed: int, recordings: int = 5) -> list[Unit]:
    within = 0.02**2 * np.eye(2)
    error = 0.01**2 * np.eye(2)
    return drawn(seed, 40, np.ones(2), 0.1**2 * np.eye(2), error, recordings, within, SLOPE)


def test_a_unit_that_wears_faster_is_found() -> None:
    units = units_of(0)
    change = np.outer(units[7].x[:, 1], [0.0, 0.3])
    units[7] = Unit(units[7].y + change, units[7].s, units[7].x)
    found = own_trends(units, population_of(units))
    assert [i for i, one in enumerate(found) if one is not None] == [7]
    trend = found[7]
    assert trend is not None
    (slope,) = trend.slopes
    assert (slope.number, slope.at) == (1, 0)
    assert abs(slope.value - 0.3) < 4 * slope.sd


def test_few_are_found_where_all_change_alike() -> None:
    named = 0
    for seed in range(10):
        units = units_of(10 + seed)
        named += sum(one is not None for one in own_trends(units, population_of(units)))
    assert named <= 3


def test_two_recordings_show_no_trend() -> None:
    units = units_of(1, recordings=2)
    assert own_trends(units, population_of(units)) == [None] * 40


def test_a_fleet_says_which_unit_changes_with_what(tmp_path) -> None:  # type: ignore[no-untyped-def]
    chance = np.random.default_rng(2)
    rows, groups = [], []
    for unit in range(20):
        own = np.array([100.0, 2.0, 1.0]) + np.array([2.0, 0.05, 0.003]) * chance.normal(size=3)
        for hours in (0.0, 500.0, 1000.0, 1500.0):
            wear = 4e-4 if unit == 4 else 0.0
            noise = np.array([0.5, 0.01, 0.0005]) * chance.normal(size=3)
            rows.append(own + noise + [0.0, wear * (hours - 750), 0.0])
            groups.append({"drive": f"d{unit}", "hours": str(hours)})
    covariance = np.diag([0.5, 0.01, 0.0005]) ** 2
    folder = write_fits(tmp_path, np.array(rows), covariance, groups)
    fleet = fleet_of(read_outcomes(folder), "drive", ["hours"])
    (one,) = fleet.deviating
    assert (one.name, one.reason.kind) == ("d4", "trend")  # type: ignore[union-attr]
    assert "d changes with hours by 0." in reason_sentence(one.reason)  # type: ignore[arg-type]
    assert "more than the others do" in reason_sentence(one.reason)  # type: ignore[arg-type]
