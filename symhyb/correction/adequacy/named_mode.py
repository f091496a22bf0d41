"""Whether a hidden mode is the law ``mode``: a mass on a spring and a damper that rides on a place.

    class > listed laws         it is the answer: a hidden mode at a place
    mode ≥ class                a mass of one positive size explains as much: it is a mode

One more is tried at the place as long as it is more likely by 100 to 1. All are compared by the
evidence of the innovations along whole recordings.
Sizes: N samples, n coordinates, L frequencies.
"""

from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.columns import motions
from symhyb.correction.adequacy.classes.hidden_mode import band, swings
from symhyb.correction.adequacy.curves.courses import force_at
from symhyb.correction.adequacy.curves.products import products_of, solved
from symhyb.correction.adequacy.explained import Decided, remainder
from symhyb.correction.adequacy.followed import likeliest, scored
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Row, fitted
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import CERTAIN, HOPELESS, SMALL
from symhyb.model.types import On, Place
from symhyb.numeric.kernels.buffers import Array

MODES_MOST = 3  # at one place
LINES = 40  # frequencies that are tried
DAMPINGS = (0.005, 0.02, 0.06, 0.2, 0.6)
LOSS_MOST = 1.0  # of the critical damping: beyond, the mass creeps and does not swing
BEGINNINGS = 2  # of a mode: the best of different frequencies


class _Offer(NamedTuple):
    """A mode as a cause with values of its keys, SI, and what it is worth in ln evidence in the
    linear problem."""

    cause: Hypothesis
    row: Row
    worth: float


def modes_instead(ground: Recorded, judged: Adequacy) -> Fitted | None:
    """The structure, along whole recordings, that explains by modes what was judged to be a hidden
    mode; None where none does as well."""
    place, base, by_class = judged.certain("hidden mode"), judged.structure, judged.by_class
    if place is None or base is None or by_class is None or place not in ground.library.places:
        return None
    decided = Decided(base, remainder(ground, base), judged.beyond.acts)
    found = [
        trial
        for start in _starts(ground, base, by_class, place)
        if (trial := _with_modes(ground, start, place)) is not None
    ]
    best = max(found, key=lambda trial: trial.evidence, default=None)
    if best is None or best.evidence <= max(by_class.evidence - CERTAIN, base.evidence + CERTAIN):
        return None
    return best if remainder(ground, best) <= decided.may_leave(best, SMALL) else None


def _starts(ground: Recorded, base: Fitted, by_class: Fitted, place: Place) -> list[Fitted]:
    """What modes are tried beside: the causes elsewhere, and all that were decided."""
    every = list(zip(by_class.causes, grouped(by_class), strict=True))
    elsewhere = [(cause, row) for cause, row in every if cause.place != place]
    starts = [likeliest(ground, [one for one, _ in elsewhere], [row for _, row in elsewhere])]
    if len(elsewhere) < len(base.causes):
        starts.append(base)
    return [start for start in starts if not start.fit.reason]


def _with_modes(ground: Recorded, start: Fitted, place: Place) -> Fitted | None:
    """A structure with as many modes at a place as are each more likely by 100 to 1; None where not
    even one is."""
    best = None
    for _ in range(MODES_MOST):
        before = start if best is None else best
        found = [_beside(ground, before, offer) for offer in _offers(ground, before, place)]
        one = max(found, key=lambda trial: trial.evidence, default=None)
        if one is None or one.evidence <= before.evidence + CERTAIN:
            break
        best = one
    return best


def _beside(ground: Recorded, start: Fitted, offer: _Offer) -> Fitted:
    causes, rows = (*start.causes, offer.cause), [*grouped(start), offer.row]
    noise = ground.revived(start.fit.noise)
    return scored(ground, fitted(ground, causes, rows, noise, start.fit.states))


def _offers(ground: Recorded, start: Fitted, place: Place) -> list[_Offer]:
    """The modes at a place that are worth most around a structure, of different frequencies."""
    which = ground.library.places.index(place)
    lines = np.geomspace(*band(ground, which), LINES)
    size = force_at(ground, which) / _acceleration(ground, which)  # kg: what it would take to move
    offers: list[_Offer] = []
    for loss in DAMPINGS:
        products = products_of(ground, start, _forces(ground, which, lines, loss))
        for i, line in enumerate(lines):
            worth, mass = max(solved(gram, more, i, size) for gram, more in products)
            if mass > 0:
                cause = _mode(place, float(line), loss)
                row = {"mass": mass, "frequency": float(line), "damping_ratio": loss}
                offers.append(_Offer(cause, row, worth))
    offers.sort(key=lambda one: -one.worth)
    chosen: list[_Offer] = []
    for one in offers:
        apart = all(not _near(one, other) for other in chosen)
        if apart and len(chosen) < BEGINNINGS and one.worth > offers[0].worth - HOPELESS:
            chosen.append(one)
    return chosen


def _near(one: _Offer, other: _Offer) -> bool:
    """Whether a fit from one of them may end at the other."""
    low, high = one.cause.limits("frequency")
    return low <= other.row["frequency"] <= high


def _mode(place: Place, line: float, loss: float) -> Hypothesis:
    return Hypothesis(
        "mode",
        place,
        ("mass",),
        (True,),
        (("frequency", line), ("damping_ratio", loss)),
        ("frequency", "damping_ratio"),
        bounds=(("damping_ratio", 0.0, LOSS_MOST),),
    )


def _forces(ground: Recorded, which: int, lines: Array, loss: float) -> list[Array]:
    """The generalized forces (N, n, L) of modes of 1 kg along every stretch, SI: they resist."""
    resists = -1.0 if isinstance(ground.library.places[which], On) else 1.0
    found = []
    moved = zip(motions(ground), swings(ground, which, lines, loss), strict=True)
    for (_, _, directions), states in moved:
        pull = states[:, 0::2] + 2 * loss * states[:, 1::2]
        found.append(resists * directions[:, :, which, None] * pull[:, None])
    return found


def _acceleration(ground: Recorded, which: int) -> float:
    """RMS of the acceleration of a place, SI."""
    squares: list[Array] = []
    for item, (s, _, _) in zip(ground.items, motions(ground), strict=True):
        t = item.block.t[0]
        squares.append(np.gradient(np.gradient(s[:, which], t), t) ** 2)
    return float(np.sqrt(np.mean(np.concatenate(squares)))) or 1.0
