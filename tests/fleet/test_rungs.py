"""Structures of a fleet: their evidence together, and the numbers of one of them."""

import json
from pathlib import Path

import numpy as np
import pytest
from fleets import NAMES, fit_content, write_fits

from symhyb.errors import InputError
from symhyb.fleet.fleet import fleet_of
from symhyb.fleet.looking_next import worth_looking
from symhyb.fleet.rungs import chosen_rung, in_structure, weighed
from symhyb.fleet.words import structure_texts
from symhyb.fleet.written import fleet_facts
from symhyb.tasks.outcome import FAILED, Outcomes, read_outcomes

COVARIANCE = np.diag([0.25, 1e-4, 1e-6])
COUNT = 12


@pytest.fixture
def outcomes(tmp_path: Path) -> Outcomes:
    """Fits of a small structure, the likeliest in two tasks of three, and of a large one, which is
    far likelier in the others."""
    chance = np.random.default_rng(0)
    values = np.array([100.0, 2.0, 1.0]) + np.array([2.0, 0.1, 0.01]) * chance.standard_normal(
        (COUNT, 3)
    )
    folder = write_fits(tmp_path, values, COVARIANCE, [{"drive": f"d{i}"} for i in range(COUNT)])
    for i, row in enumerate(values):
        file = folder / "tasks" / f"{i:064x}" / "fit.json"
        large = i % 3 == 0
        small = fit_content(row[:1] - 50, COVARIANCE[:1, :1], names=NAMES[:1])
        whole = fit_content(row, COVARIANCE)
        logs = (-40.0, 0.0) if large else (0.0, -1.0)
        structures = [
            {"name": name, "ln_evidence": ln, "probability": float(ln == 0), **content}
            for name, ln, content in zip(("small", "large"), logs, (small, whole), strict=True)
        ]
        file.write_text(json.dumps({**(whole if large else small), "structures": structures}))
    return read_outcomes(folder)


def test_evidence_is_summed_and_counted(outcomes: Outcomes) -> None:
    small, large = weighed(outcomes)
    assert (large.evidence, large.likeliest, large.recordings) == (0.0, 4, COUNT)
    assert (small.evidence, small.likeliest) == (-4 * 40 + 8, 8)
    assert large.probability == pytest.approx(1.0)
    assert structure_texts(small) == ("−152", "< 0.01", "8 of 12")
    assert chosen_rung((small, large)) == "large"


def test_numbers_are_those_of_one_structure(outcomes: Outcomes) -> None:
    fleet = fleet_of(outcomes)
    assert (fleet.structure, [one.name for one in fleet.numbers]) == ("large", list(NAMES))
    smaller = fleet_of(outcomes, structure="small")
    assert [one.name for one in smaller.numbers] == ["k"]
    assert smaller.numbers[0].mean == pytest.approx(50, abs=3)
    facts = fleet_facts(smaller)
    assert facts["structure"] == "small"
    assert [one["likeliest_in"] for one in facts["structures"]] == [8, 4]
    assert worth_looking(outcomes, structure="small") == ()


def test_what_is_not_there_is_said(outcomes: Outcomes, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'large'"):
        fleet_of(outcomes, structure="larg")
    with pytest.raises(InputError, match="compared no structures"):
        chosen_rung((), "large")
    file = tmp_path / "tasks" / f"{1:064x}" / "fit.json"
    content = json.loads(file.read_text())
    content["structures"][0]["name"] = "smaller"
    file.write_text(json.dumps(content))
    with pytest.raises(InputError, match="compared different structures"):
        weighed(read_outcomes(tmp_path))


def test_a_structure_that_cannot_be_simulated_is_a_failure_of_its_task(
    outcomes: Outcomes, tmp_path: Path
) -> None:
    file = tmp_path / "tasks" / f"{1:064x}" / "fit.json"
    content = json.loads(file.read_text())
    content["structures"][1] = {"name": "large", "ln_evidence": None, "probability": 0.0}
    file.write_text(json.dumps(content))
    found = read_outcomes(tmp_path)
    assert [one.state for one in in_structure(found, "large").tasks].count(FAILED) == 1
    small, large = weighed(found)
    assert large.evidence == -np.inf
    assert structure_texts(large)[0] == "cannot be simulated"
    assert fleet_of(found).structure == small.name
