"""Which terms of a weak form are chosen: PySINDy proposes sets of terms, held windows choose.

Each row is regressed by itself. An optimiser gives a set of terms for every threshold; each set is
fitted by least squares to all windows but a fifth and tested on these, five times, so that every
window is held once. Chosen is the smallest set whose error on held windows is not larger than that
of the best one by more than one standard error of the difference, taken over windows (cross-
validation with the one-standard-error rule: Breiman et al., Classification and Regression Trees,
1984; for sparse dynamics, information criteria do the same: Mangan et al., Proc. R. Soc. A 473,
2017).
Sizes: N rows, T terms, W windows.
"""

from collections.abc import Sequence
from itertools import combinations, product

import numpy as np

from symhyb.correction.learning.factor import factor_of
from symhyb.correction.learning.sparse import OptimizerName, supports
from symhyb.correction.learning.weak import WeakForm
from symhyb.errors import InputError
from symhyb.judgement import MARGIN
from symhyb.numeric.kernels.buffers import Array

UNSEEN = 1e-9  # of the largest column: a term that is no larger is not seen
FOLDS = 5
GONE_MOST = 3  # terms that one other may stand for
RIVALS = 8  # sets that are simulated beside the chosen one


def choose_terms(
    form: WeakForm, row: int, allowed: Sequence[int], optimizer: OptimizerName
) -> tuple[int, ...]:
    """The terms, of those ``allowed``, that are chosen for a row of the weak form.

    Raises:
        InputError: terms that depend on each other, or fewer rows than terms.
    """
    columns, right = form.columns[:, list(allowed)], form.right[:, row]
    length, size = np.linalg.norm(columns, axis=0), np.linalg.norm(right)
    seen = np.flatnonzero(length > UNSEEN * length.max(initial=0.0)).tolist()
    if size == 0 or not seen:
        return ()
    unit = np.column_stack([columns[:, seen] / length[seen], right / size])
    names = (*(form.texts[allowed[i]] for i in seen), "what is lacking")
    factor = factor_of(lambda: iter([unit]), names)
    problems = factor.problems()
    if problems:
        raise InputError(problems)
    sets = supports(factor, optimizer)
    losses = np.array([_held_losses(unit, form, kept) for kept in sets])
    return tuple(allowed[seen[i]] for i in _smallest(sets, losses))


def exchanges(
    form: WeakForm, row: int, allowed: Sequence[int], kept: Sequence[int]
) -> tuple[tuple[int, ...], ...]:
    """The sets with one to three of the terms ``kept`` exchanged for a single other one whose
    error on held windows is not larger by more than one standard error, the smaller and the better
    ones first."""
    columns = form.columns[:, list(allowed)]
    seen = np.linalg.norm(columns, axis=0) > 0
    length = np.where(seen, np.linalg.norm(columns, axis=0), 1.0)
    unit = np.column_stack([columns / length, form.right[:, row]])
    at = [allowed.index(i) for i in kept]
    own = _held_losses(unit, form, at)
    found = []
    others = [i for i in np.flatnonzero(seen).tolist() if i not in at]
    gone = [part for size in range(1, GONE_MOST + 1) for part in combinations(at, size)]
    for part, new in product(gone, others):
        trial = tuple(sorted([*(i for i in at if i not in part), new]))
        apart = _held_losses(unit, form, trial) - own
        if apart.mean() <= np.std(apart, ddof=1) / np.sqrt(apart.size):
            found.append((len(trial), float(apart.mean()), tuple(allowed[i] for i in trial)))
    return tuple(trial for _, _, trial in sorted(found)[:RIVALS])


def _held_losses(unit: Array, form: WeakForm, kept: Sequence[int]) -> Array:
    """Squared error (W,) of every window, dimensionless, with terms fitted to other windows."""
    fold = form.window % FOLDS
    columns, right = unit[:, list(kept)], unit[:, -1]
    left = right.copy()
    for k in range(FOLDS) if kept else ():
        others, held = fold != k, fold == k
        values = np.linalg.lstsq(columns[others], right[others], rcond=None)[0]
        left[held] -= columns[held] @ values
    return np.bincount(form.window, left**2).astype(np.float64)


def _smallest(sets: Sequence[tuple[int, ...]], losses: Array) -> tuple[int, ...]:
    """The smallest set that is as good as the best; ``losses`` (sets, W), dimensionless."""
    best = int(np.argmin(losses.mean(axis=1)))
    for kept, own in zip(sets, losses, strict=True):
        apart = own - losses[best]
        error = float(np.std(apart, ddof=1) / np.sqrt(apart.size)) if apart.size > 1 else 0.0
        if float(apart.mean()) <= (1 if kept else MARGIN) * error:
            return kept
    return sets[best]


def coefficients_of(form: WeakForm, row: int, terms: Sequence[int]) -> tuple[Array, Array]:
    """Coefficients (T,) of chosen terms, SI, from all windows by least squares, and one standard
    deviation of each, from what windows differ by (clustered by window: Liang & Zeger, Biometrika
    73, 1986)."""
    if not terms:
        return np.zeros(0), np.zeros(0)
    columns, right = form.columns[:, list(terms)], form.right[:, row]
    length = np.linalg.norm(columns, axis=0)
    unit = columns / length
    inverse = np.linalg.pinv(unit.T @ unit)
    values = inverse @ unit.T @ right
    left = (right - unit @ values)[:, None] * unit
    sums = np.stack([np.bincount(form.window, part) for part in left.T])
    spread = np.sqrt(np.diag(inverse @ sums @ sums.T @ inverse))
    return values / length, spread / length
