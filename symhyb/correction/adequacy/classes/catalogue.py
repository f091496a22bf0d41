"""Every class that a machine may show."""

from collections.abc import Callable
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.changing import changing
from symhyb.correction.adequacy.classes.columns import pushed_at
from symhyb.correction.adequacy.classes.coupling import coupling
from symhyb.correction.adequacy.classes.crossing_input import crossing_input
from symhyb.correction.adequacy.classes.erring_input import pushed_by
from symhyb.correction.adequacy.classes.held_input import held_input
from symhyb.correction.adequacy.classes.hidden_mode import hidden_mode
from symhyb.correction.adequacy.classes.input_actuated import (
    REMEMBERING,
    input_actuated,
    stated_of,
)
from symhyb.correction.adequacy.classes.input_curve import input_curve
from symhyb.correction.adequacy.classes.input_fading import input_fading
from symhyb.correction.adequacy.classes.input_lag import input_lag
from symhyb.correction.adequacy.classes.law import law
from symhyb.correction.adequacy.classes.sensor_curve import sensor_curve
from symhyb.correction.adequacy.classes.sensor_drift import sensor_drift
from symhyb.correction.adequacy.classes.sensor_fading import sensor_fading
from symhyb.correction.adequacy.classes.sensor_lag import sensor_lag
from symhyb.correction.adequacy.classes.worth import Around
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic


class Offered(NamedTuple):
    """A class to be made around a structure, and the coordinates that it pushes by itself; None
    where that is not known, or where it is no force."""

    make: Callable[[Around], Generic]
    pushes: frozenset[int] | None = None


def classes_of(recorded: Recorded) -> list[Offered]:
    """The classes of a machine."""
    model = recorded.windows.machine.model
    found: list[Offered] = []
    for i in range(len(recorded.library.places)):
        at = pushed_at(recorded, i)
        found += [Offered(partial(maker, which=i), at) for maker in (law, hidden_mode)]
    moved = [i for i in range(len(model.coordinates)) if recorded.scale[i] > 0]
    for i, j in combinations(moved, 2):
        found.append(Offered(partial(coupling, first=i, second=j), frozenset((i, j))))
    for j in range(len(model.recorded_inputs)):
        at = pushed_by(recorded, j)
        spared = frozenset(range(len(model.coordinates))) - at
        found += [
            Offered(partial(maker, which=j), at) for maker in (input_curve, input_lag, input_fading)
        ]
        found.append(Offered(partial(held_input, inputs=(j,)), at))
        free = (key for key in REMEMBERING if key not in stated_of(recorded, j))
        found += [Offered(partial(input_actuated, which=j, key=key), at) for key in free]
        if spared:
            found.append(Offered(partial(crossing_input, which=j), spared))
    uncertain = [item.path for item in model.parameters if item.sd is not None]
    found += [Offered(partial(changing, path=path)) for path in uncertain]
    for j in range(len(model.sensors)):
        if any(np.isfinite(item.block.y[0][:, j]).any() for item in recorded.items):
            makers = (sensor_drift, sensor_curve, sensor_fading, sensor_lag)
            found += [Offered(partial(maker, which=j)) for maker in makers]
    return found
