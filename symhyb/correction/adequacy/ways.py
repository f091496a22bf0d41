"""The ways from inputs to sensors: where a lag at one end shows as a lag at the other.

    u ─▶ lag ─▶ machine ─▶ y        of a linear machine, which depends on no time itself, both
    u ─▶ machine ─▶ lag ─▶ y        show the same y

It is so where all sensors that an input reaches are reached by nothing else: then a lag of the
input is the same lag of all of these.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.ranking import is_lag
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Likely
from symhyb.discrepancy.recorded.windows import SAMPLES_LEAST
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.linear import linear, reached
from symhyb.numeric.lowered.machine import Machine


def same_way(machine: Machine, which: int, shown: Sequence[int]) -> tuple[int, ...]:
    """The sensors out of those ``shown`` that together would lag as this input does; none where
    motions distinguish them."""
    form = state_form(machine)
    if not linear(form):
        return ()
    ways = reached(form)[list(shown)]
    mine = ways[:, which]
    if not mine.any() or np.any(np.delete(ways, which, axis=1)[mine]):
        return ()
    return tuple(np.asarray(shown)[mine].tolist())


def shown_sensors(ground: Recorded) -> list[int]:
    """The sensors that recorded something."""
    blocks = [item.block.y[0] for item in ground.items]
    return [j for j in range(blocks[0].shape[1]) if any(np.isfinite(y[:, j]).any() for y in blocks)]


def later(ground: Recorded, time_s: float) -> Recorded | None:
    """The same recordings without the first part of every stretch, s, before which inputs act as
    they were recorded; None where too little is left of all."""
    left = max(round(time_s / ground.step_s), 0)
    kept = [
        (item.between(left, item.rows.size), which)
        for item, which in zip(ground.items, ground.recording, strict=True)
        if item.rows.size - left >= SAMPLES_LEAST
    ]
    known = {which for _, which in kept}
    if known != {*ground.recording}:
        return None
    items, recording = zip(*kept, strict=True)
    return replace(ground, items=items, recording=recording)


def on_ways(ground: Recorded, classes: Sequence[Likely]) -> tuple[Likely, ...]:
    """The classes, where a lag of an input is the same as that of sensors as one of the way between
    them: which of them lags is not known, whatever the odds of their columns are."""
    machine = ground.windows.machine
    if not any(is_lag(one.generic) for one in classes):
        return tuple(classes)
    inputs, sensors = machine.model.recorded_inputs, machine.model.sensors
    shown, found = shown_sensors(ground), dict[object, Likely]()
    ways = {
        one.name: tuple(sensors[j].name for j in same_way(machine, i, shown))
        for i, one in enumerate(inputs)
    }
    by_sensor = {names[0]: name for name, names in ways.items() if len(names) == 1}
    for one in classes:
        generic = one.generic
        if is_lag(one.generic) and generic.kind == "sensor" and generic.where in by_sensor:
            name = by_sensor[str(generic.where)]
            generic = replace(generic, kind="lag", where=name, does="")
        if generic.kind == "lag" and ways.get(str(generic.where)):
            generic = replace(generic, sensors=ways[str(generic.where)])
        known = found.get(generic.key)
        if known is not None:
            chance = min(known.probability + one.probability, 1.0)
            one = one._replace(probability=chance, whole=known.whole or one.whole)
            generic = known.generic if np.isfinite(known.generic.figure) else generic
        found[generic.key] = one._replace(generic=generic)
    return tuple(sorted(found.values(), key=lambda one: -one.probability))
