"""An input that acts by a factor which changes along a recording."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import KNOTS_TIME, hats, push_of, pushing
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def input_fading(start: Around, which: int) -> Generic:
    """What an input pushes with in proportion to itself, more or less as time goes."""
    recorded = start.recorded
    forces = []
    for item in recorded.items:
        u, push = push_of(recorded, item, which)
        t = item.block.t[0]
        slow = hats(t, np.linspace(t[0], t[-1], KNOTS_TIME))
        forces.append(push[:, :, None] * (u[:, None] * slow)[:, None])
    name = recorded.windows.machine.model.inputs[which].name
    return replace(pushing(recorded, "input", name, forces), does="fades")
