"""An input that acts through a first-order lag."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import LAGS, lagged, push_of, pushing
from symhyb.correction.adequacy.classes.worth import Around, worths_of
from symhyb.correction.adequacy.structure import Generic


def input_lag(start: Around, which: int) -> Generic:
    """What lags of several times take off an input."""
    recorded = start.recorded
    parts = [push_of(recorded, item, which) for item in recorded.items]
    times = np.geomspace(recorded.step_s, recorded.period_s, LAGS)
    forces = [push[:, :, None] * lagged(u, times, recorded.step_s)[:, None] for u, push in parts]
    name = recorded.windows.machine.model.inputs[which].name
    found = pushing(recorded, "lag", name, forces)
    best = times[int(np.argmax(worths_of(start, found, [range(i, i + 1) for i in range(LAGS)])))]
    return replace(found, figure=float(best))
