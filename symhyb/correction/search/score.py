"""The one score of a structure, and which structures physics and their own deviations allow.

    χ²/u + Σ price of a number + 2 ln p for each cause         the smaller, the better

χ² is what the structure leaves on all windows, fitted and held; u is χ² of one independent piece
of that, the same for all that are compared; a number costs ln N (N samples); a cause is chosen
among p. It is −2 ln of the posterior probability up to a constant: 4.6 are odds of 10 to 1.

Sources: Schwarz, Annals of Statistics 6, 1978 (k ln N); Chen & Chen, Biometrika 95, 2008 (the price
of a long list); Kennedy & O'Hagan, Journal of the Royal Statistical Society B 63, 2001 (what a
model lacks is no noise).
"""

from collections.abc import Iterator
from dataclasses import replace
from math import inf

import numpy as np
from scipy.special import chdtri, ndtr, ndtri

from symhyb.correction.search.trajectory import (
    Refined,
    firsts_of,
    gathered,
    grouped,
    keys_of,
    own_key,
)
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.words.formula import LAW
from symhyb.judgement import ACCURACY, NEAR_NOISE, OUTSTANDING, PIECES
from symhyb.model.actuators import ACTUATOR_KEYS
from symhyb.model.vocabulary import key_of
from symhyb.numeric.kernels.buffers import Array


def score(trial: Refined, unit: float, candidates: int) -> float:
    """The score of a fitted structure in a ``unit``, chosen among so many ``candidates``."""
    return left(trial) / unit + price(trial, candidates)


def price(trial: Refined, candidates: int) -> float:
    """What a structure costs: its numbers, and having chosen its causes among ``candidates``.

    A parameter that states an sd was not chosen: its χ² against what was known of it counts
    instead, but no more than the law costs that does the same. A law that bends between two
    simpler ones may stand for both (a power of 0.5 for friction and damping), and costs as much.
    """
    choice = choice_of(candidates)
    prior = min(trial.fit.prior, len(trial.causes) * (np.log(samples(trial)) + choice))
    chosen = len(trial.causes) - uncertain(trial) + sum(cause.bent for cause in trial.causes)
    return float(cost(trial) + prior + chosen * choice)


def choice_of(candidates: int) -> float:
    """What it costs to have chosen one cause."""
    return float(2 * np.log(max(candidates, 1)))


def uncertain(trial: Refined) -> int:
    """How many of the causes are parameters that state an sd."""
    return sum(prior_sd(trial, cause) < inf for cause in trial.causes)


def left(trial: Refined) -> float:
    """χ² of all windows."""
    return trial.fit.left


def samples(trial: Refined) -> float:
    """How many samples the windows have."""
    return trial.fit.samples


def cost(trial: Refined) -> float:
    """What the numbers of a structure cost: ln N each, of a number that a recording or a group of
    them has of its own ln of the samples of these, from which alone it is known; of a parameter
    that states an sd by how much the recordings narrow that, if it is less (Laplace's
    approximation)."""
    keys = [(cause, key) for cause in trial.causes for key in keys_of(cause)]
    known = np.array([prior_sd(trial, cause) for cause, _ in keys])
    price = np.log(np.maximum(samples(trial) * _parts(trial, len(keys)), 2))
    spread = np.sqrt(np.diag(trial.fit.covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        narrowed = 2 * np.log(np.maximum(gathered(known, trial.owned) / spread, 1.0))
    return float(np.sum(np.fmin(price, narrowed)))


def _parts(trial: Refined, numbers: int) -> Array:
    """The share of the recordings (F,) that has each number; ``numbers`` are those of one."""
    if not trial.owned:
        return np.ones(numbers)
    having = np.bincount(np.ravel(trial.owned), minlength=trial.numbers)
    return np.asarray(having / len(trial.owned))


def prior_sd(trial: Refined, cause: Hypothesis) -> float:
    """The sd that a parameter of the model or of an actuator states, SI; infinite for any other
    cause."""
    if cause.kind not in ("parameter", *ACTUATOR_KEYS):
        return inf
    declared = {item.path: item.si_sd for item in trial.machine.model.all_parameters()}
    return declared.get(cause.path) or inf


def unit_of(trial: Refined) -> float:
    """χ² of one independent sample."""
    return trial.fit.unit


def piece_of(trial: Refined) -> float:
    """χ² of one independent piece of what a structure leaves."""
    return piece(trial.fit)


def piece(fit: Fit) -> float:
    """χ² of one independent piece of what a fit leaves: of its residuals by their
    correlation, and of what is more than noise, or differs between repeated runs, as one of few. A
    missing force repeats wherever the motion does; that the samples are many makes it no better
    known."""
    lacking = max(fit.left - NEAR_NOISE * fit.samples, fit.floor * fit.samples)
    return max(fit.unit, lacking / PIECES)


def part_left(trial: Refined, nothing: Refined) -> float:
    """The share of the squared mismatch beyond the noise that a structure leaves, on held windows
    (on the fitted ones where none is held)."""
    held = nothing.fit.held if nothing.fit.held.any() else ~nothing.fit.held
    floor = float(nothing.fit.count[held].sum())
    before, after = float(nothing.fit.chi2[held].sum()), float(trial.fit.chi2[held].sum())
    if not np.isfinite(before):
        return 0.0
    return 1 - (before - after) / max(before - min(floor, after), (NEAR_NOISE - 1) * floor)


def believable(trial: Refined, length_s: float = inf) -> bool:
    """Whether physics allows the fitted values and each strength stands out of its own deviation. A
    law that differs by direction, or is a formula without a name, is claimed only where it explains
    the recordings down to their noise: they fit whatever is left.

    A memory that outlasts windows of ``length_s`` (s) is indistinguishable from initial states.
    """
    if trial.fit.reason or weak(trial):
        return False
    for cause, values in zip(trial.causes, grouped(trial), strict=True):
        if cause.kind == "relaxation" and values["damping"] > length_s * values["stiffness"]:
            return False
        if ("skew" in cause.terms or cause.kind == LAW) and not trial.fit.scale < NEAR_NOISE:
            return False
    return True


def weak(trial: Refined) -> tuple[int, ...]:
    """The causes, by their place in the structure, whose strength or added key does not stand out
    of its own deviation, or which say the same as a simpler law of the list."""
    spread = np.sqrt(np.diag(trial.fit.covariance))
    return tuple(
        i
        for i, first in enumerate(firsts_of(trial.causes))
        if not _strong(trial, i, first, spread)
        or any(added and not stands for added, stands in _shapes(trial, i, first, spread))
        or _listed(trial, i, first)
    )


def _listed(trial: Refined, which: int, first: int) -> bool:
    """Whether a key of a cause, whose numbers begin at ``first``, does not stand out of a value at
    which another law of the list says the same: a power of 1.02 ± 0.01 is viscous damping; or of a
    bound of a law that bends between simpler ones, where it is one of these."""
    cause, values = trial.causes[which], grouped(trial)[which]
    ends = {key: two for key, *two in cause.bounds} if cause.bent else {}
    for key, path in zip(list(values)[: cause.numbers], trial.paths[first:], strict=False):
        declared = key_of(cause.kind, key)
        for same in (*(declared.listed if declared else ()), *ends.get(key, ())):
            if abs(values[key] - same) <= OUTSTANDING * trial.value(path)[1]:
                return True
    return False


def weak_together(trial: Refined) -> tuple[int, ...]:
    """The causes, by their place in the structure, that do not stand out once the weaker ones are
    gone: of two that stand for each other one stays. The weakest goes first, and the others take
    its part as the covariance of the fit says (backward elimination)."""
    gone: list[int] = []
    now, rest = trial, weak(trial)
    if trial.owned:  # each recording has strengths of its own
        return rest
    firsts = firsts_of(trial.causes)
    while rest:
        out = min(rest, key=lambda i: standing(now, i))
        gone.append(out)
        curve = trial.causes[out].numbers if trial.causes[out].points else 1
        for number in range(firsts[out], firsts[out] + curve):
            now = _conditioned(now, number)
        rest = tuple(i for i in weak(now) if i not in gone)
    return tuple(sorted(gone))


def _conditioned(trial: Refined, number: int) -> Refined:
    """A structure with the values and deviations that it has if a number is none."""
    fit = trial.fit
    variance = float(fit.covariance[number, number])
    if not 0 < variance < inf:
        return trial
    along = fit.covariance[:, number] / variance
    values = fit.values - along * fit.values[number]
    covariance = fit.covariance - np.outer(along, fit.covariance[number])
    np.fill_diagonal(covariance, np.maximum(np.diag(covariance), 0.0))  # of rounding
    return replace(trial, fit=replace(fit, values=values, covariance=covariance))


def plain(trial: Refined) -> tuple[int, ...]:
    """The causes, by their place in the structure, of which no number but the strength stands out
    of its own deviation: an asymmetry of 0.01 ± 0.02 does not make a damper another law."""
    spread = np.sqrt(np.diag(trial.fit.covariance))
    return tuple(
        i
        for i, first in enumerate(firsts_of(trial.causes))
        if not any(stands for _, stands in _shapes(trial, i, first, spread))
    )


def standing(trial: Refined, which: int) -> float:
    """By how many units χ² grows without a cause, as its own deviation says: its strength over its
    deviation, squared (Wald's statistic), summed over the recordings or groups that have their own;
    of a curve by all its values together."""
    first, spread = firsts_of(trial.causes)[which], np.sqrt(np.diag(trial.fit.covariance))
    if trial.causes[which].points:
        return _wald(trial, which, first)
    strengths = _strengths(trial, which, first, spread)
    return float(sum((value / sd) ** 2 if sd > 0 else inf for value, sd in strengths))


def _wald(trial: Refined, which: int, first: int) -> float:
    """Wald's statistic of all values of a curve, whose numbers begin at ``first``; the accuracy of
    the numerics is a part of their deviations."""
    own = slice(first, first + len(trial.causes[which].unknown))
    values = trial.fit.values[own]
    spread = trial.fit.covariance[own, own] + np.diag((trial.accuracy * values) ** 2)
    if not np.isfinite(spread).all():
        return 0.0
    return float(values @ np.linalg.pinv(spread, hermitian=True) @ values)


def _strengths(trial: Refined, which: int, first: int, spread: Array) -> list[tuple[float, float]]:
    """The strength of a cause, whose numbers begin at ``first``, with its deviation, of which the
    accuracy of the numerics is a part; where every recording or group has its own, each with that
    of the fit (``spread`` of all numbers, SI)."""
    values = grouped(trial)[which]
    key, strength = next(iter(values.items()))
    if _by_recording(trial, which):
        owners = {
            columns[first]: one for (one, _), columns in zip(trial.each, trial.owned, strict=True)
        }
        return [(values[own_key(key, one)], spread[i]) for i, one in owners.items()]
    return [(strength, trial.value(trial.paths[first])[1])]


def _by_recording(trial: Refined, which: int) -> bool:
    """Whether not all recordings share the strength of a cause."""
    cause = trial.causes[which]
    return bool(trial.owned) and keys_of(cause)[0] in cause.own


def _strong(trial: Refined, which: int, first: int, spread: Array) -> bool:
    """Whether the strength of a cause, whose numbers begin at ``first``, stands out of the
    deviation that is reported of it, of which the accuracy of the numerics is a part; where every
    recording or group has its own (``spread`` of all numbers, SI), that of any one, as far out as
    the largest of so many may be by chance: not every machine need show the cause."""
    cause, values = trial.causes[which], grouped(trial)[which]
    if cause.points:  # as far out by all its values as one number is by itself
        least = chdtri(len(cause.unknown), 2 * ndtr(-OUTSTANDING))
        return bool(_wald(trial, which, first) > least)
    strengths = _strengths(trial, which, first, spread)
    if _by_recording(trial, which):
        least = -ndtri(ndtr(-OUTSTANDING) / len(strengths))
        return any(abs(value) > least * sd for value, sd in strengths)
    ((strength, sd),) = strengths
    if "static" in cause.terms:  # what breaks away at less than it slides with is no such friction
        i, j = first, first + list(values).index("static")
        covariance = trial.fit.covariance
        apart = covariance[i, i] + covariance[j, j] - 2 * covariance[i, j]
        least = np.hypot(np.sqrt(max(apart, 0.0)), ACCURACY * abs(strength))
        differs = values["static"] - values["coulomb"] > OUTSTANDING * least
        return bool(differs and values["static"] > OUTSTANDING * np.sqrt(covariance[j, j]))
    return bool(abs(strength) > OUTSTANDING * sd)


def _shapes(trial: Refined, which: int, first: int, spread: Array) -> Iterator[tuple[bool, bool]]:
    """Of each number of a cause behind its strength, whether it was added to a plain law, and
    whether it stands out of its own deviation (``spread`` of all numbers, SI, those of the cause
    from ``first``): what was added from what the plain law has, an exponent from 1, breakaway from
    sliding friction, what may have either sign by the sign that the plain law has not, or by
    either where its bounds hold both."""
    cause, values = trial.causes[which], grouped(trial)[which]
    keys = list(values)[: cause.numbers]
    for key, sd in list(zip(keys, spread[first:], strict=False))[1:]:
        declared = key_of(cause.kind, key) if key in cause.added else None
        usual = declared.plain(values) if declared else None
        if declared is None or usual is None:
            yield False, bool(abs(values[key]) > OUTSTANDING * sd)
            continue
        beyond = -values[key] if declared.either_sign else abs(values[key] - usual)
        yield True, bool(beyond > OUTSTANDING * sd)
