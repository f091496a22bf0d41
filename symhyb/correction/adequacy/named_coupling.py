"""Whether a coupling of two coordinates is one of the laws of a pair, or several of them together.

    class > listed laws         it is the answer: two coordinates act on each other
    laws of the pair ≥ class    few of the four explain as much: they are gyroscopic, circulatory,
                                a coupling stiffness, a coupling damping

The forces of the class, each coordinate by the place and the rate of the other, are any sum of
these four. One more is tried as long as the structure is more likely by 100 to 1. A stiffness or a
damping that acts one way and not back is the half sum of a symmetric and an antisymmetric one: two
that are as large as each other within three deviations are no pair of laws, and the class stays.
All are compared by the evidence of the innovations along whole recordings.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.curves.products import products_of, solved
from symhyb.correction.adequacy.explained import decided
from symhyb.correction.adequacy.followed import fitted_on, part_of
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.pairs import PAIR_LAWS, coupled, pair_forces, pair_size
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Row
from symhyb.correction.search.trajectory import firsts_of, grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import CERTAIN, HOPELESS, OUTSTANDING, SMALL
from symhyb.model.types import On, Pair

BEGINNINGS = 2  # of laws that are fitted beside the others: the best of the linear problem
ONE_WAY = (("skew_spring", "circulatory"), ("skew_damper", "gyroscopic"))
"""A symmetric and an antisymmetric law of the same quantity."""


class _Offer(NamedTuple):
    """A law of a pair with its number, SI, and what it is worth in ln evidence in the linear
    problem."""

    cause: Hypothesis
    row: Row
    worth: float


def pair_of(judged: Adequacy) -> Pair | None:
    """The coordinates that act on each other for certain; None where that is not the answer."""
    place = judged.certain("coupling")
    other = judged.classes[0].generic.other if judged.classes else ""
    return Pair(place.coordinate, other) if isinstance(place, On) and other else None


def couplings_instead(ground: Recorded, judged: Adequacy) -> Fitted | None:
    """The structure, along whole recordings, that explains by laws of a pair what was judged to be
    a coupling; None where none does as well."""
    pair, base, by_class = pair_of(judged), judged.structure, judged.by_class
    if pair is None or base is None or by_class is None:
        return None
    left = decided(ground, base, judged.beyond.acts)
    found = [
        trial
        for start in _starts(ground, base, by_class, pair)
        if (trial := _with_laws(ground, start, pair)) is not None
    ]
    best = max(found, key=lambda trial: trial.evidence, default=None)
    if best is None or best.evidence <= max(by_class.evidence - CERTAIN, base.evidence + CERTAIN):
        return None
    if one_way(best, pair):
        return None
    return best if left.explained_by(ground, best, SMALL) else None


def _starts(ground: Recorded, base: Fitted, by_class: Fitted, pair: Pair) -> Iterator[Fitted]:
    """What laws are tried beside: the causes that were kept beside the class, and all that were
    decided, without laws of this pair."""
    known: set[frozenset[Hypothesis]] = set()
    for structure in (by_class, base):
        causes = frozenset(cause for cause in structure.causes if cause.place != pair)
        if causes not in known:
            known.add(causes)
            start = part_of(ground, structure, causes.__contains__)
            yield from () if start.fit.reason else (start,)


def _with_laws(ground: Recorded, start: Fitted, pair: Pair) -> Fitted | None:
    """A structure with as many laws of a pair as are each more likely by 100 to 1; None where not
    even one is."""
    best = start
    for _ in PAIR_LAWS:
        tried = [_beside(ground, best, offer) for offer in _offers(ground, best, pair)]
        one = max(tried, key=lambda trial: trial.evidence, default=None)
        if one is None or one.evidence <= best.evidence + CERTAIN:
            break
        best = one
    return None if best is start else _needed(ground, best, pair)


def _needed(ground: Recorded, trial: Fitted, pair: Pair) -> Fitted:
    """A structure without those of several laws of a pair that it has become as likely without."""
    mine = [i for i, cause in enumerate(trial.causes) if cause.place == pair]
    for i in mine if len(mine) > 1 else ():
        rest = [j for j in range(len(trial.causes)) if j != i]
        rows = grouped(trial)
        causes = [trial.causes[j] for j in rest]
        less = fitted_on(ground, trial, causes, [rows[j] for j in rest])
        if less.evidence >= trial.evidence - CERTAIN:
            return _needed(ground, less, pair)
    return trial


def _beside(ground: Recorded, start: Fitted, offer: _Offer) -> Fitted:
    causes, rows = (*start.causes, offer.cause), [*grouped(start), offer.row]
    return fitted_on(ground, start, causes, rows)


def _offers(ground: Recorded, start: Fitted, pair: Pair) -> list[_Offer]:
    """The laws of a pair that are worth most beside a structure."""
    causes = [coupled(law.name, pair) for law in PAIR_LAWS]
    causes = [cause for cause in causes if cause not in start.causes]
    sizes = [pair_size(ground, cause) for cause in causes]
    each = zip(*(pair_forces(ground, cause) for cause in causes), strict=True)
    forces = [np.stack(columns, axis=2) for columns in each]
    products = products_of(ground, start, forces) if causes else ()
    offers = []
    for i, (cause, size) in enumerate(zip(causes, sizes, strict=True)):
        worth, number = max(solved(gram, more, i, size) for gram, more in products)
        offers.append(_Offer(cause, {cause.keys[0]: number}, worth))
    offers.sort(key=lambda one: -one.worth)
    return [one for one in offers[:BEGINNINGS] if one.worth > offers[0].worth - HOPELESS]


def one_way(trial: Fitted, pair: Pair) -> bool:
    """Whether the laws of a pair say, within three deviations, that one coordinate acts on the
    other and not back."""
    firsts = dict(zip(trial.causes, firsts_of(trial.causes), strict=True))
    for kinds in ONE_WAY:
        causes = [coupled(kind, pair) for kind in kinds]
        if not {*causes} <= firsts.keys():
            continue
        i, j = (firsts[cause] for cause in causes)
        values, spread = trial.fit.values, trial.fit.covariance
        sizes = abs(values[i]), abs(values[j])
        sign = np.sign(values[i] * values[j])
        variance = spread[i, i] + spread[j, j] - 2 * sign * spread[i, j]
        if abs(sizes[0] - sizes[1]) <= OUTSTANDING * np.sqrt(max(variance, 0.0)):
            return True
    return False
