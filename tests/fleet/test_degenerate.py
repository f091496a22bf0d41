"""Fleets at the edge: nothing varies, errors that are one, or numbers that nobody determined."""

from pathlib import Path

import numpy as np
import pytest
from fleets import write_fits

from symhyb.fleet.fleet import Fleet, fleet_of
from symhyb.fleet.words import fleet_notes, spread_text
from symhyb.fleet.written import fleet_facts
from symhyb.tasks.outcome import read_outcomes

COUNT = 30


def fleet(folder: Path, values: np.ndarray, covariance: np.ndarray) -> Fleet:
    write_fits(folder, values, covariance, [{}] * len(values))
    return fleet_of(read_outcomes(folder))


@pytest.mark.parametrize("level", [0.0, 1.0])
def test_units_that_are_the_same_have_no_spread(tmp_path: Path, level: float) -> None:
    found = fleet(tmp_path, np.full((COUNT, 3), level), np.diag([1.0, 0.01, 1e-4]))
    assert found.deviating == ()
    assert [one.spread for one in found.numbers] == pytest.approx([0, 0, 0], abs=0.2)
    assert fleet_facts(found)["tested"]
    assert all(spread_text(one) for one in found.numbers)


def test_numbers_whose_errors_are_one_do_not_end_it(tmp_path: Path) -> None:
    chance = np.random.default_rng(0)
    error = chance.normal(size=COUNT)
    values = np.column_stack([10 + error, 10 + error, 1 + 0.1 * chance.normal(size=COUNT)])
    together = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.01]])
    found = fleet(tmp_path, values, together)
    assert abs(found.numbers[0].mean - 10) < 1
    assert len(found.deviating) <= 1


def test_a_number_that_no_recording_determines_is_known_from_none(tmp_path: Path) -> None:
    chance = np.random.default_rng(1)
    values = np.array([10.0, 1.0, 1.0]) + 0.1 * chance.normal(size=(COUNT, 3))
    covariance = np.diag([1e-4, 1e30, 1e-4])
    found = fleet(tmp_path, values, covariance)
    assert found.numbers[1].sd > 1.0
    assert found.numbers[0].spread == pytest.approx(0.1, rel=0.4)
    assert found.deviating == ()
    assert list(fleet_notes(found)) == []
