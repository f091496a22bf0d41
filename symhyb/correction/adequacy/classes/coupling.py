"""Forces that follow another motion, or another input, than the model says."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import push_of, pushing
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.model.types import On


def coupling(start: Around, first: int, second: int) -> Generic:
    """Two coordinates that act on each other in proportion to their places and speeds, not
    necessarily one as the other: springs and dampers askew, gyroscopic and circulatory forces."""
    recorded = start.recorded
    coordinates = recorded.windows.machine.model.coordinates
    forces = []
    for item in recorded.items:
        course = item.course(recorded.windows.machine)
        rows = item.rows[0]
        pushed = np.zeros((rows.size, len(coordinates), 4))
        for at, by, column in ((first, second, 0), (second, first, 2)):
            place = course.q[rows, by]
            pushed[:, at, column] = place - place.mean()
            pushed[:, at, column + 1] = course.v[rows, by]
        forces.append(pushed)
    place = On(coordinates[first].name)
    found = pushing(recorded, "coupling", place, forces)
    return replace(found, other=coordinates[second].name)


def crossing_input(start: Around, which: int) -> Generic:
    """An input that acts where the model says that it does not."""
    recorded = start.recorded
    model = recorded.windows.machine.model
    parts = [push_of(recorded, item, which) for item in recorded.items]
    spared = spared_by(recorded, which)
    forces = []
    for u, _ in parts:
        pushed = np.zeros((u.size, len(model.coordinates), len(spared)))
        for column, at in enumerate(spared):
            pushed[:, at, column] = u
        forces.append(pushed)
    return pushing(recorded, "coupling", model.inputs[which].name, forces)


def spared_by(recorded: Recorded, which: int) -> list[int]:
    """The coordinates on which an input does not act."""
    size = sum(np.abs(push_of(recorded, item, which)[1]).sum(axis=0) for item in recorded.items)
    return [int(i) for i in np.flatnonzero(size == 0) if recorded.scale[i] > 0]
