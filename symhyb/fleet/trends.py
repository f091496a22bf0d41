"""Units whose numbers change with a condition otherwise than those of the others, as one that ages.

Of a unit with recordings under several conditions, δ in y − X β = Z u + D δ + w + e, with D the
condition and u free, is by how much its slopes differ from those of the population; cov(w + e) is
that of the population and of the fits. Each number and condition is tested by itself (Bonferroni),
units together as deviations are (Benjamini & Hochberg 1995).
Sizes: R recordings of a unit, K numbers, C conditions with the constant one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr
from scipy.stats import false_discovery_control

from symhyb.fleet.means import Array, Unit
from symhyb.fleet.population import Population
from symhyb.judgement import FEWEST, OUTSTANDING, PROBABLE


@dataclass(frozen=True, slots=True)
class OwnSlope:
    """How much more a ``number`` (its place) changes with a condition (``at``, its place without
    the constant one) than in the population, ± ``sd``, for one unit of the condition."""

    number: int
    at: int
    value: float
    sd: float


@dataclass(frozen=True, slots=True)
class OwnTrend:
    """The slopes of one unit that are its own, the most significant first, and the probability of
    as much if they are those of the others, corrected for the number of units."""

    slopes: tuple[OwnSlope, ...]
    probability: float


def own_trends(units: Sequence[Unit], found: Population) -> list[OwnTrend | None]:
    """For each unit how its slopes differ, None where they do not, or it has too few
    recordings."""
    slopes = [list(_slopes(one, found)) for one in units]
    tested = [i for i, one in enumerate(slopes) if one]
    if not tested:
        return [None] * len(units)
    raw = []
    for i in tested:
        far = max(abs(one.value) / one.sd for one in slopes[i])
        raw.append(min(1.0, 2 * len(slopes[i]) * float(ndtr(-far))))
    corrected = dict(zip(tested, false_discovery_control(raw), strict=True))
    result: list[OwnTrend | None] = []
    for i, every in enumerate(slopes):
        chance = float(corrected.get(i, 1.0))
        ordered = sorted(every, key=lambda one: -abs(one.value) / one.sd)
        beyond = [one for one in ordered if abs(one.value) > OUTSTANDING * one.sd]
        result.append(OwnTrend(tuple(beyond), chance) if chance <= 1.0 - PROBABLE else None)
    return result


def _slopes(unit: Unit, found: Population) -> Sequence[OwnSlope]:
    """Every slope of a unit against that of the population."""
    count, size = unit.y.shape
    if count < FEWEST:
        return []
    variance = np.zeros((count * size, count * size))
    accurate = np.broadcast_to(unit.numerics, unit.y.shape)
    for r in range(count):
        part = slice(r * size, (r + 1) * size)
        lacking = np.maximum(accurate[r] ** 2 - np.diag(found.within), 0.0)
        variance[part, part] = unit.s[r] + found.within + np.diag(lacking)
    rest, _ = found.rest(unit)
    result = []
    for at in range(unit.x.shape[1] - 1):
        x = unit.x[:, at + 1]
        if not np.ptp(x) > 0:
            continue
        columns = np.kron(np.column_stack([np.ones(count), x]), np.eye(size))
        weighed = np.linalg.solve(variance, columns)
        covariance: Array = np.linalg.inv(columns.T @ weighed)
        value = covariance @ (weighed.T @ rest)
        slope_sd = found.covariance[size:, size:].diagonal().reshape(-1, size)[at]
        sd = np.sqrt(np.diag(covariance)[size:] + slope_sd)
        result += [OwnSlope(k, at, float(value[size + k]), float(sd[k])) for k in range(size)]
    return result
