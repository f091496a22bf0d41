"""Whether a decided structure is adequate: what acts beyond its causes, and which class it is of.

The structure is fitted once more by the innovations likelihood, which tells missing forces from the
noise of sensors, whatever its colour. Where a force acts that no cause explains, generic classes
(:mod:`~.generic`) are fitted beside the structure and in place of each of its causes, and always in
place of all of them. A class is an answer where it is more probable and takes at least half of what
acts beyond; a cause is claimed beside it only where it is still needed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.beyond import NOTHING, Beyond, beyond
from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.generic import classes_of, worth_of
from symhyb.correction.adequacy.recorded import Recorded, recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Row, fitted
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.strength import element_forces
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.numeric.kernels.buffers import Array

CLAIMED = 0.95  # posterior probability of a cause that is claimed beside a class
MENTIONED = 0.05  # posterior probability of a class that is worth a word
CLASSES_MOST = 3  # that are fitted, the best of the linear problem
PART_OF_BEYOND = 1 / 3  # of the force that acts beyond: a law that is claimed beside it has more
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
        return not (self.beyond.acts or self.class_probability > HALF)

    @property
    def class_probability(self) -> float:
        """The posterior probability that one of the classes acts."""
        return sum(chance for _, chance in self.classes)


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
    small = _small(final, ground, left)
    trials = [base]
    if left.acts:
        trials += _raced(ground, base, rows, base)
    if base.causes:  # laws by name may only imitate a class
        bare = _scored(ground, fitted(ground, (), (), ground.first_noise()))
        trials += [bare, *_raced(ground, bare, (), base)]
    weights = _weights(trials)
    classes = _classes(trials, weights)
    if not classes:
        return Adequacy(left, doubt=small)
    return Adequacy(left, classes, small | _doubted(ground, trials, weights, classes))


def _small(final: Refined, ground: Recorded, left: Beyond) -> frozenset[Hypothesis]:
    """The laws whose force is small against what acts beyond, at every coordinate: they may be a
    part of it."""
    if not left.acts:
        return frozenset()
    squares, counts = 0.0, 0
    for item in ground.items:
        forces = element_forces(final, *item.source)[0][item.rows[0]]
        squares = squares + np.sum(forces**2, axis=0)
        counts += len(forces)
    sizes = np.sqrt(squares / counts)  # (n, E), those of the causes last
    laws = [cause for cause in final.causes if cause.place is not None]
    own = sizes[:, sizes.shape[1] - len(laws) :]
    large = np.any((own > PART_OF_BEYOND * left.force[:, None]) & (own > 0), axis=0)
    return frozenset(cause for cause, stands in zip(laws, large, strict=True) if not stands)


def _scored(ground: Recorded, trial: Fitted) -> Fitted:
    return replace(trial, evidence=evidence(ground, trial))


def _raced(ground: Recorded, start: Fitted, rows: Sequence[Row], decided: Fitted) -> list[Fitted]:
    """A structure with each of the best generic classes beside it, in place of each of its causes
    and of all of them: those that may be better than what was ``decided``, and take half of what
    acts beyond it."""
    makers, offered = classes_of(ground), []
    for maker in makers:
        generic = maker(ground, start)
        gain = worth_of(ground, start, generic) - np.log(len(makers))
        if start.evidence + gain > decided.evidence:
            offered.append((gain, generic))
    offered.sort(key=lambda pair: -pair[0])
    noise, found = ground.revived(start.fit.noise), []
    causes = start.causes
    for _, generic in offered[:CLASSES_MOST]:
        sets = [tuple(range(len(causes)))]
        sets += [tuple(j for j in sets[0] if j != i) for i in range(len(causes))]
        sets += [()] if len(causes) > 1 else []
        for kept in sets:
            chosen, begin = [causes[i] for i in kept], [rows[i] for i in kept]
            trial = fitted(ground, chosen, begin, noise, start.fit.states, extra=generic)
            trial = _scored(ground, trial)
            if _remainder(ground, trial) <= HALF * _remainder(ground, decided):
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
    ground: Recorded,
    trials: Sequence[Fitted],
    weights: Array,
    classes: Sequence[tuple[Generic, float]],
) -> frozenset[Hypothesis]:
    """The causes of the structure, the first of the trials, that are not needed beside the classes:
    by their probability, or since the likeliest class leaves less without them. And every number
    of the model or of a channel, of which the columns of a class may hold a part."""
    doubt = []
    certain = any(chance > 1 - CLAIMED for _, chance in classes)
    decided = trials[0].causes
    beside = [trial for trial in trials if trial.extra and trial.extra.key == classes[0][0].key]
    left = {trial.causes: _remainder(ground, trial) for trial in reversed(beside)}
    for cause in decided:
        has = np.array([cause in trial.causes for trial in trials])
        number = cause.place is None and certain
        without = left.get(tuple(one for one in decided if one != cause), np.inf)
        leaves_less = without < left.get(decided, 0.0)
        if number or leaves_less or float(weights[has].sum()) < CLAIMED:
            doubt.append(cause)
    return frozenset(doubt)
