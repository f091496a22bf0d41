"""Which of stretch and rate a force at a place is a function of, and whether it is a smooth one."""

from collections.abc import Collection

from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.words.formula import LAW
from symhyb.model.expression import names, parse_expression
from symhyb.model.types import On
from symhyb.model.vocabulary import KINDS

_ORDERS = ((0, "stretch"), (1, "rate"))


def quantities(cause: Hypothesis) -> frozenset[str]:
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
        return frozenset(word for order, word in _ORDERS if order in orders)
    return quantities_of(cause.kind, cause.keys)


def quantities_of(kind: str, keys: Collection[str]) -> frozenset[str]:
    """The same of a law by its name, with these keys."""
    law = KINDS[kind]
    if law.switch == "touches":  # a stop, which may be damped
        return frozenset(("stretch", *(("rate",) if "damping" in keys else ())))
    if law.energy == "dissipative":
        return frozenset(("rate", *(("stretch",) if "slope" in keys else ())))
    return frozenset() if law.steady and law.at_rest else frozenset(("stretch",))


def memoryless(cause: Hypothesis) -> bool:
    """Whether a force is a function of stretch and rate alone, with a name or without."""
    law = KINDS.get(cause.kind)
    if cause.kind == LAW or cause.points:
        return True
    return law is not None and law.of_state and not (law.states or law.inertial)


def smooth(cause: Hypothesis) -> bool:
    """Whether a force with a name is a smooth function of them: without memory, without a jump,
    which no smooth force has."""
    named = cause.kind != LAW and not cause.points
    return named and memoryless(cause) and (cause.bent or not KINDS[cause.kind].steep)
