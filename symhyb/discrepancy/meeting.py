"""Points that pass through each other: a force between them then turns round.

The stretch of a spring between two points is |b − a| − length. Masses in a row that overtake each
other on paper, which no machine does, or a length that is too short, make its force jump from one
side to the other. What the model misses from there on is its geometry.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.course import course_of
from symhyb.discrepancy.hypotheses import library
from symhyb.discrepancy.runs import Run
from symhyb.model.types import Between, Model


@dataclass(frozen=True, slots=True)
class Meeting:
    """Where an ``element`` turns round: its points, and when (s) in which recording."""

    element: str
    place: Between
    recording: str
    t: float


def meeting(model: Model, runs: Sequence[Run]) -> Meeting | None:
    """The first time that the points of an element which has a length are nearer to each other
    than they move between two samples, along the measured motion; None if they stay apart."""
    joined = {
        item.place: item.name
        for item in reversed(model.elements)
        if isinstance(item.place, Between) and item.value("length") is not None
    }
    if not joined:
        return None
    gauge = library(model, tuple(joined), ())
    for run in runs:
        distance, rate = gauge.motion(course_of(run.recording, gauge.machine, run.motion))
        moved = np.abs(rate) * np.gradient(run.motion.t)[:, None]
        for i, (place, name) in enumerate(joined.items()):
            near = np.flatnonzero(distance[:, i] < moved[:, i])
            if near.size:
                return Meeting(name, place, run.recording.name, float(run.motion.t[near[0]]))
    return None
