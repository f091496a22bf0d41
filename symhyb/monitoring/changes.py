"""Whether blocks of a recording differ from a reference, since when, and by which cause.

Every block b has the information matrix S_b of all columns of all causes and their score g_b (the
Gram matrix of the whitened columns, and its product with what the model leaves). In the reference a
column explains θ = Σ g / Σ S of that: what the model lacks already. What a block says otherwise is

    z_b = (g_b − S_b θ) / √(S_b (φ + ε² m_b))

where φ is what the reference scatters by, in units of the noise, m_b the squares of all that moves,
and ε the accuracy of the numerics: what does less than that to the sensors is no change. φ is at
least 1, and otherwise such that the z of the reference itself have a mean square of 1, blocks at
rest and blocks that move alike (Paule & Mandel).

A model that is not perfect, along motion that is not always the same, leaves blocks that stand far
out, and blocks that resemble their neighbours. So no block counts more than the largest one of the
reference, or than those that one of ten exceeds, and none as much within its own deviation:
w_b = z_b over that size, which is at least 1, within ±1. A change lasts; of L blocks it is as
improbable as (Chernoff's bound)

    P(|Σ w| ≥ s) ≤ 2 min_t exp((L ln M(t) − t s) / κ)      M: mean of cosh t w in the reference,
                                                           one more of the largest size added

where κ = c + L/B₀ is by how much more such a sum varies than if neighbours did not resemble each
other (c) and θ were known. All columns, lengths and both sizes are tried at every block, so that
each test has its share of the false alarms that are allowed (Bonferroni).

What has changed is the cause that explains most of the blocks since the likeliest beginning.

Sources: Basseville & Nikiforov, Detection of Abrupt Changes, 1993, §2.4 (time and size of a change
by generalised likelihood ratio; Lorden, Annals of Mathematical Statistics 42, 1971); Huber, Robust
Statistics, 1981, §1.7 (bounded scores); Chernoff, Annals of Mathematical Statistics 23, 1952;
Paule & Mandel, Journal of Research of the National Bureau of Standards 87, 1982, p. 377 (φ).
Sizes: B blocks, F columns, C causes, T values of t.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from symhyb.judgement import ACCURACY, OUTSTANDING, SIGNIFICANT
from symhyb.numeric.kernels.buffers import Array

SHOWN_LEAST = 5.0  # blocks' worth of a reference in which a column shows
LENGTHS = (1, 2, 3, 4, 5, 6, 8, 12, 16, 24, 32, 48, 64)  # of a change, in blocks
EXCEEDED = (0.0, 0.1)  # shares of the reference that are beyond the most that a block counts
TILTS = np.geomspace(0.05, 40, 60)  # t
HALVINGS = 60  # of an interval, in which φ lies
SUMS_LEAST = 4  # apart from each other, by which their variance is known
DAY_S = 86_400.0


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """A stretch of the source from ``start_s`` to ``end_s``, reduced: ``information`` (F, F) and
    ``score`` (F,) of all columns, for one SI unit of each and in units of the noise, and the
    squares of the ``motion`` in these units."""

    start_s: float
    end_s: float
    information: Array
    score: Array
    motion: float = 0.0


@dataclass(frozen=True, eq=False)  # no slots: what every new block needs is kept
class Bounded:
    """The blocks of a reference, none of which counts more than ``most`` (F,): their w (B, F);
    dimensionless."""

    most: Array
    w: Array

    @cached_property
    def cumulants(self) -> Array:
        """ln M (T, F), dimensionless."""
        largest = np.cosh(TILTS)[:, None]
        total = np.cosh(TILTS[:, None, None] * self.w).sum(axis=1) + largest
        return np.asarray(np.log(total / (len(self.w) + 1)))

    def clustered(self, length: int) -> Array:
        """By how much more sums of so many neighbours vary (F,) than if they did not resemble each
        other, dimensionless; at least 1. Of sums of which the reference holds few it is that of as
        long ones as it holds enough of."""
        length = max(min(length, len(self.w) // SUMS_LEAST), 1)
        running = np.cumsum(np.insert(self.w, 0, 0.0, axis=0), axis=0)
        sums = np.mean((running[length:] - running[:-length]) ** 2, axis=0)
        alone = length * np.mean(self.w**2, axis=0)
        return np.asarray(np.maximum(sums / np.where(alone > 0, alone, 1.0), 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """The machine as it was, by ``count`` blocks: sums of ``information`` (F, F) and ``score``
    (F,), of every column its ``scatter`` (F,) φ, whether it shows in enough of them (``known``
    (F,)), and the blocks ``bounded`` in both ways; for one SI unit of every column."""

    count: int
    information: Array
    score: Array
    scatter: Array
    known: NDArray[np.bool_]
    bounded: tuple[Bounded, ...]

    def otherwise(self, block: Block) -> Array:
        """z (F,) of a block, dimensionless; 0 of columns that it does not show."""
        return _scores(self.information, self.score, self.scatter, block)


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """What acts otherwise ``since`` a block (an index): the ``cause`` that explains it best with
    its ``size`` (k,) and ``sd`` (k,), SI, its ``probability`` among the causes that compete, those
    of them that are not ruled out (``rivals``, the likeliest first), and how improbable as much is
    by chance (``chance``)."""

    since: int
    cause: int
    size: Array
    sd: Array
    probability: float
    rivals: tuple[int, ...]
    chance: float


@dataclass(frozen=True, eq=False)  # no slots: what every new block needs is kept
class Causes:
    """What may change: the ``columns`` of each cause (C,), and what naming it costs (``price``
    (C,), in the unit of a score) for numbers that it has beside its strengths."""

    columns: tuple[tuple[int, ...], ...]
    price: Array

    @cached_property
    def alike(self) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], ...]:
        """The causes with as many columns as each other: their indices (K,) and columns (K, k)."""
        sizes = np.array([len(own) for own in self.columns])
        return tuple(
            (which, np.array([self.columns[i] for i in which], np.intp))
            for which in (np.flatnonzero(sizes == size) for size in np.unique(sizes))
        )


def reference_of(blocks: Sequence[Block]) -> Reference:
    """The reference that some blocks are."""
    information = np.sum([one.information for one in blocks], axis=0)
    score = np.sum([one.score for one in blocks], axis=0)
    shown = np.array([np.diag(one.information) for one in blocks])
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = shown.sum(axis=0) ** 2 / np.sum(shown**2, axis=0)
    scatter = _scatter(information, score, blocks)
    z = np.array([_scores(information, score, scatter, one) for one in blocks])
    known = (np.nan_to_num(spread) >= SHOWN_LEAST) & np.any(z != 0, axis=0)
    bounded = []
    for share in EXCEEDED:
        most = np.maximum(np.quantile(np.abs(z), 1 - share, axis=0), 1.0)
        bounded.append(Bounded(most, np.clip(z / most, -1, 1)))
    return Reference(len(blocks), information, score, scatter, known, tuple(bounded))


def level(per_day: float, block_s: float, reference: Reference) -> float:
    """The probability at which one test of one block is an alarm, so that there are ``per_day``
    false ones if blocks last ``block_s``."""
    tests = int(np.count_nonzero(reference.known)) * len(LENGTHS) * len(EXCEEDED)
    return min(per_day * block_s / DAY_S / max(tests, 1), 0.5)


def changed(
    reference: Reference, recent: Sequence[Block], least: float, causes: Causes
) -> Change | None:
    """The change that the ``recent`` blocks (B) show, the last of them included, at a probability
    of ``least`` in each test; None if they show none, or one whose size does not stand out of its
    own deviation."""
    chance = _chance(reference, recent)
    if chance >= least:
        return None
    first = max(len(recent) - LENGTHS[-1], 0)
    worth: list[float] = []
    information, score = np.zeros_like(reference.information), np.zeros_like(reference.score)
    for block in reversed(recent[first:]):  # a beginning after the other, the latest first
        information, score = information + block.information, score + block.score
        worth.append(float(_worth(reference, information, score, causes).max()))
    found = named(reference, recent, first + int(np.argmax(worth[::-1])), chance, causes)
    stands = np.any(np.abs(found.size) > OUTSTANDING * found.sd)
    return found if stands else None


def named(
    reference: Reference, blocks: Sequence[Block], since: int, chance: float, causes: Causes
) -> Change:
    """What has changed since the block of index ``since``, known to differ by a ``chance``."""
    information, score = _summed(blocks[since:])
    worth = _worth(reference, information, score, causes)
    best = int(np.argmax(worth))
    odds = np.exp(0.5 * (worth - worth[best]))
    near = [int(i) for i in np.argsort(-worth) if worth[best] - worth[i] < SIGNIFICANT]
    columns = list(causes.columns[best])
    at = np.ix_(columns, columns)
    after = np.linalg.pinv(information[at], hermitian=True)
    before = np.linalg.pinv(reference.information[at], hermitian=True)
    size = after @ score[columns] - before @ reference.score[columns]
    motion = float(np.mean([one.motion for one in blocks[since:]]))
    variance = np.diag(after + before) * reference.scatter[columns]
    variance = variance + np.diag(after) * ACCURACY**2 * motion * len(blocks[since:])
    return Change(
        since, best, size, np.sqrt(variance), float(1 / odds.sum()), tuple(near[1:]), chance
    )


def _scatter(information: Array, score: Array, blocks: Sequence[Block]) -> Array:
    """φ (F,) of the blocks of a reference against their own sums, dimensionless: the squares of
    their z add up to one less than there are blocks, unless 1 makes them less already."""
    still = [Block(b.start_s, b.end_s, b.information, b.score) for b in blocks]
    ones = np.ones(len(score))
    squares = np.square([_scores(information, score, ones, one) for one in still])
    numerics = np.array([[ACCURACY**2 * one.motion] for one in blocks])
    wanted = max(len(blocks) - 1, 1)
    low, high = ones, np.maximum(squares.sum(axis=0) / wanted, 1.0)
    for _ in range(HALVINGS):
        middle = np.sqrt(low * high)
        above = np.sum(squares / (middle + numerics), axis=0) > wanted
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.asarray(high)


def _scores(information: Array, score: Array, scatter: Array, block: Block) -> Array:
    """z (F,) of a block against sums of a reference."""
    whole, shown = np.diag(information), np.diag(block.information)
    theta = score / np.where(whole > 0, whole, 1.0)
    left = block.score - shown * theta
    variance = np.where(shown > 0, shown, 1.0) * (scatter + ACCURACY**2 * block.motion)
    return np.where(shown > 0, left / np.sqrt(variance), 0.0)


def _chance(reference: Reference, recent: Sequence[Block]) -> float:
    """How improbable what the last blocks say is, by the most improbable column and length."""
    z = np.array([reference.otherwise(one) for one in recent[-LENGTHS[-1] :]])
    found = 0.0
    for one in reference.bounded:
        w, cumulants = np.clip(z / one.most, -1, 1), one.cumulants
        for length in LENGTHS:
            if length > len(w):
                break
            sums = np.abs(w[-length:].sum(axis=0))
            more = one.clustered(length) + length / reference.count
            bound = np.min(length * cumulants - TILTS[:, None] * sums, axis=0) / more
            found = min(found, float(bound[reference.known].min(initial=0.0)))
    return float(min(2 * np.exp(found), 1.0))


def _worth(reference: Reference, information: Array, score: Array, causes: Causes) -> Array:
    """By how much each cause (C,) explains what is otherwise in blocks with the sums of
    ``information`` (F, F) and ``score`` (F,): the fall of χ² in units of what the reference
    scatters by, less its price; −inf of one that it does not show."""
    unit = float(np.median(reference.scatter[reference.known])) if reference.known.any() else 1.0
    worth = np.full(len(causes.columns), -np.inf)
    for which, columns in causes.alike:
        known = reference.known[columns].all(axis=1)
        own, which = columns[known], which[known]
        at = own[:, :, None], own[:, None, :]
        inverse = np.linalg.pinv(reference.information[at], hermitian=True)
        before = np.einsum("cij,cj->ci", inverse, reference.score[own])
        left = score[own] - np.einsum("cij,cj->ci", information[at], before)
        inverse = np.linalg.pinv(information[at], hermitian=True)
        worth[which] = np.einsum("ci,cij,cj->c", left, inverse, left) / unit - causes.price[which]
    return worth


def _summed(blocks: Sequence[Block]) -> tuple[Array, Array]:
    """Information (F, F) and score (F,) of some blocks."""
    return (
        np.sum([one.information for one in blocks], axis=0),
        np.sum([one.score for one in blocks], axis=0),
    )
