"""The one score of a structure: ln of its marginal likelihood times the prior odds of its causes.

    ln p(y|S) ≈ ln L(θ̂) + ln p(θ̂) + ½ F ln 2π − ½ ln |H|

Every number has a proper prior: a parameter its stated sd, the strength of a law the force that
moves its place, a shape the range that is tried, a channel's fault what channels do, the values of
a curve those of a smooth line (:mod:`~.curves.prior`) of one of some lengths, strengths of single
recordings a mean that all share, and one of some sizes by which they differ. Each cause costs ln of
the number of candidates (a priori one of the list is expected), sizes of noise ½ ln N each. Sizes:
F numbers, N samples.

How wide a prior is that nobody stated is a matter of opinion, and sets the odds of two causes that
the recordings hardly distinguish. ``by_reference`` it is as wide as what one sample says.

Sources: MacKay, Neural Computation 4, 1992 (Laplace); Kass & Raftery, JASA 90, 1995; Kass &
Wasserman, JASA 90, 1995 (the prior of one sample); Chen & Chen, Biometrika 95, 2008 (the price of a
long list); Laird & Ware, Biometrics 38, 1982 (numbers of one population).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.catalogue import classes_of
from symhyb.correction.adequacy.classes.columns import LENGTHS
from symhyb.correction.adequacy.curves.courses import form_of, size_at
from symhyb.correction.adequacy.curves.prior import of_curve
from symhyb.correction.adequacy.pairs import pair_size
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.trajectory import firsts_of, gathered, keys_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.vocabulary import KINDS, key_of
from symhyb.numeric.kernels.buffers import Array

GAIN_SD = 0.1  # of a channel's gain that is off
DELAY_SD = 10.0  # samples, of a channel that is late
HELD_SD = 0.3  # relative, of a number that the file holds without an sd
ADDED_SD = 3.0  # of what is tried first: a key that bends a plain law
UNIFORM = 12**-0.5  # standard deviation of a uniform distribution over its range
WIDEST = np.log(1e4)  # of a shape without bounds: the logarithm of the range that is possible
PLAIN_OUTSIDE = 1.0  # of the magnitude: the prior of a number that nothing else is known of
APART = np.exp(np.linspace(-WIDEST, 0.0, 14))  # of the size of a strength: how far own ones differ


def evidence(recorded: Recorded, trial: Fitted, by_reference: bool = False) -> float:
    """ln of marginal likelihood and prior odds; −∞ for a fit that failed. ``by_reference``: with
    as much as one sample says as the prior of each number of which the file states nothing."""
    if trial.fit.reason or not np.isfinite(trial.fit.logl):
        return -np.inf
    mean, spread = priors(recorded, trial)
    unstated = _unstated(trial)
    related = [] if by_reference else [*_curves(trial), *_populations(trial)]
    if by_reference:
        single = np.sqrt(trial.fit.count / np.diag(trial.fit.information).clip(1e-300))
        mean = np.where(unstated > 0, trial.fit.values, mean)
        spread = np.where(unstated > 0, single, spread)
    off = (trial.fit.values - mean) / spread
    # the information holds stated priors already: that of an uncertain parameter is not less than 1
    information = trial.fit.information * np.outer(spread, spread)
    known, less = _known(information, np.diag(unstated), off, related)
    volume = float(np.linalg.slogdet(information + known)[1]) if known.size else 0.0
    noise = trial.fit.noise.price(trial.fit.count)
    odds = len(trial.causes) * np.log(max(candidates(recorded), 2))
    if trial.extra is not None:
        odds += np.log(max(classes(recorded), 2) * trial.extra.tried)
    return float(trial.fit.logl - less - 0.5 * volume - noise - odds)


class Related(NamedTuple):
    """Numbers, by their places among all, that are not known each by itself: what their ``priors``
    may be, each as a covariance (P, P) in units of the deviation of one of them."""

    own: list[int]
    priors: tuple[Array, ...]


def _known(
    information: Array, known: Array, off: Array, related: Sequence[Related]
) -> tuple[Array, float]:
    """The precision (F, F) of the priors that the fit did not hold, and what it costs beside the
    volume, in ln, that the numbers are ``off`` (F,) the priors' means; ``information`` (F, F) and
    all else in units of the priors' deviations, with a prior of each by itself ``known`` (F, F).
    ``related`` numbers have the likeliest of their priors, which moves those that the recordings
    show badly: the cost is that of both together."""
    cost = 0.5 * float(off @ off)
    for own, priors_of in related:
        y, shown = off[own], _beside_others(information, known, own)
        one, best = np.eye(len(own)), (np.inf, 0.0, known)
        for prior in priors_of:
            apart = y @ np.linalg.solve(one + shown @ prior, shown @ y)
            less = float(apart + np.linalg.slogdet(prior)[1])
            precise = _with(known, own, np.asarray(np.linalg.inv(prior), dtype=np.float64))
            whole = less + float(np.linalg.slogdet(information + precise)[1])
            best = min(best, (whole, less, precise), key=lambda one: one[0])
        known = best[2]
        cost += 0.5 * (best[1] - float(y @ y)) + float(np.log(len(priors_of)))
    return known, cost


def _beside_others(information: Array, known: Array, own: list[int]) -> Array:
    """How well some numbers (P, P) are seen where all others are what is likeliest beside them."""
    rest = [i for i in range(len(information)) if i not in own]
    across = information[np.ix_(own, rest)]
    others = (information + known)[np.ix_(rest, rest)]
    return np.asarray(information[np.ix_(own, own)] - across @ np.linalg.solve(others, across.T))


def _with(known: Array, own: list[int], block: Array) -> Array:
    """A precision (F, F) with the ``block`` (P, P) at the numbers ``own``."""
    changed = known.copy()
    changed[np.ix_(own, own)] = block
    return changed


def _curves(trial: Fitted) -> Iterator[Related]:
    """The values of every curve, which lie along a smooth line."""
    for cause, first in zip(trial.all_causes, firsts_of(trial.all_causes), strict=True):
        if cause.points:
            keys = enumerate(keys_of(cause), first)
            own = [i for i, key in keys if key in cause.unknown]
            lines = tuple(of_curve(cause, length) for length in LENGTHS)
            yield Related([trial.owned[0][i] for i in own] if trial.owned else own, lines)


def _populations(trial: Fitted) -> Iterator[Related]:
    """The strengths of each law that not all recordings share: those of one population, whose mean
    is known as a shared strength is."""
    for cause, first in zip(trial.all_causes, firsts_of(trial.all_causes), strict=True):
        if cause.place is None or cause.points or cause.keys[0] not in cause.own:
            continue
        own = sorted({columns[first] for columns in trial.owned})
        mean, apart = np.ones((len(own), len(own))), np.eye(len(own))
        if len(own) > 1:
            yield Related(own, tuple(mean + size**2 * apart for size in APART))


def _unstated(trial: Fitted) -> Array:
    """1 for each number (F,) whose prior the fit did not hold, 0 for a parameter's stated one."""
    declared = {item.path: item for item in trial.machine.model.all_parameters()}
    rows = [
        0.0 if cause.place is None and declared[cause.path].sd else 1.0
        for cause in trial.all_causes
        for _ in keys_of(cause)
    ]
    more = 0 if trial.extra is None else trial.extra.spread.size
    return np.append(gathered(np.array(rows), trial.owned), np.zeros(more))


def candidates(recorded: Recorded) -> int:
    """How many causes compete."""
    return len({cause.family for cause in recorded.hypotheses})


def classes(recorded: Recorded) -> int:
    """How many generic classes compete."""
    return len(classes_of(recorded))


def priors(recorded: Recorded, trial: Fitted) -> tuple[Array, Array]:
    """Mean and standard deviation (F,) of every number before these recordings, SI."""
    declared = {item.path: item for item in trial.machine.model.all_parameters()}
    strengths = strength_scales(recorded)
    places = recorded.library.places
    means, spreads = [], []
    i = 0
    for cause in trial.all_causes:
        for key in keys_of(cause):
            value = float(trial.fit.values[i])
            if cause.place is None and cause.shape:  # the number of an actuator
                means.append(value)
                spreads.append((abs(value) or 1.0) * float(WIDEST) * UNIFORM)
            elif cause.place is None:
                item = declared[cause.path]
                means.append(item.si)
                spreads.append(_channel_sd(recorded, cause, item.si, item.si_sd))
            elif key in cause.factors:  # a change of what a curve is multiplied by
                means.append(-cause.factors[key][1])
                spreads.append(1.0)
            elif cause.points:  # a value of a curve
                means.append(0.0)
                spreads.append(size_at(recorded, places.index(cause.place), form_of(cause)))
            else:
                middle, width = _law_prior(recorded, cause, key, value, strengths)
                means.append(middle)
                spreads.append(width)
            i += 1
    mean, spread = (gathered(np.array(row), trial.owned) for row in (means, spreads))
    if trial.extra is None:
        return mean, spread
    more = trial.extra
    return np.append(mean, more.mean * more.spread), np.append(spread, more.spread)


def _channel_sd(recorded: Recorded, cause: Hypothesis, value: float, sd: float | None) -> float:
    """Prior deviation of a number of the model or of a channel, SI."""
    if sd is not None and sd > 0:
        return sd
    if cause.kind == "gain":
        return GAIN_SD * abs(value)
    if cause.kind == "delay":
        return DELAY_SD * recorded.step_s
    if cause.kind == "offset":
        return _spread_of(recorded, cause.path.removesuffix(".offset"))
    return HELD_SD * abs(value) or 1.0


def _spread_of(recorded: Recorded, channel: str) -> float:
    """Standard deviation of what a channel recorded, SI; 1 if it recorded nothing that changes."""
    sizes = []
    for item in recorded.items:
        recording = item.source[0]
        values = recording.sensors.get(channel, recording.inputs.get(channel))
        if values is not None and np.isfinite(values).any():
            sizes.append(float(np.nanstd(values)))
    return max(sizes, default=0.0) or 1.0


def _law_prior(
    recorded: Recorded,
    cause: Hypothesis,
    key: str,
    value: float,
    strengths: Mapping[tuple[object, ...], float],
) -> tuple[float, float]:
    """Prior mean and deviation of a key of a law."""
    law = KINDS.get(cause.kind)
    if law is not None and law.coupling is not None:
        return 0.0, pair_size(recorded, cause) or 1.0
    for kind in (cause.kind, law.subject if law else ""):
        size = strengths.get((kind, cause.place, cause.path, key))
        if size is not None:
            return 0.0, size
    if key in cause.added:
        declared = key_of(cause.kind, key)
        plain = declared.plain({}) if declared and key != "static" else None
        return plain or 0.0, ADDED_SD * abs(dict(cause.shape)[key]) or 1.0
    low, high = cause.limits(key)
    if key == "phase":
        return value, 2 * np.pi * UNIFORM
    if key == "frequency":  # a line was looked for in the whole spectrum
        return value, 0.5 / recorded.step_s * UNIFORM
    if key == "period":  # and along the whole travel
        return value, abs(value) * float(WIDEST) * UNIFORM
    if np.isfinite(low) and np.isfinite(high) and low > 0:
        return value, max(abs(value), low) * float(np.log(high / low)) * UNIFORM
    if np.isfinite(low) and np.isfinite(high):
        return value, (high - low) * UNIFORM
    if key in cause.refined:
        return value, (abs(value) or 1.0) * float(WIDEST) * UNIFORM
    return 0.0, PLAIN_OUTSIDE * abs(value) or 1.0


def strength_scales(recorded: Recorded) -> dict[tuple[object, ...], float]:
    """The strength, SI, at which each law would make the force that moves its place, by kind,
    place, path and key."""
    sizes: dict[tuple[object, ...], float] = {}
    for cause, columns in zip(recorded.library.hypotheses, recorded.library.columns, strict=True):
        for key, column in zip(cause.keys, columns, strict=False):
            name = (cause.kind, cause.place, cause.path, key)
            if key in cause.refined or key in ("phase", "asymmetry") or name in sizes:
                continue
            share = float(
                np.max(recorded.probe_sizes[:, column] / recorded.scale_or_inf, initial=0)
            )
            if share > 0:
                sizes[name] = 1 / share
    return sizes
