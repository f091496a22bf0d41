"""Sparse regression on candidates that are never stored: PySINDy's optimisers on a factor.

An optimiser that asks of the rows [A, B] only squares and products (least squares, ridge,
thresholds on coefficients, what is left) finds in the triangle R of
:mod:`symhyb.correction.learning.factor` all that it would find in the rows: AᵀA, AᵀB and BᵀB are
the same, so every regression on a part of the columns, every threshold and residual is. STLSQ,
SR3, SSR and FROLS are of this kind.
What picks rows (trimming, bagging) is not, and is refused; rows are drawn here instead, chunk by
chunk, as fits a series in time (block bootstrap: Künsch, Annals of Statistics 17, 1989).

    from pysindy.optimizers import STLSQ

    def columns(rows):                       # [x, x', |x'| x', x³, x''] in SI
        x, v, a = q[rows], rate[rows], force[rows] / mass
        return np.stack([x, v, abs(v) * v, x**3, a]).T

    candidates = Candidates(columns, q.size, ("x", "x'", "|x'|x'", "x^3", "a"))
    (coefficients,) = regress(candidates, STLSQ(threshold=0.1))
    spread = resampled(candidates, STLSQ(threshold=0.1), chunk=2000, draws=100).std(axis=0)

Letters: N rows, P candidates, T right-hand sides, D draws.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from symhyb.correction.learning.factor import Blocks, Factor, factor_of, pieces_of
from symhyb.errors import InputError, Problem
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.threads import one_thread

BLOCK = 2**17  # numbers evaluated at a time: a megabyte stays in the cache


class Optimizer(Protocol):
    """What is asked of an optimiser of PySINDy: coefficients ``coef_`` (T, P) in units of the
    right-hand side over those of the candidate, and where they begin."""

    coef_: Array
    initial_guess: Array | None
    normalize_columns: bool

    def fit(self, x_: Array, y: Array) -> object:
        """Fit right-hand sides ``y`` (N, T) by columns ``x_`` (N, P), in any units."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Candidate columns and right-hand sides that are evaluated when they are asked for.

    ``evaluate`` gives [A, B] (rows of the slice, P + T) for a slice of the N ``rows``, in any
    units, always the same; ``names`` (P + T) are those of the candidates and, last, of the
    ``targets`` right-hand sides.
    """

    evaluate: Callable[[slice], Array]
    rows: int
    names: tuple[str, ...]
    targets: int = 1

    def blocks(self, rows: int = 0) -> Blocks:
        """All of them in blocks (rows, P + T) of so many rows, any units; 0: as suits the cache."""
        size = rows or max(BLOCK // len(self.names), 1)

        def begun() -> Iterator[Array]:
            for first in range(0, self.rows, size):
                yield self.evaluate(slice(first, min(first + size, self.rows)))

        return begun


def regress(candidates: Candidates, optimizer: Optimizer) -> Array:
    """Coefficients (T, P) that ``optimizer`` finds, in units of the right-hand side over those of
    the candidate; the same as ``optimizer.fit(A, B).coef_`` with all rows stored.

    One pass over the rows, a second where the candidates are much alike (κ > 1000). Memory: one
    block of rows and a few matrices of P + T columns.

    Raises:
        InputError: a number is not finite, there are fewer rows than candidates, candidates depend
            on each other (which), or an optimiser that picks rows.
    """
    _require_squares(optimizer)
    with one_thread():
        factor = factor_of(candidates.blocks(), candidates.names, candidates.targets)
        problems = factor.problems()
        if problems:
            raise InputError(problems)
        return fitted(factor, optimizer)


def resampled(
    candidates: Candidates, optimizer: Optimizer, chunk: int, draws: int, seed: int = 0
) -> Array:
    """Coefficients (D, T, P), units as in :func:`regress`, of ``draws`` fits, each of as many
    chunks as there are, drawn with replacement.

    A ``chunk`` is so many rows in a row: more than the time over which residuals are correlated,
    and few enough for some dozens of chunks. The rows are evaluated once (twice where κ > 1000),
    whatever the number of draws. Memory: (P + T)² numbers a chunk.

    Raises:
        InputError: as :func:`regress`, or fewer than two chunks.
    """
    _require_squares(optimizer)
    if not 0 < chunk <= candidates.rows // 2:
        raise InputError(
            Problem(
                f"chunks of {chunk} rows: {candidates.rows} rows do not hold two of them; give "
                f"between 1 and {candidates.rows // 2}"
            )
        )
    with one_thread():
        pieces = pieces_of(candidates.blocks(chunk), candidates.names, candidates.targets)
        count = pieces.rows.size
        shares = np.full(count, 1 / count)
        weights = np.random.default_rng(seed).multinomial(count, shares, size=draws).astype(float)
        return np.stack([fitted(factor, optimizer) for factor in pieces.drawn(weights)])


def fitted(factor: Factor, optimizer: Optimizer) -> Array:
    """Coefficients (T, P) of ``optimizer`` on a factor, in units of the right-hand side over those
    of the candidate."""
    from sklearn import config_context

    # an optimiser begins with least squares, which from a triangle is a matter of back substitution
    guess = None
    if optimizer.initial_guess is None and not optimizer.normalize_columns:
        guess = factor.back_substituted()
    optimizer.initial_guess = optimizer.initial_guess if guess is None else guess.T
    try:
        # what it is built on checks every array and parameter anew, longer than it computes
        with config_context(assume_finite=True, skip_parameter_validation=True):
            optimizer.fit(factor.columns, factor.right)
    finally:
        optimizer.initial_guess = optimizer.initial_guess if guess is None else None
    return np.array(optimizer.coef_, ndmin=2)


def _require_squares(optimizer: Optimizer) -> None:
    """A factor has no rows to pick from."""
    for sign in ("use_trimming", "bagging"):
        if getattr(optimizer, sign, False):
            raise InputError(
                Problem(
                    f"{type(optimizer).__name__} picks rows ({sign}), which a reduced problem has "
                    "not; draw chunks with 'resampled' instead"
                )
            )
