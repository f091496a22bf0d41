"""An input that acts along a coordinate where the model says that it does not."""

import numpy as np

from symhyb.correction.adequacy.classes.columns import pushes, pushing
from symhyb.correction.adequacy.classes.erring_input import spared_by
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def crossing_input(start: Around, which: int) -> Generic:
    """An input that acts where the model says that it does not."""
    recorded = start.recorded
    model = recorded.windows.machine.model
    spared = spared_by(recorded, which)
    forces = []
    for u, _ in pushes(recorded, which):
        pushed = np.zeros((u.size, len(model.coordinates), len(spared)))
        for column, at in enumerate(spared):
            pushed[:, at, column] = u
        forces.append(pushed)
    return pushing(recorded, "coupling", model.inputs[which].name, forces)
