"""Whether a hidden mode is a law: a ``mode``, a mass on a spring and a damper that rides on a
place, or a ``hydromount``, a mass behind a spring that is damped against rest.

    class > listed laws         it is the answer: a hidden mode at a place
    law ≥ class                 a mass of one positive size explains as much: it is that law

The likelier of the two is taken. One more mode is tried at the place as long as it is more likely
by 100 to 1. All are compared by the evidence of the innovations along whole recordings.
Sizes: N samples, n coordinates, L frequencies.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.columns import motions
from symhyb.correction.adequacy.classes.hidden_mode import band, swings
from symhyb.correction.adequacy.curves.courses import force_at
from symhyb.correction.adequacy.curves.products import products_of, solved
from symhyb.correction.adequacy.explained import Decided, decided
from symhyb.correction.adequacy.followed import fitted_on, part_of, scored
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
TRACK = ("mass", "damping")  # of a hydromount, as it is tried at first


class _Offer(NamedTuple):
    """A mode as a cause with values of its keys, SI, and what it is worth in ln evidence in the
    linear problem; ``line`` is its frequency, Hz."""

    cause: Hypothesis
    row: Row
    worth: float
    line: float = 0.0


def modes_instead(ground: Recorded, judged: Adequacy) -> Fitted | None:
    """The structure, along whole recordings, that explains by modes what was judged to be a hidden
    mode; None where none does as well."""
    place, base, by_class = judged.certain("hidden mode"), judged.structure, judged.by_class
    if place is None or base is None or by_class is None or place not in ground.library.places:
        return None
    left = decided(ground, base, judged.beyond.acts)
    found = [
        trial
        for start in _starts(ground, base, by_class, place)
        for with_law in (_with_modes, _with_hydromount)
        if (trial := with_law(ground, start, place)) is not None
    ]
    best = max(found, key=lambda trial: trial.evidence, default=None)
    if best is None or best.evidence <= base.evidence + CERTAIN:
        return None
    if best.evidence <= _class_alone(ground, by_class, place, left) - CERTAIN:
        return None
    return best if left.explained_by(ground, best, SMALL) else None


def _class_alone(ground: Recorded, by_class: Fitted, place: Place, left: Decided) -> float:
    """Evidence of the class without the laws at its place, where it explains so too: along the
    smoothed motion a spring, a damper and a mass together follow the noise that is left in it, and
    the class, which has the first two, needs no third."""
    every = zip(by_class.causes, grouped(by_class), strict=True)
    kept = [(cause, row) for cause, row in every if cause.place != place]
    if len(kept) == len(by_class.causes):
        return by_class.evidence
    causes, rows = [cause for cause, _ in kept], [row for _, row in kept]
    noise, states = ground.revived(by_class.fit.noise), by_class.fit.states
    alone = scored(ground, fitted(ground, causes, rows, noise, states, extra=by_class.extra))
    explains = left.explained_by(ground, alone, SMALL)
    return alone.evidence if explains else by_class.evidence


def _starts(ground: Recorded, base: Fitted, by_class: Fitted, place: Place) -> list[Fitted]:
    """What modes are tried beside: the causes elsewhere, and all that were decided."""
    starts = [part_of(ground, by_class, lambda cause: cause.place != place)]
    if len(starts[0].causes) < len(base.causes):
        starts.append(base)
    return [start for start in starts if not start.fit.reason]


def _with_modes(ground: Recorded, start: Fitted, place: Place) -> Fitted | None:
    """A structure with as many modes at a place as are each more likely by 100 to 1; None where not
    even one is."""
    best = None
    for _ in range(MODES_MOST):
        before = start if best is None else best
        offers = _offers(ground, before, place, _MODE)
        found = [_beside(ground, before, offer) for offer in offers]
        one = max(found, key=lambda trial: trial.evidence, default=None)
        if one is None or one.evidence <= before.evidence + CERTAIN:
            break
        best = one
    return best


def _with_hydromount(ground: Recorded, start: Fitted, place: Place) -> Fitted | None:
    """A structure with a hydromount at a place that is more likely by 100 to 1, the loss of its
    track linear, or with a quadratic part, or quadratic alone where that is more likely by as much;
    None where it is not."""
    offers = _offers(ground, start, place, _HYDROMOUNT)
    best = max(
        ((_beside(ground, start, offer), offer) for offer in offers),
        key=lambda pair: pair[0].evidence,
        default=None,
    )
    if best is None or best[0].evidence <= start.evidence + CERTAIN:
        return None
    plain, offer = best
    row = grouped(plain)[-1]
    squares = [_beside(ground, start, one) for one in _quadratic(ground, offer, row)]
    square = max(squares, key=lambda trial: trial.evidence)
    return square if square.evidence > plain.evidence + CERTAIN else plain


def _quadratic(ground: Recorded, offer: _Offer, row: Row) -> Iterator[_Offer]:
    """A hydromount whose loss is quadratic in the speed, alone and beside a linear one; at the
    speed of the place it is as large to begin with."""
    which = ground.library.places.index(offer.cause.place)
    rate = float(
        np.sqrt(np.mean(np.concatenate([r[:, which] ** 2 for _, r, _ in motions(ground)])))
    )
    for keys, share in ((("mass", "drag"), 1.0), ((*TRACK, "drag"), 0.5)):
        first = {
            **{key: row[key] for key in ("stiffness", "mass")},
            "damping": (1 - share) * row["damping"],
            "drag": share * row["damping"] / rate,
        }
        shape = tuple((key, first[key] / first["stiffness"]) for key in keys)
        cause = replace(offer.cause, shape=shape, refined=keys, tied=keys)
        yield _Offer(cause, {key: first[key] for key in cause.keys}, offer.worth)


def _beside(ground: Recorded, start: Fitted, offer: _Offer) -> Fitted:
    causes, rows = (*start.causes, offer.cause), [*grouped(start), offer.row]
    return fitted_on(ground, start, causes, rows)


def _offers(ground: Recorded, start: Fitted, place: Place, form: "_Form") -> list[_Offer]:
    """The laws of a form at a place that are worth most around a structure, of different
    frequencies."""
    which = ground.library.places.index(place)
    lines = np.geomspace(*band(ground, which), LINES)
    size = force_at(ground, which) / form.moved(ground, which)  # what it would take to move
    offers: list[_Offer] = []
    for loss in DAMPINGS:
        products = products_of(ground, start, _forces(ground, which, lines, loss, form))
        for i, line in enumerate(lines):
            worth, strength = max(solved(gram, more, i, size) for gram, more in products)
            if strength > 0:
                cause = form.cause(place, float(line), loss)
                row = cause.values([strength])
                offers.append(_Offer(cause, row, worth, float(line)))
    offers.sort(key=lambda one: -one.worth)
    chosen: list[_Offer] = []
    for one in offers:
        apart = all(not _near(one, other) for other in chosen)
        if apart and len(chosen) < BEGINNINGS and one.worth > offers[0].worth - HOPELESS:
            chosen.append(one)
    return chosen


def _near(one: _Offer, other: _Offer) -> bool:
    """Whether a fit from one of them may end at the other."""
    assert one.cause.place is not None
    low, high = _mode(one.cause.place, one.line, 0.0).limits("frequency")
    return low <= other.line <= high


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


def _hydromount(place: Place, line: float, loss: float) -> Hypothesis:
    pace = 2 * np.pi * line
    shape = (("mass", 1 / pace**2), ("damping", 2 * loss / pace))  # of 1 N/m
    return Hypothesis("hydromount", place, ("stiffness",), (True,), shape, TRACK, tied=TRACK)


def _forces(ground: Recorded, which: int, lines: Array, loss: float, form: "_Form") -> list[Array]:
    """The generalized forces (N, n, L) of laws of strength 1 along every stretch, SI."""
    resists = -1.0 if isinstance(ground.library.places[which], On) else 1.0
    found = []
    moved = zip(motions(ground), swings(ground, which, lines, loss), strict=True)
    for (_, rate, directions), states in moved:
        pull = form.pull(states, rate[:, which, None], 2 * np.pi * lines, loss)
        found.append(resists * directions[:, :, which, None] * pull[:, None])
    return found


def _acceleration(ground: Recorded, which: int) -> float:
    """RMS of the acceleration of a place, SI."""
    squares: list[Array] = []
    for item, (s, _, _) in zip(ground.items, motions(ground), strict=True):
        t = item.block.t[0]
        squares.append(np.gradient(np.gradient(s[:, which], t), t) ** 2)
    return float(np.sqrt(np.mean(np.concatenate(squares)))) or 1.0


def _stretched(ground: Recorded, which: int) -> float:
    """RMS of the stretch of a place about its mean, SI."""
    return float(np.std(np.concatenate([s[:, which] for s, _, _ in motions(ground)]))) or 1.0


def _of_mode(states: Array, _: Array, __: Array, loss: float) -> Array:
    """What a mode of 1 kg pulls with (N, L), from ω² e and ω e′ of its elongation (N, 2L)."""
    return np.asarray(states[:, 0::2] + 2 * loss * states[:, 1::2])


def _of_hydromount(states: Array, rate: Array, pace: Array, loss: float) -> Array:
    """What a hydromount of 1 N/m pulls with (N, L): its mass is driven through the spring alone, so
    that its elongation is e + 2ζ/ω (s′ − e′ − 2ζω e)."""
    e, slip = states[:, 0::2] / pace**2, states[:, 1::2] / pace
    return np.asarray(e + 2 * loss / pace * (rate - slip - 2 * loss * pace * e))


class _Form(NamedTuple):
    """A law that a hidden mode may be: the ``cause`` at a place with a frequency, Hz, and a damping
    ratio; the ``pull`` of one of strength 1; and the RMS of what it is ``moved`` by, SI."""

    cause: Callable[[Place, float, float], Hypothesis]
    pull: Callable[[Array, Array, Array, float], Array]
    moved: Callable[[Recorded, int], float]


_MODE = _Form(_mode, _of_mode, _acceleration)
_HYDROMOUNT = _Form(_hydromount, _of_hydromount, _stretched)
