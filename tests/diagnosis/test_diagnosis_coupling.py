"""A whole diagnosis of a plate that a rotor and a spring askew couple, which nobody modelled."""

from pathlib import Path

import pytest

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.model.types import Pair
from tests.correction.adequacy.test_named_coupling import CASES, PLATE, tilted


@pytest.mark.thorough
def test_a_coupling_is_named_and_the_model_follows_unseen_data(tmp_path: Path) -> None:
    by_place, by_rate, true = CASES["both"]
    seen, unseen = (tilted(seed, by_place, by_rate) for seed in (3, 4))
    model = parse_model(PLATE)
    diagnosis = sh.diagnose(model, seen)
    assert diagnosis.verdict == "missing physics"
    assert {found.element.kind for found in diagnosis.found} == true.keys()
    for found in diagnosis.found:
        assert found.element.place == Pair("a", "b")
        (number,) = found.estimates
        assert abs(number.value - true[found.element.kind]) < 3 * number.sd
    assert "On a and b the model lacks" in diagnosis.sentence
    assert not diagnosis.classes
    corrected = sh.apply(model, diagnosis.found)
    verdict = sh.judge(model, corrected, on=unseen)
    assert verdict.holdout is not None
    before, after = verdict.holdout.before, verdict.holdout.after
    for sensor in ("pos_a", "pos_b"):
        assert after.free_run_nrmse[sensor] < 0.1 * before.free_run_nrmse[sensor]  # type: ignore[operator]
    sh.write_model(corrected, tmp_path / "corrected.toml")
    again = sh.read_model(tmp_path / "corrected.toml").elements[-1]
    assert again.place == Pair("a", "b")
    sh.write_report(tmp_path / "report.html", diagnosis, verdict)
