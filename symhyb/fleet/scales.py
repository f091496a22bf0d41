"""Whether a number varies between units by amounts or by factors.

Sizes: N units, R recordings of one, K numbers, C conditions with the constant one.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.fleet.means import Array, Unit
from symhyb.fleet.members import Member, widths_of
from symhyb.fleet.population import population_of
from symhyb.judgement import ACCURACY, CERTAIN, OUTSTANDING

ROUNDING = 1e-10  # of variances: numbers whose errors are one have a covariance that is singular


def units_in(members: Sequence[Member], factors: Sequence[bool], centre: Array) -> list[Unit]:
    """The estimates of all units, those with ``factors`` (K,) as logarithms; conditions less their
    ``centre``."""
    wide, by_factor = widths_of(members), np.array(factors, dtype=bool)
    found = []
    for member in members:
        values = np.array([one.values for one in member.fits])
        covariances = np.array([one.covariance for one in member.fits])
        for covariance in covariances:
            unknown = np.diag(covariance) > wide**2
            covariance[unknown, :], covariance[:, unknown] = 0.0, 0.0
            covariance[unknown, unknown] = wide[unknown] ** 2
        slope = np.where(by_factor, 1 / np.where(by_factor, values, 1.0), 1.0)
        y = np.where(by_factor, np.log(np.where(by_factor, values, 1.0)), values)
        s = covariances * slope[:, :, None] * slope[:, None, :]
        s = s * (1 + ROUNDING * np.eye(s.shape[1]))
        x = np.column_stack([np.ones(len(values)), member.conditions - centre])
        numerics = ACCURACY * np.where(by_factor, 1.0, np.abs(values))
        found.append(Unit(y, s, x, member.peers, numerics, member.effects))
    return found


def factors_of(members: Sequence[Member], centre: Array, kept: Sequence[bool]) -> tuple[bool, ...]:
    """For each number whether its logarithm is what varies: where all values are positive beyond
    their noise and the likelihood favours it by 100 to 1 on the units that are ``kept``;
    ``centre`` (C − 1,) is that of the conditions, in their units."""
    size = members[0].fits[0].values.size
    chosen = [one for one, use in zip(members, kept, strict=True) if use]
    found = []
    for k in range(size):
        every = [(one.values[k], one.sd[k]) for member in members for one in member.fits]
        positive = all(value > OUTSTANDING * sd for value, sd in every)
        found.append(positive and _gain(chosen, centre, k) > CERTAIN)
    return tuple(found)


def _gain(members: Sequence[Member], centre: Array, k: int) -> float:
    """ln L of one number that varies by factors, less that of one that varies by amounts."""
    size = members[0].fits[0].values.size
    wanted = [i == k for i in range(size)]
    logl = []
    for factors in ([False] * size, wanted):
        units = [_only(one, k) for one in units_in(members, factors, centre)]
        logl.append(population_of(units).full)
    logs = [np.log(one.values[k]) for member in members for one in member.fits]
    return float(logl[1] - np.sum(logs) - logl[0])


def _only(unit: Unit, k: int) -> Unit:
    numerics = unit.numerics[:, [k]]
    return replace(unit, y=unit.y[:, [k]], s=unit.s[:, [k]][:, :, [k]], numerics=numerics)
