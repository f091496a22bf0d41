"""A force of the rate that no listed law is becomes a curve: in the file, output and report."""

import json
from pathlib import Path

import numpy as np
import pytest
from law_rigs import driven
from rigs import spring_model

import symhyb as sh


def digressive(v: float) -> float:
    return float(np.sign(v) * 0.5 * ((1 + abs(v) / 0.03) ** 0.35 - 1))


@pytest.mark.slow
def test_a_digressive_damper_is_found_as_a_curve(tmp_path: Path) -> None:
    model = spring_model()
    run = driven(lambda x, v, z, f: (digressive(v), 0.0), seed=6)
    diagnosis = sh.diagnose(model, run)
    assert diagnosis.verdict == "missing physics"
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.options) == ("curve", (("over", "rate"),))
    assert not diagnosis.classes
    assert "none of the listed laws being as good" in diagnosis.sentence
    for one in found.estimates:
        assert one.at is not None
        assert abs(one.value - digressive(one.at)) < 4 * one.sd + 0.02
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
    assert told["options"] == {"over": "rate"}
    numbers = told["parameters"].values()
    assert [one["at"] for one in numbers] == [one.at for one in found.estimates]
    assert {one["at_unit"] for one in numbers} == {"m/s"}
