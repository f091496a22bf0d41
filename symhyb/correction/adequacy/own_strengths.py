"""Causes of which not all recordings share the strength, held against an unknown force alone.

A class has columns of one size in all recordings, so that none takes the place of such a cause. It
has to be likelier than a structure without it all the same: its numbers, one for each recording or
group, are priced by their priors, and what it lacks is left to the unknown force.
"""

from collections.abc import Sequence

from symhyb.correction.adequacy.followed import likeliest
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Row
from symhyb.discrepancy.places.hypotheses import Hypothesis


def by_recording(cause: Hypothesis) -> bool:
    """Whether not all recordings share the strength of a cause. A class, whose columns are of one
    size in all recordings, does not take the place of it."""
    return cause.place is not None and cause.keys[0] in cause.own


def without_own(ground: Recorded, base: Fitted, rows: Sequence[Row]) -> list[Fitted]:
    """The structure without each cause that has strengths of its own,
    with an unknown force beside the rest; ``rows`` begin the numbers, SI."""
    found = []
    for i, cause in enumerate(base.causes):
        if by_recording(cause):
            kept = [j for j in range(len(base.causes)) if j != i]
            rest = [base.causes[j] for j in kept]
            found.append(likeliest(ground, rest, [rows[j] for j in kept]))
    return found
