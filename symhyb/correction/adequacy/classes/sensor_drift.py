"""A sensor whose zero drifts."""

from symhyb.correction.adequacy.classes.columns import showing, slow
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def sensor_drift(start: Around, which: int) -> Generic:
    """What a sensor adds along a recording, slowly."""
    shown = [slow(item.block.t[0]) for item in start.recorded.items]
    return showing(start.recorded, which, shown, "drifts")
