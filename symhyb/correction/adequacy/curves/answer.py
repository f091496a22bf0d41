"""Whether a force of stretch and rate, that no listed law is, is a curve over one of the two, or a
curve over the stretch that is a factor of the speed, or one over each: their sum, or their product.

    class > listed laws         it is the answer: a force of stretch and rate at a place
    curve ≥ class               one curve explains as much: it is an own curve
    curve + curve ≥ class       no one curve does, and the sum of one over each does
    curve · curve ≥ class       nor does a sum, and a product does
    listed ≥ curve              a law by name does as well in its place: it is the answer
    listed > curve              so are laws that have a shape of their own, if they are likelier

Where a law by name is less likely than the curve, but not by 100 to 1, neither is, and the class
stays. Several laws of one quantity, or one that bends, follow almost any curve: they have to be
likelier than it. All are compared by the evidence of the innovations along whole recordings.
"""

from collections.abc import Sequence
from dataclasses import replace

from symhyb.correction.adequacy.curves.courses import ALONE, FORMS, Form, form_of
from symhyb.correction.adequacy.curves.fitted_curve import Offer, beside, offered
from symhyb.correction.adequacy.curves.listed import listed
from symhyb.correction.adequacy.curves.product import product, product_again
from symhyb.correction.adequacy.explained import decided
from symhyb.correction.adequacy.followed import fitted_on, part_of
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.adequacy.sums import is_sum, of_one
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import memoryless, smooth
from symhyb.judgement import CERTAIN, HOPELESS, SMALL
from symhyb.model.types import Place

TURNS = 4  # in which the points of two curves are chosen


def instead_of_class(ground: Recorded, judged: Adequacy) -> Fitted | None:
    """The structure, along whole recordings, that explains by a curve, or by listed laws that are
    as good, what was judged to be a force of stretch and rate; None where none does."""
    place, base, by_class = judged.certain("law"), judged.structure, judged.by_class
    if place is None or base is None or by_class is None or place not in ground.library.places:
        return None
    left = decided(ground, base, judged.beyond.acts)
    one_of = judged.classes[0].generic.over
    mine = [cause for cause in base.causes if cause.place == place and memoryless(cause)]
    likelier = base.evidence + (-CERTAIN if is_sum(mine) else CERTAIN)
    most = max(by_class.evidence - CERTAIN, likelier)

    def is_form(form: Form | None) -> bool:
        """Whether the class itself says that the force is one of this form."""
        return form is not None and not form.times and form.over == one_of

    def least(form: Form | None) -> float:
        """The evidence from which on a curve of some form says as much as the class, whose columns
        have other priors."""
        return likelier if is_form(form) else most

    def explains(trial: Fitted, form: Form | None) -> bool:
        return trial.evidence > least(form) and left.explained_by(ground, trial, SMALL)

    beside_it = [
        frozenset(cause for cause in by_class.causes if cause.place != place),
        frozenset(cause for cause in by_class.causes if _stays(cause, place, one_of)),
    ]
    for kept in dict.fromkeys(beside_it):
        bare = part_of(ground, by_class, kept.__contains__)
        if bare.fit.reason:
            continue
        offers = _offers(ground, bare, place, FORMS)
        curves = [
            pair
            for offer in offers
            if is_form(offer.form) or bare.evidence + offer.worth > least(offer.form) - HOPELESS
            if explains((pair := _curve(ground, bare, place, offer))[0], offer.form)
        ]
        if curves:
            curve, offer = max(curves, key=lambda pair: pair[0].evidence)
            return _shorter(curve, _by_name(ground, bare, curve, offer))
        if one_of:
            continue
        added = _two_curves(ground, bare, place)
        if added is not None and explains(added, None):
            return added
        found = _product(ground, bare, offers)
        if found is not None and explains(found, None):
            return found
    return None


def _stays(cause: Hypothesis, place: Place, one_of: str) -> bool:
    """Whether a cause may stay beside a curve over one quantity at a place: what is elsewhere, a
    law of the other quantity, and what jumps."""
    if cause.place != place or not one_of:
        return cause.place != place
    named = memoryless(cause) and not cause.points
    return named and not (smooth(cause) and of_one(cause, place, one_of))


def _offers(
    ground: Recorded, around: Fitted, place: Place, forms: Sequence[Form], level: bool = True
) -> list[Offer]:
    """Curves of some forms at a place around a structure, the one that is worth most first; one
    over the rate without a ``level`` is no force at rest."""
    which = ground.library.places.index(place)
    offers = [offered(ground, around, which, form, level) for form in forms]
    return sorted((one for one in offers if one is not None), key=lambda one: -one.worth)


def _curve(ground: Recorded, bare: Fitted, place: Place, offer: Offer) -> tuple[Fitted, Offer]:
    """The structure with a curve. Beside a structure without it an unknown force follows the
    sensors, and hides where the curve needs points: these are chosen once more along the motion,
    and with the noise, of the structure with the curve, as long as that is likelier."""
    best = beside(ground, bare, offer), offer
    for _ in range(TURNS - 1):
        found = best[0]
        start = _along(ground, bare, found)
        offers = [] if found.fit.reason else _offers(ground, start, place, [offer.form])
        again = [(beside(ground, start, one), one) for one in offers]
        if not again or again[0][0].evidence <= found.evidence:
            break
        best = again[0]
    return best


def _shorter(curve: Fitted, named: Sequence[Fitted]) -> Fitted | None:
    """A structure with a curve, or the likeliest of those with laws by name in its place that are
    as good; None where neither is certain. Laws that have a shape of their own follow a curve
    whatever they are, and have to be likelier by 100 to 1."""
    plain = [one for one in named if not is_sum(_instead(one, curve))]
    good = [one for one in plain if one.evidence >= curve.evidence]
    good += [one for one in named if one.evidence > curve.evidence + CERTAIN]
    if good:
        return max(good, key=_evidence)
    near = any(one.evidence > curve.evidence - CERTAIN for one in plain)
    return None if near else curve


def _instead(named: Fitted, curve: Fitted) -> list[Hypothesis]:
    """The laws by name that stand in place of a curve."""
    return [one for one in named.causes if one not in curve.causes and not one.points]


def _two_curves(ground: Recorded, bare: Fitted, place: Place) -> Fitted | None:
    """The structure with a curve over the stretch and one over the rate, or with laws by name in
    the place of one of them that are as good; None where neither is certain, or none can be. That
    over the rate is no force at rest: a constant of one is as well one of the other. A bent law is
    none of these: beside a curve it is another one. The points of each are chosen beside the other
    one, along the motion of both, in turn, as long as that is likelier (backfitting)."""
    fixed = next(iter(_offers(ground, bare, place, ALONE, level=False)), None)
    pairs: list[Fitted] = []
    named: list[Fitted] = []
    for turn in range(TURNS):
        if fixed is None:
            break
        first = beside(ground, bare, fixed)
        first = _along(ground, first, pairs[-1]) if pairs else first
        more = next(iter(_offers(ground, first, place, [fixed.form.other], level=False)), None)
        if first.fit.reason or more is None:
            break
        if turn > 0:  # until then the points of one were chosen without the other
            both = _paid(beside(ground, first, more), fixed)
            if both.fit.reason or (turn > 2 and both.evidence <= pairs[-1].evidence):
                break
            pairs.append(both)
            shorter = _by_name(ground, first, both, more, bent=False)
            named += [_paid(one, fixed) for one in shorter]
        fixed = more
    if not pairs:
        return None
    sums = [one for one in named if is_sum(_instead(one, pairs[0]))]
    plain = [one for one in named if not is_sum(_instead(one, pairs[0]))]
    best = [max(some, key=_evidence) for some in (plain, sums) if some]
    return _shorter(max(pairs, key=_evidence), [_again(ground, place, one) for one in best])


def _product(ground: Recorded, bare: Fitted, offers: Sequence[Offer]) -> Fitted | None:
    """The structure with a curve over the rate that is multiplied by one over the stretch. The
    points of both are chosen once more along the motion of that, a few times, and the likeliest is
    taken. None where no such curve can be."""
    found: list[Fitted] = []
    offer = product(ground, bare, offers)
    for _ in range(TURNS):
        if offer is None:
            break
        one = beside(ground, _along(ground, bare, found[-1]) if found else bare, offer)
        if one.fit.reason:
            break
        found.append(one)
        offer = product_again(ground, one, one.causes[-1])
    return max(found, key=_evidence, default=None)


def _along(ground: Recorded, bare: Fitted, found: Fitted) -> Fitted:
    """A structure whose fit begins along the motion, and with the noise, of another one."""
    noise = ground.revived(found.fit.noise)  # what few points leave is no noise of a sensor
    fit = replace(bare.fit, states=found.fit.states, noise=noise)
    return replace(bare, fit=fit)


def _again(ground: Recorded, place: Place, named: Fitted) -> Fitted:
    """A structure with a curve and laws by name, the points of the curve chosen once more beside
    these, along its motion: it was chosen beside another curve."""
    (curve,) = (cause for cause in named.causes if cause.points and cause.place == place)
    beneath = _along(ground, part_of(ground, named, lambda cause: cause != curve), named)
    offers = _offers(ground, beneath, place, [form_of(curve)])
    found = [_curve(ground, beneath, place, one)[0] for one in offers]
    return max([named, *found], key=_evidence)


def _paid(trial: Fitted, offer: Offer) -> Fitted:
    """A structure whose evidence pays for the choice of the points of one curve more."""
    return replace(trial, evidence=trial.evidence - offer.price)


def _evidence(trial: Fitted) -> float:
    return trial.evidence


def _by_name(
    ground: Recorded, bare: Fitted, curve: Fitted, offer: Offer, bent: bool = True
) -> list[Fitted]:
    """Structures with listed laws in the place of a curve; with ``bent`` ones, if they may be."""
    trials = []
    for one in listed(ground, offer.line):
        if bent or not any(cause.bent for cause in one.causes):
            causes, rows = (*bare.causes, *one.causes), [*grouped(bare), *one.rows]
            trials.append(fitted_on(ground, curve, causes, rows))
    return trials
