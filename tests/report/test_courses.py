"""The picture and the entry of a number that changes with time."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.discrepancy.results import CourseFound, CourseNumber
from symhyb.report.course_entries import course_entry
from symhyb.report.courses import band_at, course_figure, values_at

STEP = CourseFound(
    "step",
    "N/m",
    25.0,
    (
        CourseNumber("before", 25.0, 0.1, "N/m"),
        CourseNumber("after", 22.0, 0.2, "N/m"),
        CourseNumber("time", 8.0, 0.05, "s"),
        CourseNumber("duration", 0.2, 0.01, "s"),
    ),
    ((7.9, 25.0, 0.1), (8.1, 22.0, 0.2)),
    (1.0, 0.88),
    ("a.csv",),
    (0.0, 20.0),
    "k steps.",
    parameter="k",
)
WAVE = CourseFound(
    "period",
    "1",
    1.0,
    (
        CourseNumber("level", 1.0, 0.03, "1"),
        CourseNumber("amplitude", 0.2, 0.04, "1"),
        CourseNumber("frequency", 0.5, 0.001, "Hz"),
        CourseNumber("phase", 0.0, 0.1, "rad"),
    ),
    (),
    (1.0, 0.2, 0.5, 0.0),
    ("a.csv", "b.csv"),
    (0.0, 20.0),
    "f acts by a factor that varies.",
    channel="f",
)


def test_a_step_is_drawn_with_its_values_and_its_time() -> None:
    t = np.array([0.0, 8.0, 20.0])
    assert values_at(STEP, t) == pytest.approx([25.0, 23.5, 22.0])
    low, high = band_at(STEP, t)
    assert (low[0], high[0], low[2], high[2]) == pytest.approx((24.8, 25.2, 21.6, 22.4))
    assert high[1] == pytest.approx(25.2)  # two deviations of the time later it has not begun
    assert low[1] == pytest.approx(21.6)


def test_a_period_is_drawn_about_its_level() -> None:
    t = np.array([0.0, 0.5])
    assert values_at(WAVE, t) == pytest.approx([1.0, 1.2])
    low, high = band_at(WAVE, t)
    assert high - low == pytest.approx([0.2, 0.2])


@pytest.mark.parametrize("one", [STEP, WAVE])
def test_a_picture_names_what_changes(one: CourseFound) -> None:
    drawn = course_figure(one).decode()
    assert drawn.lstrip().startswith("<?xml")
    assert len(drawn) > 3000


def test_an_entry_says_which_number_it_is_of() -> None:
    step, wave = course_entry(STEP), course_entry(WAVE)
    assert (step.get("parameter"), step.get("channel")) == ("k", None)
    assert (wave.get("parameter"), wave.get("channel")) == (None, "f")
    assert step["points"][1] == {"t": 8.1, "value": 22.0, "sd": 0.2}
    assert wave["numbers"]["frequency"] == {"value": 0.5, "sd": 0.001, "unit": "Hz"}


def test_a_course_over_a_channel_has_its_values_there() -> None:
    points = ((1.5, 25.0, 0.1), (4.5, 27.5, 0.1))
    over = replace(
        STEP, shape="drift", points=points, span=(1.5, 4.5), over="p", over_unit="bar", numbers=()
    )
    assert values_at(over, np.array([3.0])) == pytest.approx([26.25])
    entry = course_entry(over)
    assert "span_s" not in entry
    assert entry["over"] == {"channel": "p", "unit": "bar", "span": [1.5, 4.5]}
    assert entry["points"][0] == {"at": 1.5, "value": 25.0, "sd": 0.1}
    assert b"p [bar]" in course_figure(over) or b"bar" in course_figure(over)
