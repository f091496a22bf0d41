"""What may be a part of a force that has no name.

A force without a name is found as an own curve or as an empirical law. Beside it, how much of the
whole is a law by name, or a number of the model that differs, is a matter of how the rest is
written: viscous damping and a curve over the rate are one force. A class says less: it may be a
small remainder beside a law that is right, as it is along most real recordings.
"""

from collections.abc import Sequence

from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.words.formula import LAW
from symhyb.model.expression import names, parse_expression
from symhyb.model.types import On, Place
from symhyb.model.vocabulary import KINDS


def parts_of_unnamed(causes: Sequence[Hypothesis], certain: bool) -> frozenset[Hypothesis]:
    """The causes that may be parts of own curves and empirical laws beside them, or of a class, if
    one is ``certain``: numbers of the model or of a channel, whose effect any of them may hold a
    part of, and smooth laws at the place of a curve or an empirical law of the same quantities. An
    empirical law beside any of these is one way to write the whole, and a part itself."""
    numbers = [cause for cause in causes if cause.place is None]
    parts = set(numbers if certain else ())
    for cause in causes:
        if cause.place is None or not (cause.points or cause.kind == LAW):
            continue
        beside = {*numbers, *_smooth_laws(causes, cause.place, _quantities(cause))}
        parts |= beside | ({cause} if beside and cause.kind == LAW else set())
    return frozenset(parts)


def _smooth_laws(
    causes: Sequence[Hypothesis], place: Place, quantities: frozenset[str]
) -> set[Hypothesis]:
    """The laws by name at a place that are smooth functions of these quantities: without memory,
    without a jump, which no smooth force has."""
    found = set()
    for cause in causes:
        law = KINDS.get(cause.kind)
        if law is None or cause.place != place or cause.points or cause.kind == LAW:
            continue
        smooth = law.of_state and not (law.state or law.inertial or law.steep)
        if smooth and _quantities(cause) <= quantities:
            found.add(cause)
    return found


def _quantities(cause: Hypothesis) -> frozenset[str]:
    """What a force changes with: ``stretch``, ``rate``, or both. A curve that is a factor of the
    speed may hold a damper, and no spring."""
    if cause.points:
        words = dict(cause.options)
        return frozenset(("rate" if "times" in words else words["over"],))
    if cause.kind == LAW and isinstance(cause.place, On):
        orders = {
            name.order
            for name in names(parse_expression(cause.path))
            if name.name == cause.place.coordinate
        }
        return frozenset(word for order, word in ((0, "stretch"), (1, "rate")) if order in orders)
    law = KINDS[cause.kind]
    if law.energy == "dissipative":
        return frozenset(("rate",))
    return frozenset() if law.steady and law.at_rest else frozenset(("stretch",))
