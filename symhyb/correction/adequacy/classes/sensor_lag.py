"""A sensor that shows what it should through a first-order lag."""

import numpy as np

from symhyb.correction.adequacy.classes.columns import LAGS, lagged, showing, without_gain
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def sensor_lag(start: Around, which: int) -> Generic:
    """What lags of several times take off what a sensor should show."""
    recorded = start.recorded
    times = np.geomspace(recorded.step_s, recorded.period_s, LAGS)
    seen = [start.computed(i)[:, which] for i in range(len(recorded.items))]
    shown = [lagged(y, times, recorded.step_s) for y in seen]
    return showing(recorded, which, without_gain(shown, seen), "lags")
