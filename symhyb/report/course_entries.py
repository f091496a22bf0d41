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
    """A value at a time, s."""

    t: float
    value: float
    sd: float


class CourseEntry(TypedDict):
    """How a number runs over the time: exactly one of ``parameter`` and ``channel`` has it."""

    parameter: NotRequired[str]
    channel: NotRequired[str]
    shape: CourseName
    unit: str
    was: float
    numbers: dict[str, CourseNumberEntry]
    points: list[TimedEntry]
    span_s: list[float]
    recordings: list[str]
    rivals: list[CourseName]
    sentence: str


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
        "points": [{"t": t, "value": value, "sd": sd} for t, value, sd in one.points],
        "span_s": list(one.span),
        "recordings": list(one.recordings),
        "rivals": list(one.rivals),
        "sentence": one.sentence,
    }
    if one.parameter is not None:
        entry["parameter"] = one.parameter
    if one.channel is not None:
        entry["channel"] = one.channel
    return entry
