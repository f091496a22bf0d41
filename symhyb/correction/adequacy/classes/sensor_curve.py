"""A sensor that shows a smooth function of what it should."""

from symhyb.correction.adequacy.classes.columns import showing, smooth_options, without_gain
from symhyb.correction.adequacy.classes.worth import Around, best_of
from symhyb.correction.adequacy.structure import Generic


def sensor_curve(start: Around, which: int) -> Generic:
    """What a sensor adds by what it should show: ranges that end, gains that are not constant."""
    recorded = start.recorded
    seen = [start.computed(i)[:, which] for i in range(len(recorded.items))]
    options = [without_gain(option, seen) for option in smooth_options(seen)]
    return best_of(
        start, [showing(recorded, which, option, "bends", joint=True) for option in options]
    )
