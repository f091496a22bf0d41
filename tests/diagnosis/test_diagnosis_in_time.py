"""A number that changes while the machine runs: named with its course, in the model and on the
page; and what is said where several numbers may be the one."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import symhyb as sh
from tests.changing import changing, one, staged, stepped
from tests.pushed import pushed_model


def improved(model: sh.Model, corrected: sh.Model, run: sh.Recording) -> float:
    """The error of the free run after the correction over that before."""
    train = sh.judge(model, corrected, train=[run]).train
    (before,), (after,) = (s.free_run_nrmse.values() for s in (train.before, train.after))
    assert before
    assert after
    return after / before


@pytest.mark.slow
def test_a_step_is_named_and_in_the_corrected_model(tmp_path: Path) -> None:
    model, run = pushed_model(), changing(5, stepped)
    diagnosis = sh.diagnose(model, run)
    assert diagnosis.verdict == "parameters"
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.measurement))
    (course,) = diagnosis.courses
    assert (course.parameter, course.shape, course.unit) == ("k", "step", "N/m")
    for name, true in (("before", 25.0), ("after", 22.5), ("time", 8.13)):
        number = course.number(name)
        assert abs(number.value - true) < 4 * max(number.sd, 1e-3)
    assert "k steps from" in diagnosis.sentence
    assert "it says nothing of others" in diagnosis.sentence
    assert [(c.kind, c.parameter) for c in diagnosis.classes] == [("time-varying", "k")]
    corrected = sh.apply(model, diagnosis.found, courses=diagnosis.courses)
    assert corrected.elements["spring"].value("stiffness").text == "(k*curve(k_course, t))"
    assert improved(model, corrected, run) < 0.2
    verdict = sh.judge(model, corrected, on=run)
    sh.write_report(tmp_path / "report.html", diagnosis, verdict, model)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "What changes along the recordings" in page
    sh.write_diagnosis(tmp_path / "diagnosis.json", diagnosis, verdict)
    (told,) = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))["courses"]
    assert (told["parameter"], told["shape"], told["recordings"]) == ("k", "step", ["made.csv"])
    assert told["numbers"]["after"]["value"] == course.number("after").value


@pytest.mark.slow
def test_levels_are_named_as_a_line_through_points() -> None:
    model, run = pushed_model(), changing(5, staged)
    diagnosis = sh.diagnose(model, run)
    (course,) = diagnosis.courses
    assert (course.parameter, course.shape) == ("k", "free")
    for t, value, sd in course.points:
        if min(abs(t - bend) for bend in (4.1, 9.1, 14.1)) > 0.5:
            assert abs(value - 25 * staged(t)) < 3 * sd
    assert improved(model, sh.apply(model, (), courses=diagnosis.courses), run) < 0.3


@pytest.mark.slow
def test_an_input_that_fades_fast_is_a_matter_of_measurement() -> None:
    diagnosis = sh.diagnose(pushed_model(), changing(5, one, lambda t: 1 - 0.02 * t))
    (course,) = diagnosis.courses
    assert (course.channel, course.shape, diagnosis.verdict) == ("f", "drift", "measurement")
    assert abs(course.number("end").value - 0.6004) < 4 * course.number("end").sd
    assert not diagnosis.measurement  # no one value


@pytest.mark.slow
def test_a_sensor_that_fades_is_no_number_and_no_input() -> None:
    run = changing(5)
    fading = run.sensors["laser"] * (1 - 0.004 * run.t)
    diagnosis = sh.diagnose(pushed_model(), replace(run, sensors={"laser": fading}))
    assert not any((diagnosis.courses, diagnosis.measurement, diagnosis.parameters))
