"""Numbers that one cause scales, compared by one factor."""

from pathlib import Path

import numpy as np
import pytest
from fleets import NAMES, write_fits

from symhyb.errors import InputError
from symhyb.fleet.fleet import fleet_of
from symhyb.fleet.looking_next import worth_looking
from symhyb.fleet.members import Member
from symhyb.fleet.together import scaled_together
from symhyb.fleet.words import fleet_notes
from symhyb.fleet.written import fleet_facts
from symhyb.tasks.fitting import Fitted
from symhyb.tasks.outcome import read_outcomes

USUAL = np.array([100.0, 2.0, 1.0])
ALIKE = np.array([[0.25, 0.0, 0.0], [0.0, 0.04, -0.0199], [0.0, -0.0199, 0.01]])
"""Of d and the gain only 2·gain + d is known well."""


def member(name: str, values: np.ndarray, covariance: np.ndarray = ALIKE) -> Member:
    fit = Fitted(NAMES, ("N/m", "N*s/m", "1"), values, covariance, 9.0, 1.0, 1000, 2.0)
    return Member(name, (name,), (fit,), np.zeros((1, 0)))


def factor_of(members: list[Member], at: int) -> tuple[np.ndarray, np.ndarray]:
    found = scaled_together(members, {"loss": ("d", "laser.gain")})[at].fits[0]
    assert found.names == ("k", "loss")
    assert found.units == ("N/m", "1")
    return found.values, found.covariance


def test_numbers_that_are_scaled_have_that_factor() -> None:
    members = [member(f"u{i}", USUAL) for i in range(3)]
    members.append(member("odd", np.array([101.0, 3.0, 1.5])))
    values, covariance = factor_of(members, 3)
    assert values == pytest.approx([101.0, 1.5])
    assert covariance[0, 0] == pytest.approx(0.25)
    assert factor_of(members, 0)[0] == pytest.approx([100.0, 1.0])


def test_what_numbers_trade_off_is_no_factor() -> None:
    members = [member(f"u{i}", USUAL) for i in range(3)]
    members.append(member("traded", USUAL + np.array([0.0, 0.4, -0.2])))
    values, covariance = factor_of(members, 3)
    assert values[1] == pytest.approx(1.0, abs=1e-9)
    assert covariance[1, 1] < 1e-3 < ALIKE[1, 1] / USUAL[1] ** 2


def test_it_is_the_fit_with_these_ratios() -> None:
    chance = np.random.default_rng(0)
    design = chance.normal(size=(50, 3))
    measured = design @ np.array([102.0, 2.5, 1.2]) + chance.normal(size=50)
    covariance = np.linalg.inv(design.T @ design)
    free = covariance @ design.T @ measured
    members = [member(f"u{i}", USUAL, covariance) for i in range(3)]
    values, found = factor_of([*members, member("own", free, covariance)], 3)
    held = np.column_stack([design[:, 0], design[:, 1:] @ USUAL[1:]])
    assert values == pytest.approx(np.linalg.lstsq(held, measured)[0])
    assert found == pytest.approx(np.linalg.inv(held.T @ held))


def test_a_number_that_is_not_determined_says_nothing() -> None:
    members = [member(f"u{i}", USUAL) for i in range(3)]
    unknown = np.diag([0.25, 0.01, np.inf])
    values, covariance = factor_of([*members, member("u", USUAL * [1, 1.5, 9], unknown)], 3)
    assert values[1] == pytest.approx(1.5)
    assert covariance[1, 1] == pytest.approx(0.01 / 4)
    nothing = np.diag([0.25, np.inf, np.inf])
    values, covariance = factor_of([*members, member("u", USUAL * [1, 7, 9], nothing)], 3)
    assert values == pytest.approx([100.0, 1.0])
    assert np.isinf(covariance[1, 1])
    assert covariance[0, 1] == 0.0


def folder_of(folder: Path) -> Path:
    """Forty units, each with d and gain that trade off, of which one has 1.2 times both."""
    chance = np.random.default_rng(4)
    values = USUAL + chance.multivariate_normal(np.zeros(3), ALIKE, 40)
    values[7] *= [1.0, 1.2, 1.2]
    return write_fits(folder, values, ALIKE, [{"unit": f"u{i}"} for i in range(40)])


def test_a_unit_is_named_by_its_cause(tmp_path: Path) -> None:
    outcomes = read_outcomes(folder_of(tmp_path))
    together = {"loss": ("d", "laser.gain")}
    fleet = fleet_of(outcomes, "unit", together=together)
    (one,) = fleet.deviating
    assert (one.name, one.reason.names if one.reason else ()) == ("u7", ("loss",))
    assert one.reason is not None
    assert one.reason.off[0].part == pytest.approx(0.2, abs=0.05)
    assert fleet_facts(fleet)["together"] == {"loss": ["d", "laser.gain"]}
    assert "loss is one factor on d and laser.gain" in next(fleet_notes(fleet))
    (first, *_) = worth_looking(outcomes, "unit", together=together)
    assert (first.unit, first.why) == ("u7", "numbers")


def test_causes_that_cannot_be_are_refused() -> None:
    members = [member(f"u{i}", USUAL) for i in range(3)]
    wrong = {"a": ("d",), "k": ("d", "laser.gain"), "b": ("dd", "k")}
    with pytest.raises(InputError) as caught:
        scaled_together(members, wrong)
    said = str(caught.value)
    assert "--together a: needs two numbers or more, but has 1" in said
    assert "'d' is named twice" in said
    assert "'dd' was not fitted" in said
    with pytest.raises(InputError, match="'k' is the name of a number that stays"):
        scaled_together(members, {"k": ("d", "laser.gain")})
    assert scaled_together(members, {}) == tuple(members)
