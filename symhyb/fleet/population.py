"""What units have in common: mean, dependence on conditions, and the spread between them.

Unit i has recordings r with estimates y_ir and their known covariance S_ir. With the mean m of the
group of peers that a recording is of, or of all, and slopes over conditions x_ir,

    y_ir = m + bᵀ x_ir + u_i + w_ir + e_ir,    u ~ N(0, Σ_u),  w ~ N(0, Σ_w),  e_ir ~ N(0, S_ir)

a multivariate random-effects model: DerSimonian & Laird, Controlled Clinical Trials 7, 1986; Laird
& Ware, Biometrics 38, 1982; Jackson, White & Riley, Biometrical Journal 55, 2013. The spreads
maximise the restricted likelihood (REML: Viechtbauer, Journal of Educational and Behavioral
Statistics 30, 2005), by the steps of Zhou, Hu, Zhou & Lange, Journal of Computational and Graphical
Statistics 28, 2019, which keep them positive. Σ_w is estimated where a unit has several recordings.
Sizes: N units, R recordings of one, K numbers, P conditions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.fleet.means import Array, Batch, Layout, Means, Unit, batches_of, layout_of, means_of

STEPS_MOST = 400
SETTLED = 1e-5  # of ln L: steps that gain less end the estimate
LEAST = 1e-12  # of the squares: a spread that is smaller is none


@dataclass(frozen=True, slots=True, eq=False)
class Population:
    """The estimate: ``beta`` (P + 1, K), the mean of the means of all groups of peers and slopes,
    with ``covariance`` ((P + 1)K, (P + 1)K), all ``means`` behind it, the spreads ``between`` units
    and ``within`` one (K, K), and the log of the restricted likelihood ``logl``; ``full`` is
    ln L of the data themselves. ``seen`` (K,) is twice the
    information of the units on the square of the spread of each number."""

    beta: Array
    covariance: Array
    means: Means
    between: Array
    within: Array
    logl: float
    full: float
    seen: Array

    def variance(self, unit: Unit) -> Array:
        """The covariance (R·K, R·K) of the estimates of a unit, the means being known."""
        count, size = unit.y.shape
        found = np.kron(np.ones((count, count)), self.between)
        for r in range(count):
            part = slice(r * size, (r + 1) * size)
            found[part, part] += unit.s[r] + self.within
        return np.asarray(found)

    def rest(self, unit: Unit) -> tuple[Array, Array]:
        """The estimates of a unit less what is expected of it (R·K,), and the covariance of what is
        expected (R·K, R·K)."""
        (batch,) = batches_of([unit], self.means.layout)
        return self.means.rest(batch)[0], self.means.error(batch)[0]

    @property
    def spread_sd(self) -> Array:
        """One standard deviation (K,) of the standard deviations between units, from the expected
        information (Viechtbauer 2005, eq. 17); of a spread of 0 that of its square root is used."""
        of_square = np.sqrt(2.0 / np.maximum(self.seen, 1e-300))
        square = np.diag(self.between)
        sure = square > of_square / 2
        of_root = of_square / np.sqrt(4 * np.where(sure, square, 1.0))
        return np.asarray(np.where(sure, of_root, np.sqrt(of_square)))


@dataclass(frozen=True, slots=True, eq=False)
class _Now:
    """β, its covariance and ln L under two spreads, and what a step of them needs: sums of squares
    of the scores and of the projected weights, of units (K, K) and of recordings (K, K)."""

    population: Population
    scores: tuple[Array, Array]
    weights: tuple[Array, Array]


def population_of(units: Sequence[Unit], joint: bool = True) -> Population:
    """The population of units, all spreads from the data; ``joint`` with covariances between
    numbers, else each number varies by itself."""
    layout = layout_of(units)
    batches = list(batches_of(units, layout))
    size, many = units[0].y.shape[1], sum(len(one.y) for one in units) > len(units)
    begin = _variances(units)
    none = np.zeros((size, size))
    now = _at(batches, layout, np.diag(begin), np.diag(begin) / 2 if many else none)
    for _ in range(STEPS_MOST):
        spreads = [
            _moved(spread, score, weight, joint) if spread.any() else spread
            for spread, score, weight in zip(
                (now.population.between, now.population.within),
                now.scores,
                now.weights,
                strict=True,
            )
        ]
        before, now = now.population.logl, _at(batches, layout, *spreads)
        if abs(now.population.logl - before) < SETTLED:
            break
    found = _cleared(now.population, np.diag(begin))
    return replace(found, seen=_seen(found, units))


def chosen_population(units: Sequence[Unit]) -> Population:
    """The population with covariances between numbers, where Schwarz's criterion (BIC, Annals of
    Statistics 6, 1978) favours them over numbers that vary by themselves."""
    alone, size = population_of(units, joint=False), units[0].y.shape[1]
    if size == 1 or len(units) <= size:
        return alone
    joint = population_of(units)
    price = 0.5 * size * (size - 1) / 2 * np.log(len(units)) * (2 if joint.within.any() else 1)
    return joint if joint.logl - alone.logl > price else alone


def with_spreads_of(found: Population, units: Sequence[Unit]) -> Population:
    """The means of units under the spreads of a population."""
    layout = layout_of(units)
    batches = list(batches_of(units, layout))
    now = _at(batches, layout, found.between, found.within).population
    return replace(now, seen=found.seen)


def _variances(units: Sequence[Unit]) -> Array:
    """Where the spreads begin (K,): variances of the means of units within groups."""
    means = np.array([one.y.mean(axis=0) for one in units])
    groups = np.array([one.groups.mean(axis=0) for one in units])
    level = np.linalg.pinv(groups.T @ groups, hermitian=True) @ (groups.T @ means)
    return np.asarray(np.maximum(np.mean((means - groups @ level) ** 2, axis=0), 1e-300))


def _at(batches: Sequence[Batch], layout: Layout, between: Array, within: Array) -> _Now:
    """The means by generalised least squares under two spreads, and the likelihood."""
    inverses, logdet, size = [], 0.0, len(between)
    for one in batches:
        v = one.s + np.kron(np.eye(one.count), within)
        v = v + np.kron(np.ones((one.count, one.count)), between)
        inverses.append(np.linalg.inv(v))
        logdet += float(np.linalg.slogdet(v)[1].sum())
    means = means_of(batches, inverses, layout)
    squares, zero = 0.0, np.zeros((size, size))
    scores, weights = [zero, zero], [zero, zero]
    for one, inverse in zip(batches, inverses, strict=True):
        rest = means.rest(one)
        q = np.einsum("nij,nj->ni", inverse, rest)
        squares += float(np.sum(rest * q))
        projected = inverse - inverse @ means.error(one) @ inverse
        n = len(one.y)
        g = q.reshape(n, one.count, size)
        blocks = projected.reshape(n, one.count, size, one.count, size)
        whole, sums = blocks.sum(axis=(1, 3)), g.sum(axis=1)
        own = np.einsum("nrirj->nrij", blocks)
        scores[0] = scores[0] + sums.T @ sums
        weights[0] = weights[0] + whole.sum(axis=0)
        scores[1] = scores[1] + np.einsum("nri,nrj->ij", g, g)
        weights[1] = weights[1] + own.sum(axis=(0, 1))
    full = -0.5 * (logdet + squares)
    beta, covariance = means.overall(size)
    logl = full - 0.5 * means.logdet
    found = Population(beta, covariance, means, between, within, logl, full, np.zeros(size))
    return _Now(found, (scores[0], scores[1]), (weights[0], weights[1]))


def _moved(spread: Array, score: Array, weight: Array, joint: bool) -> Array:
    """The spread after a step: the positive matrix Σ' with Σ' A Σ' = Σ B Σ."""
    if not joint:
        return np.diag(np.diag(spread) * np.sqrt(np.diag(score) / np.diag(weight)))
    size = np.sqrt(np.diag(weight))  # numbers have units of their own
    balance = np.outer(size, size)
    root = _root(weight / balance)
    inverse, middle = np.linalg.inv(root), spread * balance
    found = inverse @ _root(root @ middle @ (score / balance) @ middle @ root) @ inverse
    return np.asarray((found + found.T) / 2 / balance)


def _root(matrix: Array) -> Array:
    """The positive root of a positive matrix."""
    values, axes = np.linalg.eigh((matrix + matrix.T) / 2)
    least = max(float(values[-1]) * LEAST, 1e-300)
    return np.asarray((axes * np.sqrt(np.maximum(values, least))) @ axes.T)


def _seen(found: Population, units: Sequence[Unit]) -> Array:
    """tr P P (K,) of each number by itself, as the variances of all units give it."""
    z = [np.tile(np.eye(one.y.shape[1]), (len(one.y), 1)) for one in units]
    inner = [
        part.T @ np.linalg.solve(found.variance(one), part)
        for part, one in zip(z, units, strict=True)
    ]
    weights = 1 / np.array([np.diag(np.linalg.inv(one)) for one in inner])
    x = np.array([one.columns for one in units])
    result = []
    for w in weights.T:
        weighed = w[:, None] * x
        inverse = np.linalg.pinv(x.T @ weighed, hermitian=True)
        projected = np.diag(w) - weighed @ inverse @ weighed.T
        result.append(float(np.sum(projected**2)))
    return np.array(result)


def _cleared(found: Population, scale: Array) -> Population:
    """The same without spreads that are nothing but rounding."""
    least = LEAST * np.diag(scale)

    def cleared(spread: Array) -> Array:
        kept = np.diag(spread) > least
        return np.where(np.outer(kept, kept), spread, 0.0)

    return replace(found, between=cleared(found.between), within=cleared(found.within))
