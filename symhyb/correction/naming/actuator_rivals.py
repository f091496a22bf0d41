"""Numbers of an actuator that explain an input as well as each other, as alternatives."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.actuators import Behind
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.structure import Generic
from symhyb.correction.search.trajectory import firsts_of
from symhyb.discrepancy.results import Alternative, Estimate
from symhyb.discrepancy.words.amounts import joined
from symhyb.model.actuators import ACTUATOR_KEYS


class LagDoubt(NamedTuple):
    """That an input or a sensor lags, in a sentence, and what to record to distinguish them."""

    said: str
    record_next: str


def lag_doubt(behind: Behind) -> LagDoubt | None:
    """What to say where sensors may lag instead of an input; None where none may."""
    if not behind.sensors:
        return None
    name, sensors = _late(behind)[0], joined(behind.sensors)
    each = "one" if len(behind.sensors) == 1 else "the same one"
    if behind.always:
        why = "this machine is linear and has one input, so that no motion distinguishes them"
    else:
        why = "both are as likely in these recordings"
    return LagDoubt(
        f"A lag of the input {name} shows as {each} of {sensors} would: {why}.",
        f"What acts in place of {name}, behind its actuator (a force cell, a current), or the "
        f"motion by one more sensor of another kind: a lag of {name} delays all sensors of the "
        f"motion alike, one of {sensors} no other sensor.",
    )


def named_for_input(judged: Adequacy, behind: Behind) -> Adequacy:
    """The same where a sensor lags, in place of which an input always may: of what is the same the
    input is named, with its time constant."""
    first = judged.classes[0] if judged.classes else None
    if not behind.always or first is None or first.generic.kind != "sensor":
        return judged
    name, time_s = _late(behind)
    lag = Generic("lag", name, (), np.zeros(0), figure=time_s)
    return replace(judged, classes=(first._replace(generic=lag), *judged.classes[1:]))


def _late(behind: Behind) -> tuple[str, float]:
    """The input that lags, and by how much, s."""
    trial = behind.trials[0]
    which = next(i for i, cause in enumerate(trial.causes) if cause.kind in ACTUATOR_KEYS)
    value = float(trial.fit.values[firsts_of(trial.causes)[which]])
    return trial.causes[which].path.removesuffix(".lag"), value


def actuator_rivals(behind: Behind, group: int) -> tuple[Alternative, ...]:
    """Each structure as an alternative, by how much less likely it is than the first (−2 ln of the
    odds), and the sensors that may lag instead; numbers that hold together share a number from
    ``group`` on."""
    found: list[Alternative] = []
    for which, trial in enumerate(behind.trials):
        declared = {item.path: item for item in trial.machine.model.all_parameters()}
        spread = np.sqrt(np.abs(np.diag(trial.fit.covariance)))
        mine = [
            (cause, first)
            for cause, first in zip(trial.causes, firsts_of(trial.causes), strict=True)
            if cause.kind in ACTUATOR_KEYS
        ]
        evidence = 2 * (behind.trials[0].evidence - trial.evidence)
        for cause, first in mine:
            item = declared[cause.path]
            value, sd = (float(x[first]) / item.unit.factor for x in (trial.fit.values, spread))
            one = Estimate(cause.kind, value, sd, item.unit.text, cause.kind)
            together = group + which if len(mine) > 1 else 0
            found.append(
                Alternative(
                    None, cause.kind, (one,), evidence, channel=item.owner, together=together
                )
            )
    sensors = (Alternative(None, "lag", (), 0.0, channel=name) for name in behind.sensors)
    return (*found, *sensors)
