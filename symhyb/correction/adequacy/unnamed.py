"""What may be a part of a force that has no name.

A force without a name is found as an own curve or as an empirical law. Beside it, how much of the
whole is a law by name, or a number of the model that differs, is a matter of how the rest is
written: viscous damping and a curve over the rate are one force. A bent law, which takes on shapes
between those of simpler ones, is another curve by its name. A class says less: it may be a
small remainder beside a law that is right, as it is along most real recordings. But a number of the
model at its own place is one with it: a mode rides on a spring and a damper of its own.
"""

from collections.abc import Sequence

from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import quantities, smooth
from symhyb.discrepancy.places.standing import numbers_over
from symhyb.discrepancy.words.formula import LAW
from symhyb.judgement import LIKELY
from symhyb.model.types import Model, Place


def parts_of_unnamed(causes: Sequence[Hypothesis], certain: bool) -> frozenset[Hypothesis]:
    """The causes that may be parts of own curves and empirical laws beside them, or of a class, if
    one is ``certain``: numbers of the model or of a channel, whose effect any of them may hold a
    part of, smooth laws at the place of a curve or an empirical law of the same quantities, and
    bent ones there of any. An empirical law beside any of these is one way to write the whole, and
    a part itself."""
    numbers = [cause for cause in causes if cause.place is None]
    parts = set(numbers if certain else ())
    for cause in causes:
        if cause.place is None or not (cause.points or cause.kind == LAW):
            continue
        beside = {*numbers, *_smooth_laws(causes, cause.place, quantities(cause))}
        parts |= beside | ({cause} if beside and cause.kind == LAW else set())
    return frozenset(parts)


def parts_of_bent(model: Model, causes: Sequence[Hypothesis]) -> frozenset[Hypothesis]:
    """The numbers that may be parts of a bent law: those of an element of the model at its place,
    over the same of stretch and rate. A bent law takes on shapes between those of simpler ones, so
    that how much of the whole is a damper is a matter of which bend it is."""
    found: set[Hypothesis] = set()
    for cause in causes:
        if cause.bent and cause.place is not None:
            paths = numbers_over(model, cause.place, quantities(cause))
            found |= {one for one in causes if one.place is None and one.path in paths}
    return frozenset(found)


def parts_of_class(
    model: Model, causes: Sequence[Hypothesis], classes: Sequence[Likely]
) -> frozenset[Hypothesis]:
    """The numbers that may be parts of a mode or a force of stretch and rate that is likelier than
    not: those of an element of the model at its place, over the same of stretch and rate."""
    paths: set[str] = set()
    for generic, probability, *_ in classes:
        if generic.kind not in ("hidden mode", "law") or isinstance(generic.where, str):
            continue
        if probability > LIKELY:
            known = frozenset((generic.over,) if generic.over else ("stretch", "rate"))
            paths |= numbers_over(model, generic.where, known)
    return frozenset(one for one in causes if one.place is None and one.path in paths)


def changing_themselves(
    causes: Sequence[Hypothesis], classes: Sequence[Generic]
) -> frozenset[Hypothesis]:
    """The numbers that a class says to change along the recordings: a gain of a channel that acts
    by a factor which changes, an offset of a sensor that drifts, a parameter that changes with
    time. Such a number has no one value."""
    kinds = {"fades": "gain", "drifts": "offset"}
    moving = set()
    for one in classes:
        if one.kind == "time-varying":
            moving.add(one.where)
        elif one.does in kinds:
            moving.add(f"{one.where}.{kinds[one.does]}")
    return frozenset(one for one in causes if one.place is None and one.path in moving)


def _smooth_laws(
    causes: Sequence[Hypothesis], place: Place, known: frozenset[str]
) -> set[Hypothesis]:
    """The laws by name at a place that are smooth functions of these quantities, or bent."""
    return {
        cause
        for cause in causes
        if cause.place == place and smooth(cause) and (cause.bent or quantities(cause) <= known)
    }
