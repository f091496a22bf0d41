"""Whether a decided structure is adequate: what acts beyond its causes, and which class it is of.

The structure is fitted once more by the innovations likelihood, which tells missing forces from the
noise of sensors, whatever its colour. Where a force acts that no cause explains, generic classes
(:mod:`~.generic`) are fitted beside the structure, and in place of each of its causes: a class is
an answer where it takes at least half of what acts, and a cause is claimed beside it only where it
is still needed then.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.beyond import NOTHING, Beyond, beyond
from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.generic import classes_of, gain_of
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Row, fitted
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.numeric.kernels.buffers import Array

CLAIMED = 0.95  # posterior probability of a cause that is claimed beside a class
MENTIONED = 0.05  # posterior probability of a class that is worth a word
CLASSES_MOST = 3  # that are fitted, the best of the linear problem
HALF = 0.5  # of the power of what acts beyond the causes: a class takes at least so much
CERTAIN = 4.6  # of ln evidence (100 to 1): closer, two classes cannot be distinguished


@dataclass(frozen=True, slots=True, eq=False)
class Adequacy:
    """What acts ``beyond`` a structure, the generic ``classes`` that it may be with their posterior
    probabilities, and the causes that are in ``doubt`` beside them."""

    beyond: Beyond
    classes: tuple[tuple[Generic, float], ...] = ()
    doubt: frozenset[Hypothesis] = frozenset()

    @property
    def adequate(self) -> bool:
        """Whether nothing acts that no cause explains."""
        return not (self.beyond.acts or self.classes)


def adequacy(prepared: Prepared, setting: Setting, final: Refined) -> Adequacy:
    """Judge a decided structure by the recordings that it was decided on."""
    ground = recorded(prepared, setting)
    if ground is None:
        return Adequacy(NOTHING)
    rows = grouped(final)
    base = _scored(ground, fitted(ground, final.causes, rows, ground.first_noise()))
    if base.fit.reason:
        return Adequacy(NOTHING)
    left = beyond(ground, base)
    if not left.acts:
        return Adequacy(left)
    trials = [base, *_raced(ground, base, rows)]
    weights = _weights(trials)
    classes = _classes(trials, weights)
    if not classes:
        return Adequacy(left)
    return Adequacy(left, classes, _doubted(base.causes, trials, weights))


def _scored(ground: Recorded, trial: Fitted) -> Fitted:
    return replace(trial, evidence=evidence(ground, trial))


def _raced(ground: Recorded, base: Fitted, rows: Sequence[Row]) -> list[Fitted]:
    """The structure with each of the best generic classes beside it, in place of each of its causes
    and of all of them; only classes that take half of what acts."""
    makers, offered = classes_of(ground), []
    for maker in makers:
        generic = maker(ground, base)
        gain = float(gain_of(ground, base, generic)[0]) - np.log(len(makers))
        if gain > 0:
            offered.append((gain, generic))
    offered.sort(key=lambda pair: -pair[0])
    noise, found = ground.revived(base.fit.noise), []
    causes = base.causes
    for _, generic in offered[:CLASSES_MOST]:
        sets = [tuple(range(len(causes)))]
        sets += [tuple(j for j in sets[0] if j != i) for i in range(len(causes))]
        sets += [()] if len(causes) > 1 else []
        for kept in sets:
            chosen, start = [causes[i] for i in kept], [rows[i] for i in kept]
            trial = fitted(ground, chosen, start, noise, base.fit.states, extra=generic)
            trial = _scored(ground, trial)
            if _remainder(ground, trial) <= HALF * _remainder(ground, base):
                found.append(trial)
    return found


def _remainder(ground: Recorded, trial: Fitted) -> float:
    """The power of the unknown force, over that of what moves the coordinates."""
    return float(np.sum((trial.fit.noise.force / ground.scale_or_inf[:, 0]) ** 2))


def _weights(trials: Sequence[Fitted]) -> Array:
    """Posterior probabilities (T,)."""
    scores = np.array([trial.evidence for trial in trials])
    weight = np.exp(np.maximum(scores - scores.max(), -700.0))
    return np.asarray(weight / weight.sum())


def _classes(trials: Sequence[Fitted], weights: Array) -> tuple[tuple[Generic, float], ...]:
    """The classes with their probabilities, the likeliest first. What a sensor does may be what its
    input does: where the two cannot be distinguished, the input is named for both."""
    found: dict[object, tuple[Generic, float]] = {}
    for trial, weight in zip(trials, weights, strict=True):
        if trial.extra is not None:
            known = found.get(trial.extra.key, (trial.extra, 0.0))
            found[trial.extra.key] = known[0], known[1] + float(weight)
    ranked = sorted(found.values(), key=lambda pair: -pair[1])
    for i, (generic, chance) in enumerate(ranked[1:], 1):
        first, best = ranked[0]
        if first.kind == "sensor" and generic.kind in ("input", "lag"):
            if chance > best * np.exp(-CERTAIN):
                ranked = [(generic, chance + best), *ranked[1:i], *ranked[i + 1 :]]
            break
    return tuple(pair for pair in ranked if pair[1] > MENTIONED)


def _doubted(
    causes: Sequence[Hypothesis], trials: Sequence[Fitted], weights: Array
) -> frozenset[Hypothesis]:
    """The causes that are not needed beside the classes, and every number of the model or of a
    channel: the columns of a class may hold a part of any of them."""
    doubt = []
    for cause in causes:
        has = np.array([cause in trial.causes for trial in trials])
        if cause.place is None or float(weights[has].sum()) < CLAIMED:
            doubt.append(cause)
    return frozenset(doubt)
