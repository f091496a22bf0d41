"""How much more, or less, the units of a group of peers scatter than those of others.

Spreads are the same in all groups; what a structure lacks is not, so that units of some groups
differ by more, and of some by less. With the rest e = y − X β of a unit, its variance V and the
error H of what is expected of it (:mod:`symhyb.fleet.deviations`) a group has

    λ_g = Q_g/ν_g,    Q_g = Σ eᵀV⁻¹e,    ν_g = Σ tr(I − V⁻¹H)

which varies by more than χ²/ν does where groups differ. Their scales are those of a population,
1/λ ~ χ²(ν₀)/(ν₀ λ₀), by the moments of ln λ (Smyth, Statistical Applications in Genetics and
Molecular Biology 3, 2004, section 6.2), where ln λ₀ is a sum of effects of the values that
groupings have: at one load units may scatter by twice as much on every motion. A group is drawn
towards that,

    λ = (ν₀ λ₀ + Q_g)/(ν₀ + ν_g)

known as from ν₀ + ν_g samples, ν₀ counting the error of the effects. A group that scatters by
far less than that, as one whose fits all end at bounds, counts as three deviations below it (after
Phipson, Lee, Majewski, Alexander & Smyth, Annals of Applied Statistics 10, 2016): its logarithm
would make the population so wide that groups said nothing of each other. Where groups do not
differ all λ are 1, and ν₀ is infinite. Sizes: N units, G groups, T effects.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import digamma, polygamma

from symhyb.fleet.begun import NORMAL
from symhyb.fleet.means import Array, Unit, groups_of
from symhyb.fleet.population import Population
from symhyb.judgement import FEWEST, OUTSTANDING

Mask = NDArray[np.bool_]
ROUNDS = 50  # of Newton's, for ν₀
SETTLED = 1e-3  # of ln λ
LEAST = 1e-3  # of the variance of ln λ: ν₀ is 2000 then


def scales_of(found: Population, kept: Mask, units: Sequence[Unit]) -> tuple[Array, Array]:
    """λ (N,), dimensionless, for each unit by the others of its group that are ``kept`` (N,), and
    how many samples it is as well known as from (N,)."""
    count = len(units)
    _, first, which = np.unique(groups_of(units), axis=0, return_index=True, return_inverse=True)
    which = np.asarray(which).ravel()
    square, freedom, own, size = (np.zeros(count) for _ in range(4))
    for i in map(int, np.flatnonzero(kept)):
        variance, (rest, error) = found.variance(units[i]), found.rest(units[i])
        inverse = np.linalg.inv(variance)
        square[i] = rest @ inverse @ rest
        size[i] = rest.size
        freedom[i] = rest.size - np.sum(inverse * error)
        own[i] = rest @ np.linalg.pinv(variance - error, hermitian=True) @ rest
    squares, freed = (np.bincount(which, one).astype(np.float64) for one in (square, freedom))
    effects = np.array([units[int(i)].effects for i in first])
    at, before = population_of_scales(squares, freed, effects)
    if not np.isfinite(before).all():
        return np.ones(count), np.full(count, np.inf)
    others = np.maximum(squares[which] - own, 0.0)
    samples = np.maximum(freed[which] - size, 0.0)
    at, before = at[which], before[which]
    return (before * at + others) / (before + samples), before + samples


def population_of_scales(square: Array, freedom: Array, effects: Array) -> tuple[Array, Array]:
    """λ₀ and ν₀ (G,) of groups whose Q and ν (G,), dimensionless, and ``effects`` (G, T: 1 where a
    group has one) are given; ν₀ is infinite where groups differ by no more than by chance."""
    even = np.ones(square.size), np.full(square.size, np.inf)
    seen = (freedom >= 1.0) & (square > 0)
    if seen.sum() < FEWEST:
        return even
    half = freedom[seen] / 2
    logs = np.log(square[seen] / freedom[seen]) - digamma(half) + np.log(half)
    noise = float(np.mean(polygamma(1, half)))
    if np.var(logs, ddof=1) <= noise:
        return even
    x = np.column_stack([np.ones(square.size), effects])
    if seen.sum() - np.linalg.matrix_rank(x[seen]) < FEWEST:
        x = x[:, :1]
    gram = np.linalg.pinv(x[seen].T @ x[seen], hermitian=True)
    beta = gram @ x[seen].T @ logs
    for _ in range(ROUNDS):
        off = logs - x[seen] @ beta
        low = x[seen] @ beta - OUTSTANDING * NORMAL * float(np.median(np.abs(off)))
        if np.all(logs >= low - SETTLED):
            break
        logs = np.maximum(logs, low)
        beta = gram @ x[seen].T @ logs
    left = int(seen.sum()) - np.linalg.matrix_rank(x[seen])
    whole = float(np.sum((logs - x[seen] @ beta) ** 2)) / left
    more = max(whole - noise, LEAST)
    half_before = _of_trigamma(more)
    at = np.exp(x @ beta + digamma(half_before) - np.log(half_before))
    lever = np.einsum("gt,tu,gu->g", x, gram, x)
    before = np.array([2 * _of_trigamma(more + float(part) * whole) for part in lever])
    return at, before


def _of_trigamma(value: float) -> float:
    """Where the trigamma function has a value (Smyth 2004, appendix)."""
    x = 0.5 + 1 / value
    for _ in range(ROUNDS):
        now = float(polygamma(1, x))
        step = now * (1 - now / value) / float(polygamma(2, x))
        x += step
        if abs(step) < 1e-8 * x:
            break
    return x
