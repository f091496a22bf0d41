"""Two coordinates that act on each other in a way that the model lacks."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import pushing
from symhyb.correction.adequacy.classes.worth import Around
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
