"""A number that changes with what was recorded beside the machine, as with a temperature."""

from dataclasses import replace

import numpy as np
import pytest

import symhyb as sh
from symhyb.correction.adequacy.in_time.answer import Answer, course_of
from symhyb.correction.adequacy.in_time.changing_number import channels, number_at
from symhyb.correction.adequacy.in_time.stated_course import with_course
from symhyb.correction.naming.course_words import course_found, reach_said
from symhyb.model.types import Model
from tests.builders import DRIVEN_MASS
from tests.changing import Course, changing, drifted
from tests.pushed import STEP, judged, pushed_model, setting_of

BAR = 1e5
LOW, HIGH = 1.5 * BAR, 4.5 * BAR  # Pa


def rigged() -> Model:
    """The pushed mass, with a pressure and a switch that move nothing."""
    beside = 'p = { unit = "bar" }\nswitch = { unit = "1" }\n'
    return pushed_model(DRIVEN_MASS.replace("[bodies.mass]", f"{beside}[bodies.mass]"))


def pressure(t: float) -> float:
    """Pa: up and down, with a bend that no few points over the time follow."""
    wave = np.sin(2 * np.pi * t / 9.0) * np.cos(2 * np.pi * t / 23.0)
    return float(LOW + (HIGH - LOW) * (wave + 1) / 2)


def stiffened(t: float) -> float:
    """The factor of the stiffness: a straight line over the pressure."""
    return 1.0 + 0.1 * (pressure(t) - LOW) / (HIGH - LOW)


def with_pressure(recording: sh.Recording) -> sh.Recording:
    shown = np.array([pressure(t) for t in recording.t])
    noise = 0.002 * BAR * np.random.default_rng(8).standard_normal(shown.size)
    beside = {"p": shown + noise, "switch": np.ones(shown.size)}
    return replace(recording, inputs={**recording.inputs, **beside})


def answer_of(factor: Course) -> Answer:
    ground, found = judged(with_pressure(changing(5, factor)), rigged())
    number = number_at(ground, "k")
    assert number is not None
    known = course_of(ground, found, number)
    assert known is not None
    return known


@pytest.fixture(scope="module")
def answer() -> Answer:
    return answer_of(stiffened)


def test_only_what_moves_nothing_and_changes_is_a_channel_beside_the_machine() -> None:
    ground = setting_of(rigged(), with_pressure(changing(5)))
    assert channels(ground) == ("p",)


@pytest.mark.slow
def test_a_number_that_follows_a_channel_has_its_course_over_that(answer: Answer) -> None:
    shape = answer.course.shape
    assert (shape.over, shape.name, answer.rivals) == ("p", "drift", ())
    middle = LOW + np.array([0.2, 0.8]) * (HIGH - LOW)
    assert shape.at(middle) == pytest.approx([1.02, 1.08], abs=0.003)
    assert np.all(answer.course.sd < 0.003)


@pytest.mark.slow
def test_a_drift_beside_a_channel_that_runs_otherwise_stays_one_over_the_time() -> None:
    known = answer_of(drifted)
    assert (known.course.shape.over, known.course.shape.name) == ("", "drift")


@pytest.mark.slow
def test_the_corrected_model_states_it_in_the_unit_of_the_channel(answer: Answer) -> None:
    run = with_pressure(changing(6, stiffened))
    ground = setting_of(rigged(), run)
    found = course_found(rigged(), answer.course, (), ground)
    assert (found.over, found.over_unit) == ("p", "bar")
    assert found.span == pytest.approx((run["p"].min() / BAR, run["p"].max() / BAR), abs=0.02)
    assert "k changes with p from 25" in found.sentence
    assert "at p = " in found.sentence
    assert reach_said(found).startswith("It was seen where p is between 1.5")
    varied = with_course(rigged(), found)
    before = np.std(sh.simulate(rigged(), run).y[:, 0] - run["laser"])
    after = np.std(sh.simulate(varied, run).y[:, 0] - run["laser"])
    assert run.t[1] - run.t[0] == pytest.approx(STEP)
    assert after < 0.1 * before


@pytest.mark.thorough
def test_a_diagnosis_names_it_and_predicts_other_recordings() -> None:
    train, unseen = (with_pressure(changing(seed, stiffened)) for seed in (5, 6))
    diagnosis = sh.diagnose(rigged(), train, unseen)
    assert diagnosis.verdict == "parameters"
    (course,) = diagnosis.courses
    assert (course.parameter, course.over) == ("k", "p")
    assert "changes with p: k changes with p" in diagnosis.sentence
    corrected = sh.apply(rigged(), (), courses=diagnosis.courses)
    verdict = sh.judge(rigged(), corrected, on=unseen)
    after = verdict.holdout or verdict.train
    assert after.after.free_run_nrmse["laser"] < 0.2 * after.before.free_run_nrmse["laser"]
