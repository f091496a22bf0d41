"""A sensor that shows what it should through a first-order lag."""

from symhyb.correction.adequacy.classes.columns import lagged, showing, without_gain
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def sensor_lag(start: Around, which: int) -> Generic:
    """What lags of several times take off what a sensor should show."""
    recorded = start.recorded
    seen = [start.computed(i)[:, which] for i in range(len(recorded.items))]
    shown = [lagged(recorded, y) for y in seen]
    return showing(recorded, which, without_gain(shown, seen), "lags")
