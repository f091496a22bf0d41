"""Play in a spring of the model, as a cause that a watch holds against a block.

A spring with play p to each side exerts −k (s − p sgn s) where it is stretched further than that.
It lacks k p sgn s of what the model says, to first order in p: one column of unit p.
"""

from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.stiffness import stiffness_at
from symhyb.discrepancy.words.formula import LAW
from symhyb.laws import play
from symhyb.model.types import Model, On, place_text
from symhyb.model.vocabulary import stretch_unit
from symhyb.monitoring.events import Amount


def plays(model: Model) -> tuple[Hypothesis, ...]:
    """Play in the springs at each place of the model whose stiffness is a number above 0. Springs
    between points have none: their formula would need the distance."""
    places = {
        one.place: f"sign({one.place.expression.text})"
        for one in model.elements
        if one.kind == "spring" and isinstance(one.place, On) and stiffness_at(model, one.place) > 0
    }
    return tuple(
        Hypothesis(LAW, place, ("coefficient",), (False,), path=formula)
        for place, formula in places.items()
    )


def is_law(cause: Hypothesis) -> bool:
    """Whether a cause is the law of the list: its force is linear in a stiffness, which does not
    change as play appears. A watch has the column above in its place."""
    return cause.kind == play.LAW.name


def is_play(cause: Hypothesis) -> bool:
    """Whether a cause of a watch is play: no other is a formula."""
    return cause.kind == LAW


def play_of(model: Model, cause: Hypothesis, size: float, sd: float) -> Amount:
    """The clearance to each side, in the unit of the model file, that a change of the coefficient
    by ``size`` with deviation ``sd``, SI, is."""
    assert isinstance(cause.place, On)
    unit = stretch_unit(model, cause.place)
    force = stiffness_at(model, cause.place) * unit.factor
    return Amount("clearance", -size / force, sd / force, unit.text)


def play_phrase(cause: Hypothesis) -> str:
    """Name such a cause: ``play in the spring on x``."""
    assert cause.place is not None
    return f"play in the spring {place_text(cause.place)}"
