"""Which sensor would separate rivals that no manoeuvre separates."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from symhyb.correction.advice.bounds import bounds_of
from symhyb.correction.advice.manoeuvre import Rivals, expected, needed_evidence
from symhyb.correction.advice.offers import offers
from symhyb.correction.advice.playing import ADDED, played, restrained
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.results import Manoeuvre
from symhyb.model.expression import parse_expression
from symhyb.model.types import Model, Sensor
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.units import parse_unit

TRIED_MOST = 3
SEEN = (("", "place"), ("'", "speed"), ("''", "acceleration"))


def telling_sensor(
    prepared: Prepared, setting: Setting, pair: Rivals
) -> tuple[str, Manoeuvre] | None:
    """The first sensor of a coordinate, in words, with which a manoeuvre within what was recorded
    would separate two rivals, and that manoeuvre; None if none does. Its noise, relative to what
    it sees, is taken to be that of the best sensor there is."""
    bounds, truths = bounds_of(prepared), (pair.first, pair.second)
    plans = (plan for plan in offers(prepared, pair.first.machine) if not plan.beyond)
    kept = (restrained(prepared, truths, plan, bounds)[0] for plan in plans)
    plan = next((plan for plan in kept if plan is not None), None)
    if plan is None:
        return None
    needed = needed_evidence(pair, plan.duration / plan.sampling)
    for words, sensor, sd in list(_sensors(prepared))[:TRIED_MOST]:
        model = _with(prepared.model, sensor)
        more = replace(prepared, model=model, machine=build(model, keep=False))
        seeing = replace(setting, sd=np.append(setting.sd, sd))
        first, second = (_seen(one, sensor) for one in (pair.first, pair.second))
        if all(
            expected(more, seeing, played(more, truth, plan), truth, rival) >= needed
            for truth, rival in ((first, second), (second, first))
        ):
            return words, plan
    return None


def _with(model: Model, sensor: Sensor) -> Model:
    return replace(model, sensors=(*model.sensors, sensor))


def _seen(trial: Refined, sensor: Sensor) -> Refined:
    """A fitted explanation with one sensor more, which has no numbers of its own."""
    machine = build(_with(trial.machine.model, sensor), keep=False)
    return replace(trial, machine=machine)


def _sensors(prepared: Prepared) -> Iterator[tuple[str, Sensor, float]]:
    """Sensors of the free coordinates that may be added: words, the sensor, its noise in SI."""
    relative = min(
        (
            float(sd / np.nanstd(values))
            for run in prepared.runs
            for sensor, sd in zip(prepared.model.sensors, prepared.sd, strict=True)
            if (values := run.recording.sensors.get(sensor.name)) is not None
            and np.nanstd(values) > 0
        ),
        default=1.0,
    )
    for i in prepared.machine.free:
        coordinate = prepared.model.coordinates[i]
        name, unit = coordinate.name, coordinate.unit
        for mark, word in SEEN:
            sensor = Sensor(ADDED, parse_expression(f"{name}{mark}"), unit)
            unit = unit / parse_unit("s")
            yield f"the {word} of {name}", sensor, relative * _spread(prepared, i, mark)


def _spread(prepared: Prepared, i: int, mark: str) -> float:
    """Standard deviation of a coordinate, its speed or acceleration in the recordings, SI."""
    parts: list[Array] = []
    for run in prepared.runs:
        whole = {"": run.motion.q, "'": run.motion.v, "''": run.motion.a}[mark]
        parts.append(whole[:, i])
    return float(np.std(np.concatenate(parts))) or 1.0
