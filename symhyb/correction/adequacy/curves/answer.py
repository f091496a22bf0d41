"""Whether a force of stretch and rate, that no listed law is, is a curve over one of the two, or a
curve over the stretch that is a factor of the speed.

    class > listed laws         it is the answer: a force of stretch and rate at a place
    curve ≥ class               one curve explains as much: it is an own curve
    listed ≥ curve              laws by name do as well in its place: they are the answer

Where laws by name are less likely than the curve, but not by 100 to 1, neither is, and the class
stays. All are compared by the evidence of the innovations along whole recordings.
"""

from symhyb.correction.adequacy.curves.courses import FORMS
from symhyb.correction.adequacy.curves.fitted_curve import Offer, beside, offered
from symhyb.correction.adequacy.curves.listed import listed
from symhyb.correction.adequacy.explained import Decided, remainder
from symhyb.correction.adequacy.followed import likeliest, scored
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.correction.search.trajectory import grouped
from symhyb.judgement import CERTAIN, HOPELESS, PROBABLE, SMALL
from symhyb.model.types import Place


def is_law(judged: Adequacy) -> Place | None:
    """The place at which a force of stretch and rate explains all that acts, for certain; None
    where that is not the answer."""
    best = judged.classes[0] if judged.classes else None
    if best is None or best.generic.kind != "law" or isinstance(best.generic.where, str):
        return None
    certain = best.whole and best.probability > PROBABLE
    return best.generic.where if certain else None


def instead_of_class(ground: Recorded, judged: Adequacy) -> Fitted | None:
    """The structure, along whole recordings, that explains by a curve, or by listed laws that are
    as good, what was judged to be a force of stretch and rate; None where none does."""
    place, base, by_class = is_law(judged), judged.structure, judged.by_class
    if place is None or base is None or by_class is None or place not in ground.library.places:
        return None
    every = zip(by_class.causes, grouped(by_class), strict=True)
    elsewhere = [(cause, row) for cause, row in every if cause.place != place]
    bare = likeliest(ground, [one for one, _ in elsewhere], [row for _, row in elsewhere])
    if bare.fit.reason:
        return None
    least = by_class.evidence - CERTAIN
    promising = _promising(ground, bare, place, least)
    found = [(beside(ground, bare, offer), offer) for offer in promising]
    decided = Decided(base, remainder(ground, base), judged.beyond.acts)
    curves = [
        (trial, offer)
        for trial, offer in found
        if trial.evidence > max(least, base.evidence + CERTAIN)
        and remainder(ground, trial) <= decided.may_leave(trial, SMALL)
    ]
    if not curves:
        return None
    curve, offer = max(curves, key=lambda pair: pair[0].evidence)
    named = _by_name(ground, bare, curve, offer)
    if named is None or curve.evidence > named.evidence + CERTAIN:
        return curve
    return named if named.evidence >= curve.evidence else None


def _promising(ground: Recorded, bare: Fitted, place: Place, least: float) -> list[Offer]:
    """Curves of all forms that may reach an evidence."""
    which = ground.library.places.index(place)
    offers = [one for form in FORMS if (one := offered(ground, bare, which, form)) is not None]
    offers.sort(key=lambda one: -one.worth)
    return [one for one in offers if bare.evidence + one.worth > least - HOPELESS]


def _by_name(ground: Recorded, bare: Fitted, curve: Fitted, offer: Offer) -> Fitted | None:
    """The most likely structure with listed laws in the place of a curve."""
    trials = []
    for one in listed(ground, offer.line):
        causes, rows = (*bare.causes, *one.causes), [*grouped(bare), *one.rows]
        noise = ground.revived(curve.fit.noise)
        trials.append(scored(ground, fitted(ground, causes, rows, noise, curve.fit.states)))
    return max(trials, key=lambda trial: trial.evidence, default=None)
