"""A sensor whose zero drifts."""

import numpy as np

from symhyb.correction.adequacy.classes.columns import KNOTS_TIME, hats, showing
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def sensor_drift(start: Around, which: int) -> Generic:
    """What a sensor adds along a recording, slowly."""
    shown = []
    for item in start.recorded.items:
        t = item.block.t[0]
        shown.append(hats(t, np.linspace(t[0], t[-1], KNOTS_TIME)))
    return showing(start.recorded, which, shown, "drifts")
