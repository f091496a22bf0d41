"""Whether an input that does not act as recorded is one behind an actuator with a name.

    class > actuators           it is the answer: the input does not act in proportion, or lags
    actuator ≥ class            a dead band, a limit, a rate limit or a lag explains as much

A class that is not certain, or explains only the better part, has to be beaten, to 100 to 1. All
are compared by the evidence of the innovations along whole recordings. Where two of them are as
likely, to 100 to 1, neither is named and the class stays.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.input_actuated import likeliest_number
from symhyb.correction.adequacy.classes.input_lag import input_lag
from symhyb.correction.adequacy.classes.sensor_lag import sensor_lag
from symhyb.correction.adequacy.classes.worth import Around, around
from symhyb.correction.adequacy.explained import Decided, remainder
from symhyb.correction.adequacy.followed import fitted_on, likeliest
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import CERTAIN, HOPELESS, NEGLIGIBLE, PROBABLE, SMALL
from symhyb.model.actuators import ACTUATOR_KEYS, ActuatorKey
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.linear import linear
from symhyb.numeric.lowered.machine import Machine

TOGETHER = 2  # numbers of an actuator at most, that stand for a class


class Behind(NamedTuple):
    """Structures with an actuator behind an input that explain as well as each other, the likeliest
    first, and ``sensors`` that may lag instead of it; ``always`` where no recording of the machine
    shows which of them does."""

    trials: tuple[Fitted, ...] = ()
    sensors: tuple[str, ...] = ()
    always: bool = False


NOTHING_BEHIND = Behind()


class Offer(NamedTuple):
    """A number of an actuator as a cause, where its fit begins (``value``, SI), and what it is
    ``worth`` in ln evidence in the linear problem."""

    cause: Hypothesis
    value: float
    worth: float


def deviating_input(judged: Adequacy) -> str | None:
    """The input that acts, most likely, by a function of itself or through a lag; None where that
    is not the answer."""
    best = judged.classes[0].generic if judged.classes else None
    if best is None or not _acts_otherwise(best):
        return None
    return best.where if isinstance(best.where, str) else None


def late_input(judged: Adequacy, machine: Machine) -> str | None:
    """The input that may lag as well as the sensor that is the answer: of a linear machine with one
    input the two are the same, also where a controller drives it, for its output was recorded."""
    best = judged.classes[0].generic if judged.classes else None
    lags = best is not None and best.kind == "sensor" and best.does == "lags"
    return machine.model.recorded_inputs[0].name if lags and _one_path(machine) else None


def _one_path(machine: Machine) -> bool:
    """Whether a lag on the way in shows as the same lag on the way out."""
    return len(machine.model.recorded_inputs) == 1 and linear(state_form(machine))


def _acts_otherwise(generic: Generic) -> bool:
    """Whether a class says that an input acts by a function of itself, or as behind an actuator."""
    return generic.kind in ("input", "lag") and generic.does in ("", *ACTUATOR_KEYS)


def _certain(judged: Adequacy, name: str) -> bool:
    """Whether it is certain that an input acts so, and that this explains all."""
    first = judged.classes[0].generic
    here = [one for one in judged.classes if one.generic.where == name]
    ways = [one for one in here if _acts_otherwise(one.generic)]
    if first.kind == "sensor":
        ways = [one for one in judged.classes if one.generic.key == first.key]
    return ways[0].whole and sum(one.probability for one in ways) > PROBABLE


def instead_of_class(ground: Recorded, judged: Adequacy) -> Behind:
    """The structures, along whole recordings, that explain by an actuator what was judged to be an
    input that acts otherwise than recorded: one, or those that are as likely; none where none
    does."""
    name = deviating_input(judged) or late_input(judged, ground.windows.machine)
    base, by_class = judged.structure, judged.by_class
    if name is None or base is None or by_class is None:
        return NOTHING_BEHIND
    decided = Decided(base, remainder(ground, base), judged.beyond.acts)
    margin = -CERTAIN if _certain(judged, name) else CERTAIN
    least = max(by_class.evidence + margin, base.evidence + CERTAIN)

    def explains(trial: Fitted) -> bool:
        small = remainder(ground, trial) <= decided.may_leave(trial, SMALL)
        return small and trial.evidence > least

    best: list[Fitted] = []
    bases = begin = list(_bases(ground, by_class, name))
    for _ in range(TOGETHER):
        found = _fitted(ground, bases, name)
        if not found or (best and found[0].evidence < best[0].evidence + CERTAIN):
            break
        best = _as_likely(found)
        if remainder(ground, best[0]) <= NEGLIGIBLE**2:
            break
        bases = best[:1]
    good = tuple(filter(explains, best))
    if not good:
        return NOTHING_BEHIND
    return Behind(good, *_lagging(ground, begin[-1], good[0], name))


def _lagging(
    ground: Recorded, bare: Fitted, best: Fitted, name: str
) -> tuple[tuple[str, ...], bool]:
    """The sensors that may lag instead of the input, where a lag is all that its actuator does, and
    whether always: of a linear machine with one input the two are the same, of others the classes
    of both may be as likely."""
    model = ground.windows.machine.model
    if _keys(best) != {f"{name}.lag"}:
        return (), False
    shown = [
        j
        for j in range(len(model.sensors))
        if any(np.isfinite(item.block.y[0][:, j]).any() for item in ground.items)
    ]
    if len(shown) > 1 and len(model.recorded_inputs) > 1:
        return (), False
    if _one_path(best.machine):
        return tuple(model.sensors[j].name for j in shown), True
    here = around(ground, bare)

    def reached(generic: Generic) -> float:
        return fitted_on(ground, bare, bare.causes, grouped(bare), generic).evidence

    least = reached(input_lag(here, model.inputs.names().index(name))) - CERTAIN
    alike = [j for j in shown if reached(sensor_lag(here, j)) > least]
    return tuple(model.sensors[j].name for j in alike), False


def _as_likely(found: Sequence[Fitted]) -> list[Fitted]:
    """The first structure and those with other numbers of the actuator that are as likely, the
    likeliest of each."""
    each: dict[frozenset[str], Fitted] = {}
    for trial in found:
        if trial.evidence > found[0].evidence - CERTAIN:
            each.setdefault(_keys(trial), trial)
    return list(each.values())


def _keys(trial: Fitted) -> frozenset[str]:
    """The numbers of actuators among the causes."""
    return frozenset(cause.path for cause in trial.causes if cause.kind in ACTUATOR_KEYS)


def _fitted(ground: Recorded, bases: Sequence[Fitted], name: str) -> list[Fitted]:
    """Structures with one more number of the actuator of an input, those of which the linear
    problem predicts enough; the likeliest first."""
    offers = []
    for bare in bases:
        here = around(ground, bare)
        more = offered(ground, here, name, bare)
        offers += [(bare.evidence + one.worth, bare, one) for one in more]
    offers.sort(key=lambda one: -one[0])
    found: list[Fitted] = []
    for predicted, bare, offer in offers:
        reached = max((trial.evidence for trial in found), default=-np.inf)
        if predicted > reached - HOPELESS:
            found.append(beside(ground, bare, offer))
    return sorted(found, key=lambda trial: -trial.evidence)


def _bases(ground: Recorded, by_class: Fitted, name: str) -> Iterator[Fitted]:
    """What may stand beside the actuator: the causes that stand beside the class but faults of the
    same input, those of them that are laws, none."""
    every = list(zip(by_class.causes, grouped(by_class), strict=True))
    others = [one for one in every if not one[0].path.startswith(f"{name}.")]
    laws = [one for one in others if one[0].place is not None]
    tried = []
    for kept in (others, laws, []):
        causes = tuple(cause for cause, _ in kept)
        if causes in tried:
            continue
        tried.append(causes)
        bare = likeliest(ground, causes, [row for _, row in kept])
        if not bare.fit.reason:
            yield bare


def beside(ground: Recorded, start: Fitted, offer: Offer) -> Fitted:
    """A structure with a number of an actuator behind its causes, fitted along whole recordings
    from where that ended."""
    causes = (*start.causes, offer.cause)
    rows = [*grouped(start), {"value": offer.value}]
    return fitted_on(ground, start, causes, rows)


def offered(ground: Recorded, here: Around, name: str, beside: Fitted) -> list[Offer]:
    """Each number that an actuator of an input may have more than the model and a structure state,
    with the value that is worth most."""
    model = ground.windows.machine.model
    which = model.inputs.names().index(name)
    actuator = beside.machine.model.inputs[which].actuator
    stated = {one.name: float(beside.p[beside.machine.column(one.path)]) for one in actuator}
    found = []
    for key in ACTUATOR_KEYS:
        if key in stated:
            continue
        generic, worth = likeliest_number(here, which, key, stated)
        value = generic.figure
        found.append(Offer(_cause(name, key, value), value, worth))
    return found


def _cause(name: str, key: ActuatorKey, value: float) -> Hypothesis:
    return Hypothesis(
        key, None, ("value",), (True,), shape=(("value", value),), path=f"{name}.{key}"
    )
