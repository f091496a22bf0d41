"""An input that acts by a factor which changes along a recording."""

from dataclasses import replace

from symhyb.correction.adequacy.classes.columns import pushes, pushing, slow
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def input_fading(start: Around, which: int) -> Generic:
    """What an input pushes with in proportion to itself, more or less as time goes."""
    recorded = start.recorded
    forces = []
    for item, (u, push) in zip(recorded.items, pushes(recorded, which), strict=True):
        forces.append(push[:, :, None] * (u[:, None] * slow(item.block.t[0]))[:, None])
    name = recorded.windows.machine.model.inputs[which].name
    return replace(pushing(recorded, "input", name, forces), does="fades")
