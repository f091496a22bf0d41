"""Units that do not belong to the others, and the numbers that say so.

The deviation of a unit from the population is estimated with the population that the others have,

    d = (Zᵀ W⁻¹ Z)⁻¹ Zᵀ W⁻¹ (y − X β),    W = V + X cov(β) Xᵀ,    T² = dᵀ cov(d)⁻¹ d

and T² (ν − K + 1)/(ν K) is distributed as F with K and ν − K + 1 degrees of freedom (Hotelling,
Annals of Mathematical Statistics 2, 1931), ν = N − C. A unit that counts for β is taken out of it
(Cook & Weisberg, Residuals and Influence in Regression, 1982): with its rest e = y − X β and
H = X cov(β) Xᵀ as they are with it, W⁻¹ = V⁻¹ (V − H) V⁻¹ and W⁻¹ (y − X β) = V⁻¹ e without it, so
that nothing is known of one that alone determines what is expected of it. No number is compared
more closely than the numerics of fits allow: recordings count as differing by that, at least.

Where one number alone is off, its own
deviation, the others being as they should, is more powerful, z_k = (cov⁻¹ d)_k/√(cov⁻¹)_kk. The
probability of a unit is the smaller of both kinds, twice (Bonferroni). Those of all units are
judged together, so that of the units that are named one of twenty is expected to be wrong (false
discovery rate: Benjamini & Hochberg, Journal of the Royal Statistical Society B 57, 1995). Units
that are named do not count for the population, which is estimated without them until none is added
or taken back, from medians on (Rousseeuw & Leroy, Robust Regression and Outlier Detection, 1987).

A few numbers of a unit are shifted if that leaves a T² of the rest that is as low as of any other:
the set whose T² is lowest, with a price for each number.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.special import fdtrc
from scipy.stats import false_discovery_control, t

from symhyb.fleet.begun import begun, determined, of_majorities
from symhyb.fleet.means import Array, Unit, groups_of
from symhyb.fleet.population import Population, chosen_population, with_spreads_of
from symhyb.fleet.uneven import scales_of
from symhyb.judgement import CLOSE, FEWEST, NEAR_NOISE, PROBABLE, SIGNIFICANT

ROUNDS = 20  # of leaving out and taking back
TOGETHER = 3  # numbers of one reason at most, beyond as many as there are where they are few
UNKNOWN = 1e-8  # of the information of its own fit: what a unit says of itself beside no others

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Deviation:
    """By how much a unit is off the others: ``shift`` (K,) with ``covariance`` (K, K), ``square``
    T², and its probability if it is one of them."""

    shift: Array
    covariance: Array
    square: float
    probability: float


@dataclass(frozen=True, slots=True, eq=False)
class Shifted:
    """The smallest set of K ``numbers`` (their places) that brings a unit back among the others, by
    how much each is off (``by`` (K,) with ``sd`` (K,), SI or logarithms), and ``rivals``: sets as
    small that do nearly as well."""

    numbers: tuple[int, ...]
    by: Array
    sd: Array
    left: float
    rivals: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """The ``population`` of the units that are ``kept`` (N,), the deviation of every unit, and
    probabilities after correction for their number: of its numbers, and of what its fit leaves
    (N,). ``usual`` (N,) is what fits of the others leave under the same conditions, χ² per sample.
    ``tested`` is whether there are enough units to say who deviates, and ``disputed`` (N,) are
    those of groups of peers of which no more than half are alike, so that none is named."""

    population: Population
    kept: Mask
    deviations: tuple[Deviation, ...]
    by_numbers: Array
    by_rest: Array
    usual: Array
    tested: bool
    disputed: Mask

    def structure(self, at: int) -> bool:
        """Whether what the fit of a unit leaves is more than others leave."""
        return bool(self.by_rest[at] <= 1.0 - PROBABLE)

    def deviates(self, at: int) -> bool:
        """Whether the numbers of a unit are not those of the others."""
        return bool(self.by_numbers[at] <= 1.0 - PROBABLE)


def judged(units: Sequence[Unit], left: Array, freedom: Array) -> Judged:
    """Judge all units of a fleet: ``left`` (N,) is χ² per sample of what the fit of each leaves,
    ``freedom`` (N,) how many independent samples that is from."""
    size, count = units[0].y.shape[1], len(units)
    x = np.array([one.columns for one in units])
    least = x.shape[1] + size - 1 + FEWEST
    if count < least + 1:
        everyone, sure = np.ones(count, dtype=bool), np.ones(count)
        found = chosen_population(units)
        off = _deviations(found, everyone, units, 0)
        return Judged(found, everyone, off, sure, sure, left, False, ~everyone)
    groups = groups_of(units)
    kept, disputed = begun(units, left), np.zeros(count, dtype=bool)
    seen: list[bytes] = []
    for _ in range(ROUNDS):
        seen.append(kept.tobytes())
        found = chosen_population([one for one, use in zip(units, kept, strict=True) if use])
        off = _deviations(found, kept, units, int(kept.sum()) - x.shape[1])
        rest, usual = _of_rest(left, freedom, kept, x)
        raw = np.concatenate([[one.probability for one in off], rest])
        corrected = false_discovery_control(np.clip(raw, 0.0, 1.0))
        by_numbers, by_rest = corrected[:count], corrected[count:]
        alike = np.minimum(by_numbers, by_rest) > 1.0 - PROBABLE
        near = np.minimum(*raw.reshape(2, -1))
        now, _ = of_majorities(alike, near, groups)
        _, disputed = of_majorities(alike & kept, near, groups)  # or alike in turns
        if int(now.sum()) < least or now.tobytes() in seen or not determined(x[now]):
            break
        kept = now
    by_numbers, by_rest = (np.where(disputed, 1.0, one) for one in (by_numbers, by_rest))
    return Judged(found, kept, off, by_numbers, by_rest, usual, True, disputed)


def _deviations(
    found: Population, kept: Mask, units: Sequence[Unit], freedom: int
) -> tuple[Deviation, ...]:
    """The deviation of every unit, those ``kept`` (N,) being in the population; recordings differ
    by as much as the numerics err, at least, and by that part the scatter of groups need not be
    known (Satterthwaite, Biometrics Bulletin 2, 1946)."""
    spread = np.diag(found.within if any(len(one.y) > 1 for one in units) else found.between)
    scales, samples = scales_of(found, kept, units)
    counted = []
    for i, one in enumerate(units):
        lacking = np.maximum(one.numerics**2 / scales[i] - spread, 0.0)
        if lacking.any():
            scattered = spread + np.diagonal(one.s, axis1=1, axis2=2)
            samples[i] /= np.max(scattered / (scattered + lacking)) ** 2
            one = replace(one, s=one.s + lacking[:, :, None] * np.eye(len(spread)))
        counted.append(one)
    population = with_spreads_of(
        found, [one for one, use in zip(counted, kept, strict=True) if use]
    )
    return tuple(
        deviation(population, one, bool(use), freedom - int(use), float(scale), float(known))
        for one, use, scale, known in zip(counted, kept, scales, samples, strict=True)
    )


def deviation(
    found: Population,
    unit: Unit,
    inside: bool,
    freedom: int,
    scale: float = 1.0,
    samples: float = np.inf,
) -> Deviation:
    """By how much one unit is off a population, from which it is taken out if it is ``inside``;
    ``freedom`` are degrees of freedom of the spread, 0 if it is not judged. Its group has
    ``scale`` times the variances of all, which is known as from so many ``samples``."""
    size = unit.y.shape[1]
    variance, (rest, error) = found.variance(unit), found.rest(unit)
    z = np.tile(np.eye(size), (len(unit.y), 1))
    if inside:
        own = np.linalg.solve(variance, z)
        inverse, right = own.T @ (variance - error) @ own, own.T @ rest
        if _unknown(inverse, z.T @ own):
            return Deviation(np.zeros(size), np.linalg.inv(z.T @ own), 0.0, 1.0)
    else:
        weighed = np.linalg.solve(variance + error, z)
        inverse, right = z.T @ weighed, weighed.T @ rest
    shift = np.asarray(np.linalg.solve(inverse, right))
    inverse = inverse / scale
    spread = np.asarray(np.linalg.inv(inverse))
    square = float(shift @ inverse @ shift)
    together, alone, left = 1.0, 1.0, freedom - size + 1
    if left > 0:
        known = 1 / (1 / left + 1 / samples)
        together = float(fdtrc(size, known, square * left / (freedom * size)))
        single = np.abs(inverse @ shift) / np.sqrt(np.diag(inverse))
        alone = size * 2 * float(t.sf(single.max(), 1 / (1 / freedom + 1 / samples)))
    return Deviation(shift, spread, square, min(1.0, 2 * min(together, alone)))


def _unknown(inverse: Array, own: Array) -> bool:
    """Whether the others say nothing of some number of a unit: its information on the deviation
    (K, K) beside that of its ``own`` fit (K, K)."""
    scale = np.sqrt(np.outer(np.diag(own), np.diag(own)))
    return bool(eigh(inverse / scale, own / scale, eigvals_only=True)[0] < UNKNOWN)


def shifted(one: Deviation) -> Shifted:
    """Which numbers of a unit deviate."""
    size = one.shift.size
    inverse = np.linalg.inv(one.covariance)
    most = min(size, TOGETHER) if size > 2 * TOGETHER else size
    fits = {}
    for count in range(1, most + 1):
        for places in combinations(range(size), count):
            part = inverse[np.ix_(places, places)]
            by = np.linalg.solve(part, inverse[list(places)] @ one.shift)
            left = float(one.square - by @ part @ by)
            fits[places] = (left, by, np.sqrt(np.diag(np.linalg.inv(part))))
    best = min(fits, key=lambda places: fits[places][0] + SIGNIFICANT * len(places))
    left, by, sd = fits[best]
    rivals = [
        places
        for places, (other, _, _) in fits.items()
        if places != best and len(places) == len(best) and other < left + CLOSE
    ]
    return Shifted(best, by, sd, left, tuple(sorted(rivals, key=lambda one: fits[one][0])))


def _of_rest(left: Array, freedom: Array, kept: Mask, x: Array) -> tuple[Array, Array]:
    """Probabilities (N,) that a fit leaves as much as it does, if its unit is one of the others
    under the same conditions ``x`` (N, C), and what these leave there (N,): ln χ² varies as it does
    among them, and at least as the noise makes it. What is no more than the noise of the others is
    no deviation."""
    logs, design = np.log(left), x[kept]
    gram = np.linalg.pinv(design.T @ design, hermitian=True)
    off = logs - x @ (gram @ design.T @ logs[kept])
    freed = max(int(kept.sum()) - x.shape[1], 1)
    scatter = float(np.sum(off[kept] ** 2)) / freed
    lever = np.einsum("ni,ij,nj->n", x, gram, x)
    own = np.where(kept, np.maximum(1.0 - lever, 1e-9), 1.0)
    off = off / own  # from what the others leave alone
    error = np.where(kept, 1.0 / own, 1.0 + lever)
    spread = np.sqrt(np.maximum(scatter, 2.0 / np.maximum(freedom, 1.0)) * error)
    found = t.sf(off / spread, freed)
    return np.where(off > np.log(NEAR_NOISE), found, 1.0), np.exp(logs - off)
