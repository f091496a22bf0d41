"""What a search that is interrupted knows by then, in a sentence."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from symhyb.correction.search.trajectory import Refined, keys_of, paths_of
from symhyb.discrepancy.words.amounts import number_text, quantity_text
from symhyb.fault import SO_FAR
from symhyb.interruption import is_interruption


@contextmanager
def if_interrupted(known: Callable[[], str]) -> Iterator[None]:
    """Give an interruption (Ctrl-C) a note with what is ``known`` then."""
    try:
        yield
    except (KeyboardInterrupt, Exception) as stop:
        said = known() if is_interruption(stop) else ""
        if said:
            stop.add_note(SO_FAR + said)
        raise


def fits_best(best: Refined, tried: int) -> str:
    """The structure that is the best of those that were ``tried``."""
    times = number_text(float(np.sqrt(best.fit.scale)), digits=2)
    what = "structure that was" if tried == 1 else f"{tried} structures that were"
    values = ", ".join(_values(best))
    return (
        f"{best.name} fits best of the {what} tried, and leaves {times} times the noise"
        + f" ({values}; not judged yet)" * bool(values)
    )


def _values(best: Refined) -> Iterator[str]:
    """The fitted numbers of a structure with their units; of several recordings with numbers of
    their own those of the first."""
    for i, cause in enumerate(best.causes):
        for key, path in zip(keys_of(cause), paths_of(i, cause), strict=True):
            value, sd = best.value(path)
            if cause.place is None:
                declared = {item.path: item.unit for item in best.machine.model.all_parameters()}
                unit, name = declared[cause.path], cause.path
            else:
                unit, name = cause.unit(best.machine.model, key), key
            yield f"{name} {quantity_text(value / unit.factor, unit.text, sd / unit.factor)}"
