"""Whether a number varies by amounts or by factors."""

from pathlib import Path

import numpy as np
import pytest
from fleets import write_fits

from symhyb.fleet.members import Member, members_of
from symhyb.fleet.scales import factors_of, units_in
from symhyb.tasks.outcome import read_outcomes

COVARIANCE = np.diag([0.01, 1e-4]) ** 2


def members(folder: Path, seed: int, factors: bool) -> tuple[Member, ...]:
    chance = np.random.default_rng(seed)
    spread = 0.4 * chance.standard_normal(100)
    first = np.exp(spread) if factors else 3 + spread
    values = np.column_stack([first, 0.001 * chance.standard_normal(100)])
    write_fits(folder, values, COVARIANCE, [{}] * 100, names=("k", "d"))
    return members_of(read_outcomes(folder))


def test_what_varies_by_factors_is_seen(tmp_path: Path) -> None:
    everyone, none = [True] * 100, np.zeros(0)
    (tmp_path / "a").mkdir()
    assert factors_of(members(tmp_path / "a", 0, True), none, everyone) == (True, False)
    (tmp_path / "b").mkdir()
    assert factors_of(members(tmp_path / "b", 1, False), none, everyone) == (False, False)


def test_logarithms_have_relative_errors(tmp_path: Path) -> None:
    found = members(tmp_path, 0, True)
    unit = units_in(found, (True, False), np.zeros(0))[3]
    value = found[3].fits[0].values[0]
    assert unit.y[0, 0] == pytest.approx(np.log(value))
    assert np.sqrt(unit.s[0, 0, 0]) == pytest.approx(0.01 / value)
