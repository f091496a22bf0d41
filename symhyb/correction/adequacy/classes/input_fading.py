"""An input that acts by a factor which changes along a recording."""

from dataclasses import replace

from symhyb.correction.adequacy.classes.columns import made_of, pushes, slow
from symhyb.correction.adequacy.classes.erring_input import erring
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def input_fading(start: Around, which: int) -> Generic:
    """What an input pushes with in proportion to itself, more or less as time goes."""
    recorded = start.recorded
    errors = [
        u[:, None] * slow(item.block.t[0])
        for item, (u, _) in zip(recorded.items, pushes(recorded, which), strict=True)
    ]
    name = recorded.windows.machine.model.inputs[which].name
    return replace(made_of(recorded, "input", name, erring(recorded, which, errors)), does="fades")
