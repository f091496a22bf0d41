"""Whether an input that does not act as recorded is one behind an actuator with a name, and whether
what lags is it or a sensor.

    class > actuators           it is the answer: the input does not act in proportion, or lags
    actuator ≥ class            a dead band, a limit, a rate limit or a lag explains as much

A class that is not certain, or explains only the better part, has to be beaten, to 100 to 1. All
are compared by the evidence of the innovations along whole recordings. Where two of them are as
likely, to 100 to 1, neither is named and the class stays. A lag is raced against that of every
sensor, and that of a sensor against that of every input: along all of the recordings, and without
their beginnings, for an actuator begins as if the first value had acted for long, and the lag of a
sensor anywhere.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.input_actuated import likeliest_number
from symhyb.correction.adequacy.classes.worth import Around, around
from symhyb.correction.adequacy.explained import decided, remainder
from symhyb.correction.adequacy.followed import fitted_on, likeliest, part_of
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.late import lagging_sensors, with_late_input, with_late_sensors
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.correction.adequacy.ways import later, same_way, shown_sensors
from symhyb.correction.search.trajectory import firsts_of, grouped, late_sensors
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import CERTAIN, HOPELESS, NEGLIGIBLE, PROBABLE, SMALL
from symhyb.model.actuators import ACTUATOR_KEYS, SENSOR_LAG, ActuatorKey

TOGETHER = 2  # numbers of an actuator at most, that stand for a class
SETTLED = 10.0  # time constants, after which 5e-5 is left of where a lag began


class Behind(NamedTuple):
    """Structures with an actuator behind an input, or a sensor that lags, that explain as well as
    each other, the likeliest first, and ``sensors`` that may be what lags; ``input`` is the one
    that may lag instead of all of them where no recording of the machine shows which does."""

    trials: tuple[Fitted, ...] = ()
    sensors: tuple[str, ...] = ()
    input: str = ""


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


def lagging_sensor(judged: Adequacy) -> str | None:
    """The sensor that lags, most likely; None where that is not the answer."""
    best = judged.classes[0].generic if judged.classes else None
    lags = best is not None and best.kind == "sensor" and best.does == "lags"
    return str(best.where) if best is not None and lags else None


def _acts_otherwise(generic: Generic) -> bool:
    """Whether a class says that an input acts by a function of itself, or as behind an actuator."""
    return generic.kind in ("input", "lag") and generic.does in ("", *ACTUATOR_KEYS)


def _certain(judged: Adequacy, name: str) -> bool:
    """Whether it is certain that an input acts so, or that a sensor lags, and that this explains
    all."""
    first = judged.classes[0].generic
    here = [one for one in judged.classes if one.generic.where == name]
    ways = [one for one in here if _acts_otherwise(one.generic)]
    if first.kind == "sensor":
        ways = [one for one in here if one.generic.key == first.key]
    return ways[0].whole and sum(one.probability for one in ways) > PROBABLE


def instead_of_class(ground: Recorded, judged: Adequacy) -> Behind:
    """The structures, along whole recordings, that explain by an actuator what was judged to be an
    input that acts otherwise than recorded, or by a lag what was judged to be that of a sensor:
    one, or those that are as likely; none where none does."""
    name = deviating_input(judged) or lagging_sensor(judged)
    base, by_class = judged.structure, judged.by_class
    if name is None or base is None or by_class is None:
        return NOTHING_BEHIND
    left = decided(ground, base, judged.beyond.acts)
    margin = -CERTAIN if _certain(judged, name) else CERTAIN
    least = max(by_class.evidence + margin, base.evidence + CERTAIN)

    def explains(trial: Fitted) -> bool:
        return trial.evidence > least and left.explained_by(ground, trial, SMALL)

    bases = list(_bases(ground, by_class, name))
    late = judged.classes[0].generic.sensors or lagging_sensor(judged)
    best = [] if lagging_sensor(judged) else _behind(ground, bases, name)
    best = _as_likely(_ranked((*best, *(_with_late(ground, bases) if late else ()))))
    good = tuple(filter(explains, best))
    if not good:
        return NOTHING_BEHIND
    return _distinguished(ground, good)


def _behind(ground: Recorded, bases: Sequence[Fitted], name: str) -> list[Fitted]:
    """The likeliest structures with numbers of the actuator of an input, those that are as likely
    as each other."""
    best: list[Fitted] = []
    for _ in range(TOGETHER):
        found = _fitted(ground, bases, name)
        if not found or (best and found[0].evidence < best[0].evidence + CERTAIN):
            break
        best = _as_likely(found)
        if np.all(remainder(ground, best[0]) <= NEGLIGIBLE**2):
            break
        bases = best[:1]
    return best


def _with_late(ground: Recorded, bases: Sequence[Fitted]) -> list[Fitted]:
    """Structures with sensors that lag."""
    return [one for bare in bases for one in with_late_sensors(ground, around(ground, bare), bare)]


def _ranked(trials: Iterable[Fitted]) -> list[Fitted]:
    """The likeliest first."""
    return sorted(trials, key=lambda trial: -trial.evidence)


def _distinguished(ground: Recorded, good: tuple[Fitted, ...]) -> Behind:
    """The structures that explain, with what may lag in place of the likeliest of them, if a lag is
    all that it has: sensors in place of an input, inputs in place of sensors. Of all these those
    that are as likely; where no recording of the machine distinguishes them the likeliest."""
    best = good[0]
    late, own = lagging_sensors(best), _numbers(best)
    if len(own) != 1 or own[0].kind not in ("lag", SENSOR_LAG):
        return Behind(good)
    model = ground.windows.machine.model
    shown = shown_sensors(ground)
    for i, one in enumerate(model.recorded_inputs):
        same = tuple(model.sensors[j].name for j in same_way(ground.windows.machine, i, shown))
        if same and (late == same or own[0].path == f"{one.name}.lag"):
            return Behind((best,), same, one.name)
    bare = part_of(ground, best, lambda cause: cause != own[0])
    found = _as_likely(_ranked((*good, *_rivals(ground, bare))))
    if len(found) == 1 and lagging_sensors(found[0]):
        time_s = float(found[0].fit.values[firsts_of(found[0].causes)[-1]])
        settled = later(ground, SETTLED * time_s)
        if settled is None:
            return NOTHING_BEHIND
        again = part_of(settled, best, lambda cause: cause != own[0])
        held = _as_likely(_ranked(_rivals(settled, again)))
        if {*map(_keys, held)} != {_keys(found[0])}:
            found = held
    sensors = dict.fromkeys(one for trial in found for one in lagging_sensors(trial))
    return Behind(tuple(found), tuple(sensors) if len(found) > 1 else ())


def _rivals(ground: Recorded, bare: Fitted) -> list[Fitted]:
    """A structure with each input and each sensor lagging, and all sensors alike."""
    here = around(ground, bare)
    names = [one.name for one in ground.windows.machine.model.recorded_inputs]
    inputs = (with_late_input(ground, here, bare, name) for name in names)
    return [*filter(None, inputs), *with_late_sensors(ground, here, bare)]


def _as_likely(found: Sequence[Fitted]) -> list[Fitted]:
    """The first structure and those with other numbers of the actuator that are as likely, the
    likeliest of each."""
    each: dict[frozenset[str], Fitted] = {}
    for trial in found:
        if trial.evidence > found[0].evidence - CERTAIN:
            each.setdefault(_keys(trial), trial)
    return list(each.values())


def _keys(trial: Fitted) -> frozenset[str]:
    """What actuators and sensors that lag do in a structure."""
    return frozenset(" ".join((one.path, *late_sensors(one))) for one in _numbers(trial))


def _numbers(trial: Fitted) -> list[Hypothesis]:
    """The numbers of actuators among the causes, and those of sensors that lag."""
    return [cause for cause in trial.causes if cause.kind in (*ACTUATOR_KEYS, SENSOR_LAG)]


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
    mine = [one for one in every if not late_sensors(one[0])]
    others = [one for one in mine if not one[0].path.startswith(f"{name}.")]
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
