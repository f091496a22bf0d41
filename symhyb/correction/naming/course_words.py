"""A number that changes with time, or with a channel, as a result and in words."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.in_time.changing_number import abscissae
from symhyb.correction.adequacy.in_time.fitted_course import Course
from symhyb.correction.adequacy.in_time.placing import SHORTEST
from symhyb.correction.adequacy.in_time.shapes import Shape, numbers_of, unit_along
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.discrepancy.results import CourseFound, CourseNumber
from symhyb.discrepancy.words.amounts import capital, joined, number_text, quantity_text
from symhyb.judgement import OUTSTANDING
from symhyb.model.types import Model

_MARKS = 5  # points of a free course that a sentence gives
_SHORT = 1.5  # times the shortest step that samples show: a sentence says no duration
_RIVALS = {
    "step": "a step",
    "drift": "a straight line",
    "period": "a periodic change",
    "free": "a line through several points",
}
_ALONE = (
    "This course belongs to these recordings: unless the machine repeats it, it says nothing of "
    "others."
)


def reach_said(found: CourseFound) -> str:
    """Where a course holds, as a sentence."""
    if found.over is None:
        return _ALONE
    low, high = (number_text(one, digits=4) for one in found.span)
    return f"It was seen where {found.over} is between {low} and {high} {found.over_unit}."


def course_found(
    model: Model,
    course: Course,
    rivals: Sequence[Course],
    ground: Recorded,
) -> CourseFound:
    """A course as a result, with its sentence, in the unit of the number; ``rivals`` are other
    shapes that are as likely."""
    was, unit = _stated(model, course)
    path = course.number.path
    numbers = _numbers(course, was, unit)
    shape = course.shape
    recordings = tuple(dict.fromkeys(item.source[0].name for item in ground.items))
    over = unit_along(shape, model)
    at = [one / over.factor for one in abscissae(ground, shape.over)]
    points = tuple(
        (t / over.factor, was * factor, abs(was) * sd)
        for t, factor, sd in zip(shape.times, shape.values, course.sd.tolist(), strict=False)
    )
    found = CourseFound(
        shape.name,
        unit,
        was,
        numbers,
        points,
        shape.values,
        recordings,
        (float(min(one.min() for one in at)), float(max(one.max() for one in at))),
        "",
        parameter=None if course.number.is_channel else path,
        channel=path if course.number.is_channel else None,
        rivals=tuple(one.shape.name for one in rivals),
        over=shape.over or None,
        over_unit=over.text,
    )
    said = f"{_subject(course, found)} {_does(found, ground.step_s)}, in {joined(recordings)}."
    if found.rivals:
        others = joined([_rival(one.shape) for one in rivals], "or")
        said += f" {capital(others)} is as likely."
    return replace(found, sentence=said)


def _rival(shape: Shape) -> str:
    """Another shape that is as likely."""
    along = f" with {shape.over or 'time'}" if shape.name in ("drift", "free") else ""
    return f"{_RIVALS[shape.name]}{along}"


def _stated(model: Model, course: Course) -> tuple[float, str]:
    """What the model says of the number, with its unit; the factor of a channel is 1."""
    if course.number.is_channel:
        return 1.0, "1"
    item = {one.path: one for one in model.all_parameters()}[course.number.path]
    return item.value, item.unit.text


def _numbers(course: Course, was: float, unit: str) -> tuple[CourseNumber, ...]:
    shape, sd = course.shape, course.sd.tolist()
    sizes = [abs(was) * one for one in sd]
    values = [was * one for one in shape.values]
    if shape.name == "period":
        _, amplitude, frequency, phase = shape.values
        turned = phase if was * amplitude > 0 else phase + math.pi
        angle = math.remainder(turned, 2 * math.pi)
        return (
            CourseNumber("level", values[0], sizes[0], unit),
            CourseNumber("amplitude", abs(was * amplitude), sizes[1], unit),
            CourseNumber("frequency", frequency, sd[2], "Hz"),
            CourseNumber("phase", angle, sd[3], "rad"),
        )
    if shape.name == "free":
        return ()
    names = ("before", "after") if shape.name == "step" else ("begin", "end")
    found = [CourseNumber(names[i], values[i], sizes[i], unit) for i in range(2)]
    if shape.name == "step":
        known = dict(zip((key for key, _ in numbers_of(shape)), sd, strict=True))
        lasts = known.get("duration", 0.0)
        found.append(CourseNumber("time", shape.middle, known["time"], "s"))
        found.append(CourseNumber("duration", shape.duration, lasts, "s"))
    return tuple(found)


def _subject(course: Course, found: CourseFound) -> str:
    if found.parameter:
        return found.path
    return f"{found.path} {'shows' if course.number.is_sensor else 'acts'} by a factor that"


def _does(found: CourseFound, step_s: float) -> str:
    """What a number does, in words, with one standard deviation of every value."""

    def said(name: str) -> str:
        one = found.number(name)
        return quantity_text(one.value, one.unit, one.sd)

    symbol, unit = found.over or "t", found.over_unit
    match found.shape:
        case "step":
            duration = found.number("duration")
            slow = duration.value > _SHORT * SHORTEST * step_s
            slow = slow and duration.value > OUTSTANDING * duration.sd
            within = f", within {said('duration')}" if slow else ""
            low = found.number("before")
            values = f"{number_text(low.value, low.sd)} to {said('after')}"
            return f"steps from {values} at t = {said('time')}{within}"
        case "drift":
            first, last = found.points[0][0], found.points[-1][0]
            verb = f"changes with {found.over}" if found.over else "drifts"
            return (
                f"{verb} from {said('begin')} at {symbol} = {first:.4g} {unit} to {said('end')} at "
                f"{symbol} = {last:.4g} {unit}"
            )
        case "period":
            return (
                f"varies periodically about {said('level')} with an amplitude of "
                f"{said('amplitude')} at {said('frequency')}"
            )
    points = found.points
    rows = np.unique(np.linspace(0, len(points) - 1, _MARKS).round().astype(int))
    marks = [
        f"{quantity_text(y, found.unit, sd)} at {symbol} = {t:.4g} {unit}"
        for t, y, sd in map(points.__getitem__, rows)
    ]
    along = found.over or "time"
    return f"changes with {along} along a line through {len(points)} points: {joined(marks)}"
