"""Points on one line that pass through each other: a force between them then turns round.

The stretch of a spring between two points is |b − a| − length. Masses in a row that overtake each
other on paper, which no machine does, or a length that is too short, make its force jump from one
side to the other. What the model misses from there on is its geometry.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.places.hypotheses import library
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.runs import Run
from symhyb.model.types import Between, Model

ON_LINE = 1e-6  # relative: of the direction of a force between points that stay on one line


@dataclass(frozen=True, slots=True)
class Meeting:
    """Where an ``element`` turns round: its points, and when (s) in which recording."""

    element: str
    place: Between
    recording: str
    t: float


def meeting(model: Model, runs: Sequence[Run]) -> Meeting | None:
    """The first time that the points of an element which has a length pass through each other along
    the measured motion; None if they do not, or do not move along one line: its force acts in one
    direction of the coordinates (n,) all along, and at once in the opposite one."""
    joined = {
        item.place: item.name
        for item in reversed(model.elements)
        if isinstance(item.place, Between) and item.value("length") is not None
    }
    if not joined:
        return None
    gauge = library(model, tuple(joined), ())
    for run in runs:
        forces = gauge.directions(course_of(run.recording, gauge.machine, run.motion))
        for i, (place, name) in enumerate(joined.items()):
            size = np.linalg.norm(forces[:, :, i], axis=1)
            along = forces[:, :, i] @ forces[0, :, i]
            straight = np.allclose(np.abs(along), size * size[0], rtol=ON_LINE, atol=0)
            turned = np.flatnonzero(along < 0)
            if straight and turned.size:
                return Meeting(name, place, run.recording.name, float(run.motion.t[turned[0]]))
    return None
