"""Every class that a machine may show."""

from collections.abc import Callable
from functools import partial
from itertools import combinations

import numpy as np

from symhyb.correction.adequacy.classes.changing import changing
from symhyb.correction.adequacy.classes.coupling import coupling
from symhyb.correction.adequacy.classes.crossing_input import crossing_input, spared_by
from symhyb.correction.adequacy.classes.held_input import held_input
from symhyb.correction.adequacy.classes.hidden_mode import hidden_mode
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

Maker = Callable[[Around], Generic]


def classes_of(recorded: Recorded) -> list[Maker]:
    """The classes of a machine, each to be made around a structure."""
    model = recorded.windows.machine.model
    found: list[Maker] = []
    for i in range(len(recorded.library.places)):
        found += [partial(law, which=i), partial(hidden_mode, which=i)]
    moved = [i for i in range(len(model.coordinates)) if recorded.scale[i] > 0]
    found += [partial(coupling, first=i, second=j) for i, j in combinations(moved, 2)]
    for j in range(len(model.inputs)):
        found += [partial(maker, which=j) for maker in (input_curve, input_lag, input_fading)]
        found.append(partial(held_input, inputs=(j,)))
        if spared_by(recorded, j):
            found.append(partial(crossing_input, which=j))
    uncertain = [item.path for item in model.parameters if item.sd is not None]
    found += [partial(changing, path=path) for path in uncertain]
    for j in range(len(model.sensors)):
        if any(np.isfinite(item.block.y[0][:, j]).any() for item in recorded.items):
            makers = (sensor_drift, sensor_curve, sensor_fading, sensor_lag)
            found += [partial(maker, which=j) for maker in makers]
    return found
