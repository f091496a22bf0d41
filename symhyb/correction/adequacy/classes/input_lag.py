"""An input that acts through a first-order lag."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import lag_times, lagged, made_of, pushes
from symhyb.correction.adequacy.classes.erring_input import erring
from symhyb.correction.adequacy.classes.worth import Around, worths_of
from symhyb.correction.adequacy.structure import Generic


def input_lag(start: Around, which: int) -> Generic:
    """What lags of several times take off an input."""
    recorded = start.recorded
    taken = [lagged(recorded, u) for u, _ in pushes(recorded, which)]
    name = recorded.windows.machine.model.inputs[which].name
    found = made_of(recorded, "lag", name, erring(recorded, which, taken))
    best = int(np.argmax(worths_of(start, found, [[i] for i in range(found.spread.size)])))
    return replace(found, figure=float(lag_times(recorded)[best]))
