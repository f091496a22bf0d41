"""Units that do not belong to the others, and the numbers that say so.

The deviation of a unit from the population is estimated with the population that the others have,

    d = (Zᵀ W⁻¹ Z)⁻¹ Zᵀ W⁻¹ (y − X β),    W = V + X cov(β) Xᵀ,    T² = dᵀ cov(d)⁻¹ d

and T² (ν − K + 1)/(ν K) is distributed as F with K and ν − K + 1 degrees of freedom (Hotelling,
Annals of Mathematical Statistics 2, 1931), ν = N − C. Where one number alone is off, its own
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
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtrc
from scipy.stats import false_discovery_control, t

from symhyb.fleet.population import Array, Population, Unit, chosen_population
from symhyb.judgement import CLOSE, FEWEST, NEAR_NOISE, PROBABLE, SIGNIFICANT

ROUNDS = 20  # of leaving out and taking back
TOGETHER = 3  # numbers of one reason at most, beyond as many as there are where they are few
NORMAL = 1.4826  # of a median deviation: the standard deviation of normal errors

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
    ``tested`` is whether there are enough units to say who deviates."""

    population: Population
    kept: Mask
    deviations: tuple[Deviation, ...]
    by_numbers: Array
    by_rest: Array
    usual: Array
    tested: bool

    def structure(self, at: int) -> bool:
        """Whether what the fit of a unit leaves is more than others leave."""
        return bool(self.by_rest[at] <= 1.0 - PROBABLE)

    def deviates(self, at: int) -> bool:
        """Whether the numbers of a unit are not those of the others."""
        return bool(self.by_numbers[at] <= 1.0 - PROBABLE)


def judged(units: Sequence[Unit], left: Array, freedom: Array) -> Judged:
    """Judge all units of a fleet: ``left`` (N,) is χ² per sample of what the fit of each leaves,
    ``freedom`` (N,) how many independent samples that is from."""
    size, conditions = units[0].y.shape[1], units[0].x.shape[1]
    count = len(units)
    least = conditions + size - 1 + FEWEST
    if count < least + 1:
        everyone, sure = np.ones(count, dtype=bool), np.ones(count)
        found = chosen_population(units)
        off = tuple(deviation(found, one, everyone, units, 0) for one in range(count))
        return Judged(found, everyone, off, sure, sure, left, False)
    kept, x = begun(units, left), np.array([one.x.mean(axis=0) for one in units])
    seen: list[bytes] = []
    for _ in range(ROUNDS):
        seen.append(kept.tobytes())
        found = chosen_population([one for one, use in zip(units, kept, strict=True) if use])
        freed = int(kept.sum()) - conditions
        off = tuple(deviation(found, one, kept, units, freed) for one in range(count))
        rest, usual = _of_rest(left, freedom, kept, x)
        raw = np.concatenate([[one.probability for one in off], rest])
        corrected = false_discovery_control(np.clip(raw, 0.0, 1.0))
        by_numbers, by_rest = corrected[:count], corrected[count:]
        now = np.minimum(by_numbers, by_rest) > 1.0 - PROBABLE
        if int(now.sum()) < least or now.tobytes() in seen or not _determined(units, now):
            break
        kept = now
    return Judged(found, kept, off, by_numbers, by_rest, usual, True)


def deviation(
    found: Population, at: int, kept: Mask, units: Sequence[Unit], freedom: int
) -> Deviation:
    """By how much one unit is off a population, from which it is taken out if it is ``kept`` (N,),
    dimensionless, in it; ``freedom`` are degrees of freedom of the spread, 0 if it is not
    judged."""
    unit = units[at]
    size = unit.y.shape[1]
    variance, x = found.variance(unit), unit.design
    gram = np.linalg.inv(found.covariance)
    right = gram @ found.beta.ravel()
    if kept[at] and kept.sum() > 1:
        weighed = np.linalg.solve(variance, x)
        gram = gram - x.T @ weighed
        right = right - weighed.T @ unit.y.ravel()
    covariance = np.linalg.pinv(gram, hermitian=True)
    rest = unit.y.ravel() - x @ (covariance @ right)
    z = np.tile(np.eye(size), (len(unit.y), 1))
    weighed = np.linalg.solve(variance + x @ covariance @ x.T, z)
    inverse = z.T @ weighed
    spread = np.linalg.inv(inverse)
    shift = spread @ (weighed.T @ rest)
    square = float(shift @ inverse @ shift)
    whole = freedom - int(kept[at])
    together, alone = 1.0, 1.0
    if whole - size + 1 > 0:
        together = float(
            fdtrc(size, whole - size + 1, square * (whole - size + 1) / (whole * size))
        )
        single = np.abs(inverse @ shift) / np.sqrt(np.diag(inverse))
        alone = size * 2 * float(t.sf(single.max(), whole))
    return Deviation(shift, spread, square, min(1.0, 2 * min(together, alone)))


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


def begun(units: Sequence[Unit], left: Array) -> Mask:
    """The units (G,) to begin with: those within the median deviations, number by number, that
    normal ones of so many reach. As many of the smallest as there are numbers in β beside the mean
    do not count for the median, since least absolute deviations pass through units (DuMouchel &
    O'Brien, Proceedings of the 21st Symposium on the Interface, 1989)."""
    means = np.array([one.y.mean(axis=0) for one in units])
    x = np.array([one.x.mean(axis=0) for one in units])
    beta = np.linalg.lstsq(x, means, rcond=None)[0]
    for _ in range(ROUNDS):  # least absolute deviations by weights
        weights = 1 / np.maximum(
            np.abs(means - x @ beta), 1e-9 * np.abs(means).max(axis=0) + 1e-300
        )
        beta = np.stack(
            [
                np.linalg.lstsq(x * w[:, None] ** 0.5, y * w**0.5, rcond=None)[0]
                for w, y in zip(weights.T, means.T, strict=True)
            ],
            axis=1,
        )
    columns = np.column_stack([means - x @ beta, np.log(left)])
    columns = columns - np.median(columns, axis=0)
    free = np.sort(np.abs(columns), axis=0)[x.shape[1] - 1 :]
    scale = NORMAL * np.median(free, axis=0)
    noise = [np.sqrt([one.s[:, k, k].mean() for one in units]) for k in range(means.shape[1])]
    wide = np.column_stack([np.hypot(scale[:-1], np.array(noise).T), np.full(len(left), scale[-1])])
    reach = float(t.isf(0.5 / columns.size, len(units) - x.shape[1]))
    kept = np.all(np.abs(columns) <= reach * np.maximum(wide, 1e-300), axis=1)
    enough = kept.sum() > len(units) / 2 and _determined(units, kept)
    return kept if enough else np.ones(len(units), dtype=bool)


def _determined(units: Sequence[Unit], kept: Mask) -> bool:
    """Whether the units that are kept determine what depends on conditions and groups."""
    x = np.concatenate([one.x for one, use in zip(units, kept, strict=True) if use])
    return bool(np.linalg.matrix_rank(x) == x.shape[1])


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
