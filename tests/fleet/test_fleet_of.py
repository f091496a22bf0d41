"""A fleet from a folder of fits: numbers, units, reasons, and what is written of them."""

import csv
import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fleets import NAMES, write_fits

from symhyb.errors import InputError
from symhyb.fleet.fleet import Fleet, fleet_of
from symhyb.fleet.words import fleet_notes, reason_sentence, slope_sentences
from symhyb.fleet.written import fleet_facts, write_picture, write_units
from symhyb.tasks.outcome import read_outcomes

COUNT = 60
COVARIANCE = np.diag([0.5, 0.01, 0.0005]) ** 2
SLOPE = 0.02


def folder_of(folder: Path, **changes: object) -> Path:
    chance = np.random.default_rng(3)
    values = np.array([100.0, 2.0, 1.0]) + np.array([2.0, 0.05, 0.003]) * chance.standard_normal(
        (COUNT, 3)
    )
    warm = chance.uniform(10, 40, COUNT)
    values[:, 1] -= SLOPE * (warm - 25)
    values[17, 2] += 0.03
    values[40] = [80.0, 3.0, 1.02]
    left = np.exp(0.02 * chance.standard_normal(COUNT))
    left[40] = 5.0
    groups = [{"unit": f"u{i}", "warm": f"{x:.2f}"} for i, x in enumerate(warm)]
    return write_fits(folder, values, COVARIANCE, groups, left, **changes)  # type: ignore[arg-type]


@pytest.fixture
def fleet(tmp_path: Path) -> Fleet:
    return fleet_of(read_outcomes(folder_of(tmp_path)), "unit", ["warm"])


def test_the_units_that_deviate_are_named_with_the_reason(fleet: Fleet) -> None:
    reasons = {one.name: one.reason for one in fleet.deviating}
    assert set(reasons) == {"u17", "u40"}
    gain, structure = reasons["u17"], reasons["u40"]
    assert gain is not None
    assert structure is not None
    assert (gain.kind, [one.name for one in gain.off]) == ("numbers", ["laser.gain"])
    assert gain.off[0].part == pytest.approx(0.03, abs=0.01)
    assert structure.kind == "structure"
    assert structure.times == pytest.approx(5.0, rel=0.05)
    assert "laser.gain is 0.0" in reason_sentence(gain)
    assert "above what the others have under the same conditions" in reason_sentence(gain)
    assert "something acts there that the others do not have" in reason_sentence(structure)


def test_mean_spread_and_slope_are_those_of_the_others(fleet: Fleet) -> None:
    stiffness, damping, _ = fleet.numbers
    assert abs(stiffness.mean - 100) < 4 * stiffness.sd
    assert stiffness.spread == pytest.approx(2.0, rel=0.3)
    (slope,) = damping.slopes
    assert abs(slope.value + SLOPE) < 4 * slope.sd
    assert slope.probability < 1e-9
    assert stiffness.slopes[0].probability > 1e-3
    (said,) = slope_sentences(fleet)
    assert said.startswith("d changes with warm: by −0.")


def test_own_values_are_drawn_towards_the_others(fleet: Fleet) -> None:
    for one in fleet.units:
        if one.reason is None:
            assert (one.shrunken_sd <= one.sd * 1.0001).all()
    wide = max(fleet.units[:17], key=lambda one: abs(one.values[0] - 100))
    assert abs(wide.shrunken[0] - 100) < abs(wide.values[0] - 100)


def test_a_recording_that_shows_nothing_is_said(tmp_path: Path) -> None:
    folder = folder_of(tmp_path)
    file = folder / "tasks" / f"{5:064x}" / "fit.json"
    content = json.loads(file.read_text())
    content["covariance"] = (COVARIANCE * 400).tolist()
    file.write_text(json.dumps(content))
    fleet = fleet_of(read_outcomes(folder), "unit", ["warm"])
    assert [one.name for one in fleet.units if one.adds_nothing] == ["u5"]
    assert any("adds nothing: of u5" in note for note in fleet_notes(fleet))


def test_facts_table_and_picture_say_the_same(fleet: Fleet, tmp_path: Path) -> None:
    facts = json.loads(json.dumps(fleet_facts(fleet), allow_nan=False))
    assert sorted(facts["deviating"]) == ["u17", "u40"]
    assert [one["name"] for one in facts["numbers"]] == list(NAMES)
    write_units(fleet, tmp_path / "units.csv")
    rows = list(csv.DictReader((tmp_path / "units.csv").read_text("utf-8").splitlines()))
    assert len(rows) == COUNT
    assert [row["unit"] for row in rows if row["deviates"]] == ["u17", "u40"]
    assert rows[17]["numbers"] == "laser.gain"
    assert float(rows[3]["k [N/m]"]) == facts["units"][3]["numbers"]["k"]["value"]
    write_picture(fleet, tmp_path / "fleet.svg")
    ElementTree.parse(tmp_path / "fleet.svg")
    write_picture(fleet, tmp_path / "fleet.png")
    assert (tmp_path / "fleet.png").read_bytes().startswith(b"\x89PNG")


def test_what_cannot_be_a_fleet_is_refused(tmp_path: Path) -> None:
    values = np.tile([100.0, 2.0, 1.0], (4, 1))
    groups = [{"warm": "20", "a": str(i), "b": str(2 * i)} for i in range(4)]
    folder = write_fits(tmp_path, values, COVARIANCE, groups, states={2: "", 3: "broken"})
    outcomes = read_outcomes(folder)
    with pytest.raises(InputError, match="2 units are no fleet"):
        fleet_of(outcomes)
    folder = tmp_path / "four"
    folder.mkdir()
    outcomes = read_outcomes(write_fits(folder, values, COVARIANCE, groups))
    with pytest.raises(InputError, match="is the same in all recordings"):
        fleet_of(outcomes, "", ["warm"])
    with pytest.raises(InputError, match="follow from each other"):
        fleet_of(outcomes, "", ["a", "b"])
    fleet = fleet_of(outcomes)
    assert not fleet.tested
    assert any("too few to say which of them deviate" in note for note in fleet_notes(fleet))
