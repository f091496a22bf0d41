"""Laws of one quantity at one place, held against a smooth function of it that has no name.

Smooth laws by name, a few of them together or one that bends, follow almost any function within the
range that was seen: a spring, a softening cubic and a ripple are a spring that saturates. So their
sum is physics only if it is likelier than any smooth function, also where nothing acts beyond it.
What jumps, friction or a stop, may stay beside the function.
"""

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

from symhyb.correction.adequacy.classes.law import law
from symhyb.correction.adequacy.classes.worth import around, worth_of
from symhyb.correction.adequacy.followed import fitted_on, part_of
from symhyb.correction.adequacy.own_strengths import by_recording
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import memoryless, quantities, smooth
from symhyb.judgement import HOPELESS
from symhyb.model.types import Place

Quantity = Literal["stretch", "rate"]
QUANTITIES: tuple[Quantity, ...] = ("stretch", "rate")


class Sum(NamedTuple):
    """The ``laws`` of one quantity (``over``) at one place that a smooth function may be in place
    of."""

    place: Place
    over: Quantity
    laws: frozenset[Hypothesis]


def is_sum(laws: Sequence[Hypothesis]) -> bool:
    """Whether laws of one quantity at one place have a shape of their own: two numbers or more,
    beside a constant. One number is the size of a shape that its law has by itself."""
    return sum(cause.numbers for cause in laws if quantities(cause)) > 1


def of_one(cause: Hypothesis, place: Place, over: str) -> bool:
    """Whether a law with a name is at a place and a function of one quantity alone."""
    mine = cause.place == place and not cause.points and memoryless(cause)
    return mine and quantities(cause) <= {over}


def sums_of(causes: Sequence[Hypothesis]) -> Iterator[Sum]:
    """The laws of one quantity at one place whose smooth ones have a shape together: these, and
    all, if some of them jump. What jumps alone is no smooth function."""
    shared = [cause for cause in causes if cause.place is not None and not by_recording(cause)]
    for place in dict.fromkeys(cause.place for cause in shared):
        for over in QUANTITIES:
            assert place is not None
            every = [cause for cause in shared if of_one(cause, place, over)]
            flat = [cause for cause in every if smooth(cause)]
            if not is_sum(flat):
                continue
            for laws in dict.fromkeys((frozenset(flat), frozenset(every))):
                yield Sum(place, over, laws)


def functions_instead(ground: Recorded, base: Fitted) -> list[Fitted]:
    """A structure with a smooth function of one quantity in place of the laws that have a shape
    together, of each of them; of those that are not predicted to be far less likely."""
    found = []
    for one in sums_of(base.causes):
        kept = frozenset(base.causes) - one.laws
        start = part_of(ground, base, kept.__contains__)
        if start.fit.reason or one.place not in ground.library.places:
            continue
        here = around(ground, start)
        generic = law(here, ground.library.places.index(one.place), one.over)
        if start.evidence + worth_of(here, generic) > base.evidence - HOPELESS:
            found.append(fitted_on(ground, start, start.causes, grouped(start), generic))
    return found
