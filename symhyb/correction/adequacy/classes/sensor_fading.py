"""A sensor whose gain changes along a recording."""

from symhyb.correction.adequacy.classes.columns import showing, slow, without_gain
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.structure import Generic


def sensor_fading(start: Around, which: int) -> Generic:
    """What a sensor adds in proportion to what it should show, more or less as time goes."""
    items = start.recorded.items
    seen = [start.computed(i)[:, which] for i in range(len(items))]
    shown = [y[:, None] * slow(item.block.t[0]) for y, item in zip(seen, items, strict=True)]
    return showing(start.recorded, which, without_gain(shown, seen), "fades")
