"""Whether a force of stretch and rate, that no listed law is, is a curve over one of the two, or a
curve over the stretch that is a factor of the speed, or one over each: their sum, or their product.

    class > listed laws         it is the answer: a force of stretch and rate at a place
    curve ≥ class               one curve explains as much: it is an own curve
    curve + curve ≥ class       no one curve does, and the sum of one over each does
    curve · curve ≥ class       nor does a sum, and a product does
    listed ≥ curve              laws by name do as well in its place: they are the answer

Where laws by name are less likely than the curve, but not by 100 to 1, neither is, and the class
stays. All are compared by the evidence of the innovations along whole recordings.
"""

from collections.abc import Sequence
from dataclasses import replace

from symhyb.correction.adequacy.curves.courses import ALONE, FORMS, Form, form_of
from symhyb.correction.adequacy.curves.fitted_curve import Offer, beside, offered
from symhyb.correction.adequacy.curves.listed import TOGETHER, listed
from symhyb.correction.adequacy.curves.product import product, product_again
from symhyb.correction.adequacy.explained import Decided, remainder
from symhyb.correction.adequacy.followed import fitted_on, part_of
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import memoryless, quantities
from symhyb.judgement import CERTAIN, HOPELESS, SMALL
from symhyb.model.types import Place

TURNS = 4  # in which the points of two curves are chosen


def instead_of_class(ground: Recorded, judged: Adequacy) -> Fitted | None:
    """The structure, along whole recordings, that explains by a curve, or by listed laws that are
    as good, what was judged to be a force of stretch and rate; None where none does."""
    place, base, by_class = judged.certain("law"), judged.structure, judged.by_class
    if place is None or base is None or by_class is None or place not in ground.library.places:
        return None
    bare = part_of(ground, by_class, lambda cause: cause.place != place)
    if bare.fit.reason:
        return None
    decided = Decided(base, remainder(ground, base), judged.beyond.acts)
    one_of = judged.classes[0].generic.over
    most = max(by_class.evidence - CERTAIN, base.evidence + CERTAIN)

    def least(form: Form | None) -> float:
        """The evidence from which on a curve of some form says as much as the class. That a force
        is one of one quantity the class itself says, whose columns have other priors."""
        said = form is not None and not form.times and form.over == one_of
        return base.evidence + CERTAIN if said else most

    def explains(trial: Fitted, form: Form | None) -> bool:
        enough = remainder(ground, trial) <= decided.may_leave(trial, SMALL)
        return trial.evidence > least(form) and enough

    offers = _offers(ground, bare, place, FORMS)
    promising = [one for one in offers if bare.evidence + one.worth > least(one.form) - HOPELESS]
    curves = [
        (curve, offer)
        for offer in promising
        if explains(curve := beside(ground, bare, offer), offer.form)
    ]
    if curves:
        curve, offer = max(curves, key=lambda pair: pair[0].evidence)
        return _shorter(curve, _by_name(ground, bare, curve, offer))
    if one_of:
        return None
    added = _two_curves(ground, bare, place)
    if added is not None and explains(added, None):
        return added
    found = _product(ground, bare, offers)
    return found if found is not None and explains(found, None) else None


def many_of_one(causes: Sequence[Hypothesis]) -> tuple[Place, Form] | None:
    """The place and the quantity of more laws than may stand for a curve; None where no place has
    so many."""
    for place in dict.fromkeys(cause.place for cause in causes if cause.place is not None):
        for form in ALONE:
            if sum(_of_one(cause, place, form) for cause in causes) > TOGETHER:
                return place, form
    return None


def _of_one(cause: Hypothesis, place: Place, form: Form) -> bool:
    """Whether a law with a name is at a place and a function of one quantity alone."""
    mine = cause.place == place and not cause.points and memoryless(cause)
    return mine and quantities(cause) <= {form.over}


def instead_of_many(ground: Recorded, judged: Adequacy, place: Place, form: Form) -> Fitted | None:
    """The structure, along whole recordings, with a curve, or listed laws that are as good, in the
    place of more laws than may stand for a curve; None where it is not more likely."""
    base = judged.structure
    if base is None or place not in ground.library.places:
        return None
    bare = part_of(ground, base, lambda cause: not _of_one(cause, place, form))
    offers = [] if bare.fit.reason else _offers(ground, bare, place, (form,))
    if not offers:
        return None
    curve = beside(ground, bare, offers[0])
    if curve.fit.reason or curve.evidence < base.evidence + CERTAIN:
        return None
    return _shorter(curve, _by_name(ground, bare, curve, offers[0]))


def _offers(
    ground: Recorded, around: Fitted, place: Place, forms: Sequence[Form], level: bool = True
) -> list[Offer]:
    """Curves of some forms at a place around a structure, the one that is worth most first; one
    over the rate without a ``level`` is no force at rest."""
    which = ground.library.places.index(place)
    offers = [offered(ground, around, which, form, level) for form in forms]
    return sorted((one for one in offers if one is not None), key=lambda one: -one.worth)


def _shorter(curve: Fitted, named: Fitted | None) -> Fitted | None:
    """A structure with a curve, or that with laws by name in its place, where these are as good;
    None where neither is certain."""
    if named is None or curve.evidence > named.evidence + CERTAIN:
        return curve
    return named if named.evidence >= curve.evidence else None


def _two_curves(ground: Recorded, bare: Fitted, place: Place) -> Fitted | None:
    """The structure with a curve over the stretch and one over the rate, or with laws by name in
    the place of one of them that are as good; None where neither is certain, or none can be. That
    over the rate is no force at rest: a constant of one is as well one of the other. The points of
    each are chosen beside the other one, in turn, as long as that is likelier (backfitting)."""
    fixed = next(iter(_offers(ground, bare, place, ALONE, level=False)), None)
    pairs: list[Fitted] = []
    named: list[Fitted] = []
    for turn in range(TURNS):
        if fixed is None:
            break
        first = beside(ground, bare, fixed)
        more = next(iter(_offers(ground, first, place, [fixed.form.other], level=False)), None)
        if first.fit.reason or more is None:
            break
        if turn > 0:  # until then the points of one were chosen without the other
            both = _paid(beside(ground, first, more), fixed)
            if both.fit.reason or (turn > 2 and both.evidence <= pairs[-1].evidence):
                break
            pairs.append(both)
            shorter = _by_name(ground, first, both, more)
            named += [] if shorter is None else [_paid(shorter, fixed)]
        fixed = more
    if not pairs:
        return None
    shorter = max(named, key=_evidence, default=None)
    return _shorter(max(pairs, key=_evidence), shorter and _again(ground, bare, place, shorter))


def _product(ground: Recorded, bare: Fitted, offers: Sequence[Offer]) -> Fitted | None:
    """The structure with a curve over the rate that is multiplied by one over the stretch. The
    points of both are chosen once more along the motion of that, a few times, and the likeliest is
    taken. None where no such curve can be."""
    found: list[Fitted] = []
    offer = product(ground, bare, offers)
    for _ in range(TURNS):
        if offer is None:
            break
        one = beside(ground, _along(bare, found[-1]) if found else bare, offer)
        if one.fit.reason:
            break
        found.append(one)
        offer = product_again(ground, one, one.causes[-1])
    return max(found, key=_evidence, default=None)


def _along(bare: Fitted, found: Fitted) -> Fitted:
    """A structure whose fit begins along the motion, and with the noise, of another one."""
    fit = replace(bare.fit, states=found.fit.states, noise=found.fit.noise)
    return replace(bare, fit=fit)


def _again(ground: Recorded, bare: Fitted, place: Place, named: Fitted) -> Fitted:
    """A structure with a curve and laws by name, the points of the curve chosen once more beside
    these: it was chosen beside another curve."""
    (curve,) = (cause for cause in named.causes if cause.points and cause.place == place)
    beneath = part_of(ground, named, lambda cause: cause != curve)
    offers = _offers(ground, beneath, place, [form_of(curve)])
    found = [beside(ground, beneath, one) for one in offers]
    return max([named, *found], key=_evidence)


def _paid(trial: Fitted, offer: Offer) -> Fitted:
    """A structure whose evidence pays for the choice of the points of one curve more."""
    return replace(trial, evidence=trial.evidence - offer.price)


def _evidence(trial: Fitted) -> float:
    return trial.evidence


def _by_name(ground: Recorded, bare: Fitted, curve: Fitted, offer: Offer) -> Fitted | None:
    """The most likely structure with listed laws in the place of a curve."""
    trials = []
    for one in listed(ground, offer.line):
        causes, rows = (*bare.causes, *one.causes), [*grouped(bare), *one.rows]
        trials.append(fitted_on(ground, curve, causes, rows))
    return max(trials, key=_evidence, default=None)
