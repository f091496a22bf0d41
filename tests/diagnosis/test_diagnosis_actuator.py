"""What an actuator does to an input, from recordings to the corrected model file."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from actuated import actuated, behind_play, in_steps, slewing
from law_rigs import driven
from rigs import spring_model

import symhyb as sh


@pytest.mark.slow
def test_a_shaker_that_saturates_is_named_written_and_fits(tmp_path: Path) -> None:
    def missing(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        return float(f - np.clip(f, -7.0, 7.0)), 0.0

    model, run = spring_model(), driven(missing, 1)
    diagnosis = sh.diagnose(model, run)
    assert diagnosis.verdict == "missing physics"
    assert diagnosis.sentence.startswith("The model lacks what the actuator does: f saturates at ")
    (limit,) = diagnosis.measurement
    assert (limit.channel, limit.kind, limit.unit) == ("f", "limit", "N")
    assert limit.value == pytest.approx(7.0, abs=3 * limit.sd)
    assert limit.sd < 0.1
    corrected = sh.apply(model, diagnosis.found, diagnosis.parameters, diagnosis.measurement)
    (number,) = corrected.inputs["f"].actuator
    assert (number.name, number.si) == ("limit", pytest.approx(limit.value, rel=1e-5))
    verdict = sh.judge(model, corrected, on=run)
    before, after = (
        scores.free_run_nrmse.values() for scores in (verdict.holdout.before, verdict.holdout.after)
    )
    assert before
    assert all(b < 0.2 * a for a, b in zip(before, after, strict=True) if a and b)
    sh.write_model(corrected, tmp_path / "corrected.toml")
    assert sh.read_model(tmp_path / "corrected.toml").inputs == corrected.inputs
    sh.write_report(tmp_path / "report.html", diagnosis, verdict)
    sh.write_diagnosis(tmp_path / "diagnosis.json", diagnosis, verdict)
    said = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert [(one["channel"], one["kind"]) for one in said["measurement"]] == [("f", "limit")]


@pytest.mark.slow
def test_a_lag_of_a_linear_machine_may_be_that_of_its_sensor() -> None:
    """Behind a linear machine nobody can say where it lags: neither is claimed, both are said."""

    def missing(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        return f - z, (f - z) / 0.03

    diagnosis = sh.diagnose(spring_model(), driven(missing, 1))
    assert diagnosis.verdict == "undecided"
    assert not diagnosis.measurement
    lags = {one.channel: one for one in diagnosis.alternatives if one.kind in ("lag", "sensor_lag")}
    assert lags.keys() == {"f", *(s.name for s in spring_model().sensors)}
    (number,) = lags["f"].estimates
    assert number.value == pytest.approx(0.03, abs=max(3 * number.sd, 1e-3))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("acts", "seed", "kind", "number", "said"),
    [
        (behind_play(1.0), 2, "backlash", 1.0, "f acts behind a play (backlash) of "),
        (in_steps(4.0), 2, "quantum", 4.0, "f acts in steps of "),
        (slewing(150.0), 3, "rate_limit", 150.0, "f changes by no more than "),
    ],
    ids=["backlash", "quantum", "rate limit"],
)
def test_what_an_actuator_remembers_is_named_with_its_number(
    acts: Any, seed: int, kind: str, number: float, said: str
) -> None:
    """They were an unmeasured force, the noise of an input, or a delay."""
    diagnosis = sh.diagnose(spring_model(), actuated(acts, seed))
    assert diagnosis.verdict == "missing physics"
    assert diagnosis.sentence.startswith(f"The model lacks what the actuator does: {said}")
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.classes))
    (one,) = diagnosis.measurement
    assert (one.channel, one.kind) == ("f", kind)
    assert one.value == pytest.approx(number, abs=3 * one.sd)
    assert one.sd < 0.01 * number
