"""Structures in which something lags: an input, a sensor, or all sensors alike.

Whatever lags, it is raced against all else that may lag instead, by the evidence of the innovations
along whole recordings. The sensor's lag is a state of the model (:mod:`symhyb.model.late`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from symhyb.correction.adequacy.classes.columns import lag_times
from symhyb.correction.adequacy.classes.erring_input import pushed_by
from symhyb.correction.adequacy.classes.input_actuated import likeliest_number
from symhyb.correction.adequacy.classes.sensor_lag import sensor_lag
from symhyb.correction.adequacy.classes.worth import Around, worths_of
from symhyb.correction.adequacy.explained import may_take
from symhyb.correction.adequacy.followed import fitted_on
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.correction.adequacy.ways import shown_sensors
from symhyb.correction.search.trajectory import firsts_of, grouped, late_sensors
from symhyb.discrepancy.likelihood.track import Extra
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.actuators import SENSOR_LAG
from symhyb.model.late import lag_name, may_lag
from symhyb.model.types import Model


def sensor_lag_cause(model: Model, sensors: Sequence[str], time_s: float) -> Hypothesis:
    """That these sensors lag by one time constant, which is tried first as ``time_s``, s."""
    return Hypothesis(
        SENSOR_LAG,
        None,
        ("value",),
        (True,),
        shape=(("value", time_s),),
        path=lag_name(model, sensors[0]),
        options=tuple(("sensor", name) for name in sensors),
    )


def lagging_sensors(trial: Fitted) -> tuple[str, ...]:
    """The sensors that lag in a structure."""
    return tuple(name for cause in trial.causes for name in late_sensors(cause))


def with_late_sensors(ground: Recorded, here: Around, start: Fitted) -> list[Fitted]:
    """A structure with each sensor lagging, and with all by the same time, fitted along whole
    recordings from where it ended; the likeliest first. ``here`` is the structure, linearised."""
    found = [_with_sensors(ground, start, cause) for cause in _offered(ground, here)]
    return sorted(found, key=lambda trial: -trial.evidence)


def _with_sensors(ground: Recorded, start: Fitted, cause: Hypothesis) -> Fitted:
    rows = [*grouped(start), {"value": 0.0}]  # beyond what is tried first
    return fitted_on(ground, start, (*start.causes, cause), rows)


def with_late_input(ground: Recorded, here: Around, start: Fitted, name: str) -> Fitted | None:
    """A structure with an input that lags, fitted likewise; None where it does already."""
    which = ground.windows.machine.model.inputs.names().index(name)
    actuator = start.machine.model.inputs[which].actuator
    stated = {one.name: float(start.p[start.machine.column(one.path)]) for one in actuator}
    if "lag" in stated:
        return None
    time_s = likeliest_number(here, which, "lag", stated)[0].figure
    shape, path = (("value", time_s),), f"{name}.lag"
    cause = Hypothesis("lag", None, ("value",), (True,), shape=shape, path=path)
    rows = [*grouped(start), {"value": time_s}]
    return fitted_on(ground, start, (*start.causes, cause), rows)


def with_lags(
    ground: Recorded, here: Around, start: Fitted, known: Sequence[Hypothesis]
) -> list[Fitted]:
    """A structure with each input and each sensor lagging but for those of which that is ``known``,
    as one with the class of that: a sum of lags of a few times stands for one of another time, as
    far as a long one is linear at all. Of an input that pushes less than half of the unknown force
    none can be the answer."""
    found = []
    model = ground.windows.machine.model
    paths = {cause.path for cause in known}
    for j, name in enumerate(one.name for one in model.recorded_inputs):
        if f"{name}.lag" not in paths and may_take(ground, start, pushed_by(ground, j)):
            trial = with_late_input(ground, here, start, name)
            found += [] if trial is None else [_of_class(ground, trial, "lag", name)]
    late = {name for cause in known for name in late_sensors(cause)}
    for cause in _offered(ground, here):
        names = late_sensors(cause)
        if len(names) == 1 and late.isdisjoint(names):
            trial = _with_sensors(ground, start, cause)
            found.append(_of_class(ground, trial, "sensor", names[0]))
    return found


def _of_class(ground: Recorded, trial: Fitted, kind: Literal["lag", "sensor"], name: str) -> Fitted:
    """The structure with a class of no columns, which its last cause stands for."""
    model = ground.windows.machine.model
    sizes = len(model.coordinates), len(model.sensors)
    each = []
    for item in ground.items:
        samples = item.rows.size
        each.append(Extra(*(np.zeros((samples, size, 0)) for size in sizes)))
    does: Literal["", "lags"] = "lags" if kind == "sensor" else ""
    time_s = float(trial.fit.values[firsts_of(trial.causes)[-1]])
    generic = Generic(kind, name, tuple(each), np.zeros(0), figure=time_s, does=does)
    return replace(trial, extra=generic)


def _offered(ground: Recorded, here: Around) -> Iterator[Hypothesis]:
    """What may lag, by the time constant that is worth most in the linear problem; all sensors by
    that which is worth most to one of them. An imposed coordinate is taken to move as its sensor
    shows, so that a lag of that sensor would be no part of the machine."""
    model = ground.windows.machine.model
    given = {one.name for one in model.coordinates if one.imposed}
    offers = []
    for j in shown_sensors(ground):
        if may_lag(model, model.sensors[j]) and model.sensors[j].name not in given:
            each = sensor_lag(here, j)
            worths = worths_of(here, each, [[i] for i in range(each.spread.size)])
            best = int(np.argmax(worths))
            offers.append((float(worths[best]), model.sensors[j].name, lag_times(ground)[best]))
    for _, name, time in offers:
        yield sensor_lag_cause(model, (name,), float(time))
    if len(offers) > 1:
        yield sensor_lag_cause(model, [name for _, name, _ in offers], float(max(offers)[2]))
