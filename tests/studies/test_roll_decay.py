"""The roll decay of a tanker model: what the study says, and that unseen data choose nothing."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fakes import friction, verdict

from symhyb.discrepancy.results import Alternative, Diagnosis, Estimate
from symhyb.model.types import On
from symhyb.report.contract import to_json
from symhyb.study.expected import Expected, check, read_expected
from symhyb.study.file import read_study
from symhyb.study.run import carry_out, run_study

STUDY = Path(__file__).parents[2] / "studies" / "roll_decay"
Public = Callable[..., Path]


@pytest.mark.parametrize("name", ["at_rest", "at_speed"])
def test_the_study_is_valid(name: str) -> None:
    study = read_study(STUDY / name / "study.toml")
    assert (len(study.train), len(study.holdout)) == (1, 1)
    assert read_expected(STUDY / name / "expected.json").source


def test_what_cannot_be_ruled_out_may_be_expected_too() -> None:
    reported = Alternative(
        None, "damper", (Estimate("d", 0.21, 0.01, "N*s/m", "damping"),), 1.0, place=On("q")
    )
    content = to_json(replace(friction(), alternatives=(reported,)), verdict())
    (one,) = check(Expected(alternatives={"q.damping": (0.2, 0.1)}), content)
    assert one.passed
    assert one.subject == "alternative q.damping"
    for wanted in ({"q.damping": (0.1, 0.1)}, {"q.drag": (0.2, 0.1)}, {"q.coulomb": (0.49, 0.1)}):
        (one,) = check(Expected(alternatives=wanted), content)
        assert not one.passed


@pytest.mark.thorough
def test_at_rest_drag_and_a_second_loss_that_may_be_linear_or_dry(
    tmp_path: Path, public_file: Public
) -> None:
    public_file("kvlcc2_rolldecay", "model_test_21338.csv")
    result = run_study(STUDY / "at_rest" / "study.toml", tmp_path)
    assert len(result.checks) == 5
    assert [one for one in result.checks if not one.passed] == []
    assert "cannot tell which" in result.diagnosis.sentence
    (changed,) = result.diagnosis.parameters
    assert abs(changed.value / 6.055 - 1) < 2e-3  # the reference fits of both runs


@pytest.mark.slow
def test_at_speed_damping_is_mostly_linear_and_unseen_data_choose_nothing(
    tmp_path: Path, public_file: Public, monkeypatch: pytest.MonkeyPatch
) -> None:
    public_file("kvlcc2_rolldecay", "model_test_21340.csv")
    result = run_study(STUDY / "at_speed" / "study.toml", tmp_path)
    assert len(result.checks) == 3
    assert [one for one in result.checks if not one.passed] == []
    numbers = {n.term: n.value for found in result.diagnosis.found for n in found.estimates}
    fastest = 0.15 * 2.46  # rad/s, at the largest amplitude, where drag counts most
    assert numbers["damping"] > 8 / (3 * np.pi) * numbers["drag"] * fastest

    (unseen,) = result.holdout
    random = np.random.default_rng(3)
    noise = {"roll": 0.1 * random.standard_normal(unseen.t.size)}
    given = (result.train, (replace(unseen, sensors=noise),))
    monkeypatch.setattr("symhyb.study.run.read_all", lambda study, model: given)
    blind = carry_out(read_study(STUDY / "at_speed" / "study.toml"))

    def reported(diagnosis: Diagnosis) -> dict[str, object]:  # the share alone is of unseen data
        return {one.element.kind: (one.element.place, one.estimates) for one in diagnosis.found}

    assert len(reported(blind.diagnosis)) == len(blind.diagnosis.found) >= 3
    assert reported(blind.diagnosis) == reported(result.diagnosis)
