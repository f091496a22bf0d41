"""Which course a number has: each shape by itself, with its values; and where none is named."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from symhyb.correction.adequacy.in_time.answer import Answer, alike, changes, course_of
from symhyb.correction.adequacy.in_time.changing_number import (
    TimeLine,
    hats,
    input_at,
    number_at,
)
from symhyb.correction.adequacy.in_time.placing import _best_pair, _points
from symhyb.correction.adequacy.judge import adequacy
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from tests.changing import changing, drifted, one, pulsed, staged, stepped
from tests.pushed import judged, pushed_model

T = np.arange(0.0, 20.0, 0.02)
RANDOM = np.random.default_rng(3)


@cache
def answer_of(factor: Callable[[float], float], path: str = "k") -> Answer | None:
    drives = path == "f"
    run = changing(5, one, factor) if drives else changing(5, factor)
    ground, found = judged(run)
    number = input_at(ground, path) if drives else number_at(ground, path, 1.28)
    assert number is not None
    return course_of(ground, found, number)


def line_of(factor: np.ndarray, noise: float, points: int = 64) -> TimeLine:
    """A factor (N,) over T, each sample known to so much noise."""
    x = np.linspace(T[0], T[-1], points)
    left = factor - 1 + noise * RANDOM.standard_normal(T.size)
    joined = np.column_stack([-hats(T, x), left]) / noise
    return TimeLine(x, ((joined.T @ joined, 0.0),), 0.3)


def test_the_pair_of_a_step_stands_at_it() -> None:
    line = line_of(np.where(T < 8.13, 1.0, 0.9), 0.05)
    first, last = _best_pair(line)
    assert last - first <= 2
    assert line.x[first] - 0.3 < 8.13 < line.x[last] + 0.3


def test_points_stand_where_a_course_bends_and_none_where_it_is_straight() -> None:
    bent = np.interp(T, [0, 6, 12, 20], [1.0, 1.3, 0.8, 0.8])
    chosen, tried = _points(line_of(bent, 0.05))
    x = np.linspace(T[0], T[-1], 64)[list(chosen)]
    assert np.abs(x - 6).min() < 0.7
    assert np.abs(x - 12).min() < 0.7
    assert len(chosen) < 8 <= tried + 4
    assert len(_points(line_of(1.0 + 0.02 * T, 0.05))[0]) == 2


@pytest.mark.slow
def test_a_step_is_found_with_its_time() -> None:
    answer = answer_of(stepped)
    assert answer is not None
    course = answer.course
    assert (course.shape.name, answer.rivals) == ("step", ())
    assert course.shape.values == pytest.approx((1.0, 0.9), abs=0.006)
    assert abs(course.shape.middle - 8.13) < 4 * max(course.sd[2], 0.005)
    assert np.all(np.abs(np.array(course.shape.values) - (1.0, 0.9)) < 4 * course.sd[:2])


@pytest.mark.slow
def test_a_drift_is_found() -> None:
    answer = answer_of(drifted)
    assert answer is not None
    assert answer.course.shape.name == "drift"
    off = np.array(answer.course.shape.values) - (1.0, drifted(19.98))
    assert np.all(np.abs(off) < 4 * answer.course.sd)


@pytest.mark.slow
def test_a_pulsation_is_found() -> None:
    answer = answer_of(pulsed)
    assert answer is not None
    assert answer.course.shape.name == "period"
    off = np.array(answer.course.shape.values) - (1.0, 0.1, 1.3, 0.4)
    assert np.all(np.abs(off) < 4 * answer.course.sd)


@pytest.mark.slow
def test_levels_are_found_as_a_line_through_points() -> None:
    answer = answer_of(staged)
    assert answer is not None
    assert answer.course.shape.name == "free"
    t = np.concatenate([np.arange(a + 0.7, a + 4.2, 0.1) for a in (0.0, 4.2, 9.2, 14.2)])
    off = answer.course.shape.at(t) - [staged(x) for x in t]
    assert np.sqrt(np.mean(off**2)) < 0.01


@pytest.mark.slow
def test_an_input_that_fades_has_the_course_of_its_factor() -> None:
    answer = answer_of(lambda t: 1.0 - 0.02 * t, "f")
    assert answer is not None
    assert answer.course.shape.name == "drift"
    assert answer.course.shape.values == pytest.approx((1.0, 0.6004), abs=0.01)


def test_a_number_that_is_constant_has_no_course() -> None:
    assert answer_of(one) is None


def test_only_a_certain_class_says_what_changes() -> None:
    _, found = judged(changing(5, drifted))
    generic = changes(found)
    assert generic is not None
    assert (generic.kind, generic.where) == ("time-varying", "k")
    _, still = judged(changing(5))
    assert changes(still) is None


@pytest.mark.thorough
def test_another_number_whose_course_explains_as_much_is_said() -> None:
    # two springs side by side are one: which of them changes no recording can show
    text = pushed_model().text.replace('stiffness = "k"', 'stiffness = "k1 + k2"')
    text = text.replace(
        'k = { value = 25.0, unit = "N/m", sd = 0.5 }',
        'k1 = { value = 12.0, unit = "N/m", sd = 0.5 }\n'
        'k2 = { value = 13.0, unit = "N/m", sd = 0.5 }',
    )
    prepared = prepare(pushed_model(text), changing(5, stepped))
    setting = settle(prepared)
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, (), (), cuts, setting.sd)
    ground = recorded(prepared, setting)
    assert ground is not None
    found = adequacy(prepared, setting, final, (final, cuts))
    number = number_at(ground, "k1")
    assert number is not None
    answer = course_of(ground, found, number)
    assert answer is not None
    others = alike(ground, found, answer)
    assert [course.number.path for course, _ in others] == ["k2"]
