"""A force of the stretch that no listed law is becomes a curve: in the file, output and report."""

import json
from pathlib import Path

import numpy as np
import pytest

import symhyb as sh
from tests.pushed import pushed_model, resisted


def held(x: float) -> float:
    """A spring that saturates at 3 N."""
    return 3.0 * float(np.tanh(x / 0.2))


@pytest.mark.thorough
def test_a_spring_that_saturates_is_found_as_a_curve(tmp_path: Path) -> None:
    model, run = pushed_model(), resisted(2, lambda x, v: held(x))
    diagnosis = sh.diagnose(model, run)
    assert diagnosis.verdict == "missing physics"
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.options) == ("curve", (("over", "stretch"),))
    assert not diagnosis.classes
    assert "no law by name being clearly better" in diagnosis.sentence
    for one in found.estimates:
        assert one.at is not None
        assert abs(one.value - held(one.at)) < 4 * one.sd
    corrected = sh.apply(model, diagnosis.found)
    verdict = sh.judge(model, corrected, on=run)
    before, after = (
        scores.free_run_nrmse.values() for scores in (verdict.train.before, verdict.train.after)
    )
    assert all(b < 0.2 * a for a, b in zip(before, after, strict=True) if a and b)
    sh.write_model(corrected, tmp_path / "corrected.toml")
    again = sh.read_model(tmp_path / "corrected.toml").elements[-1]
    assert again.curve == found.element.curve
    sh.write_report(tmp_path / "report.html", diagnosis, verdict)
    sh.write_diagnosis(tmp_path / "diagnosis.json", diagnosis, verdict)
    (told,) = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))["found"]
    assert told["options"] == {"over": "stretch"}
    numbers = told["parameters"].values()
    assert [one["at"] for one in numbers] == [one.at for one in found.estimates]
    assert {one["at_unit"] for one in numbers} == {"m"}
