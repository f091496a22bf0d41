"""What explains a lag, or an input, as well as each other, as alternatives."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from symhyb.correction.adequacy.actuators import Behind
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.ranking import is_lag
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely
from symhyb.correction.search.trajectory import firsts_of, late_sensors
from symhyb.discrepancy.results import Alternative, Estimate
from symhyb.discrepancy.words.amounts import joined
from symhyb.model.actuators import ACTUATOR_KEYS, SENSOR_LAG, ActuatorKey

_KINDS = (*ACTUATOR_KEYS, SENSOR_LAG)


class LagDoubt(NamedTuple):
    """That an input or a sensor lags, in a sentence, and what to record to distinguish them."""

    said: str
    record_next: str


def lag_doubt(behind: Behind) -> LagDoubt | None:
    """What to say where sensors may lag instead of an input, or of each other; None where none
    may."""
    inputs, sensors = _late_inputs(behind), joined(behind.sensors)
    if not behind.sensors:
        return None
    if not inputs:
        return LagDoubt(
            f"Which of the sensors {sensors} lags is not known: several are as likely in these "
            "recordings.",
            "The motion by one more sensor of another kind.",
        )
    name = joined(inputs)
    each = "one" if len(behind.sensors) == 1 else "the same one"
    if behind.input:
        why = (
            f"this machine is linear and nothing else drives what {sensors} show"
            f"{'s' if len(behind.sensors) == 1 else ''}, so that no motion distinguishes them"
        )
    else:
        why = "both are as likely in these recordings"
    return LagDoubt(
        f"A lag of the input {name} shows as {each} of {sensors} would: {why}.",
        f"What acts in place of {name}, behind its actuator (a force cell, a current), or the "
        f"motion by one more sensor of another kind: a lag of {name} delays all sensors of the "
        f"motion alike, one of {sensors} no other sensor.",
    )


def named_on_the_way(judged: Adequacy, behind: Behind) -> Adequacy:
    """The same where an input or sensors may lag: as one class, of the way between them, with the
    time constant; where sensors alone may, the classes as they are."""
    inputs = _late_inputs(behind)
    if not (behind.sensors and inputs and judged.classes):
        return judged
    mine = [one for one in judged.classes if is_lag(one.generic)]
    others = tuple(one for one in judged.classes if not is_lag(one.generic))
    if not mine:
        return judged
    time_s = float(behind.trials[0].fit.values[_first(behind.trials[0])])
    lag = Generic("lag", inputs[0], (), np.zeros(0), figure=time_s, sensors=behind.sensors)
    chance = min(sum(one.probability for one in mine), 1.0)
    whole = any(one.whole for one in mine)
    return replace(judged, classes=(Likely(lag, chance, whole), *others))


def _late_inputs(behind: Behind) -> tuple[str, ...]:
    """The inputs that lag in one of the structures, or may always."""
    if behind.input:
        return (behind.input,)
    causes = (cause for trial in behind.trials for cause in trial.causes if cause.kind == "lag")
    return tuple(dict.fromkeys(cause.path.removesuffix(".lag") for cause in causes))


def _first(trial: Fitted) -> int:
    """Where the first number of an actuator or of a lag stands among the numbers."""
    which = next(i for i, cause in enumerate(trial.causes) if cause.kind in _KINDS)
    return firsts_of(trial.causes)[which]


def actuator_rivals(behind: Behind, group: int) -> tuple[Alternative, ...]:
    """Each structure as an alternative, by how much less likely it is than the first (−2 ln of the
    odds), and where no recording distinguishes them the sensors that may lag instead; numbers that
    hold together share a number from ``group`` on."""
    found: list[Alternative] = []
    for which, trial in enumerate(behind.trials):
        declared = {item.path: item for item in trial.machine.model.all_parameters()}
        spread = np.sqrt(np.abs(np.diag(trial.fit.covariance)))
        evidence = 2 * (behind.trials[0].evidence - trial.evidence)
        mine: list[tuple[str, str, Estimate]] = []
        for cause, first in zip(trial.causes, firsts_of(trial.causes), strict=True):
            if cause.kind not in _KINDS:
                continue
            item = declared[cause.path]
            value, sd = (float(x[first]) / item.unit.factor for x in (trial.fit.values, spread))
            one = Estimate(cause.kind, value, sd, item.unit.text, cause.kind)
            mine += [(cause.kind, name, one) for name in late_sensors(cause) or (item.owner,)]
        together = group + which if len(mine) > 1 else 0
        found += [
            Alternative(None, kind, (one,), evidence, channel=name, together=together)
            for kind, name, one in mine
        ]
    return (*found, *_always(behind, found, group + len(behind.trials)))


def _always(behind: Behind, found: Sequence[Alternative], group: int) -> Iterator[Alternative]:
    """What may lag by the same number as the likeliest structure where no recording distinguishes
    them: the input, or the sensors, which hold together."""
    known = {one.channel for one in found}
    ends: tuple[tuple[ActuatorKey | Literal["sensor_lag"], tuple[str, ...]], ...]
    ends = (("lag", (behind.input,)), (SENSOR_LAG, behind.sensors))
    for kind, names in ends if behind.input else ():
        if known.isdisjoint(names):
            (lag,) = found[0].estimates
            same = replace(lag, name=kind, term=kind)
            together = group if len(names) > 1 else 0
            for name in names:
                yield Alternative(None, kind, (same,), 0.0, channel=name, together=together)
