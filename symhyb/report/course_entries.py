"""A number that changes with time, as ``diagnosis.json`` holds it."""

from typing import NotRequired

from typing_extensions import TypedDict

from symhyb.discrepancy.results import CourseFound, CourseName


class CourseNumberEntry(TypedDict):
    """A number with one standard deviation, in its unit."""

    value: float
    sd: float
    unit: str


class TimedEntry(TypedDict):
    """A value at a time ``t``, s, or ``at`` what a channel shows, in its unit."""

    t: NotRequired[float]
    at: NotRequired[float]
    value: float
    sd: float


class OverEntry(TypedDict):
    """The channel that a number changes with, its unit, and between which values it was seen."""

    channel: str
    unit: str
    span: list[float]


class CourseEntry(TypedDict):
    """How a number runs over the time, or ``over`` a channel: exactly one of ``parameter`` and
    ``channel`` has it."""

    parameter: NotRequired[str]
    channel: NotRequired[str]
    shape: CourseName
    unit: str
    was: float
    numbers: dict[str, CourseNumberEntry]
    points: list[TimedEntry]
    span_s: NotRequired[list[float]]
    over: NotRequired[OverEntry]
    recordings: list[str]
    rivals: list[CourseName]
    sentence: str


def _point(one: CourseFound, where: float, value: float, sd: float) -> TimedEntry:
    if one.over is None:
        return {"t": where, "value": value, "sd": sd}
    return {"at": where, "value": value, "sd": sd}


def course_entry(one: CourseFound) -> CourseEntry:
    """The shape with its numbers and points, and which number has it."""
    entry: CourseEntry = {
        "shape": one.shape,
        "unit": one.unit,
        "was": one.was,
        "numbers": {
            item.name: {"value": item.value, "sd": item.sd, "unit": item.unit}
            for item in one.numbers
        },
        "points": [_point(one, *point) for point in one.points],
        "recordings": list(one.recordings),
        "rivals": list(one.rivals),
        "sentence": one.sentence,
    }
    if one.over is None:
        entry["span_s"] = list(one.span)
    else:
        entry["over"] = {"channel": one.over, "unit": one.over_unit, "span": list(one.span)}
    if one.parameter is not None:
        entry["parameter"] = one.parameter
    if one.channel is not None:
        entry["channel"] = one.channel
    return entry
