"""An input that acts by a smooth function of itself."""

from symhyb.correction.adequacy.classes.columns import made_of, pushes, smooth_options
from symhyb.correction.adequacy.classes.erring_input import erring
from symhyb.correction.adequacy.classes.worth import Around, best_of
from symhyb.correction.adequacy.structure import Generic


def input_curve(start: Around, which: int) -> Generic:
    """What an input pushes with besides what was recorded of it: dead bands, saturation."""
    recorded = start.recorded
    parts = pushes(recorded, which)
    name = recorded.windows.machine.model.inputs[which].name
    return best_of(
        start,
        [
            made_of(recorded, "input", name, erring(recorded, which, option), joint=True)
            for option in smooth_options([u for u, _ in parts])
        ],
    )
