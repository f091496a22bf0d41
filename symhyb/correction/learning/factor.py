"""Tall least-squares problems reduced to a small triangle, block of rows by block of rows.

A regression of T right-hand sides B on P candidate columns A over N rows asks of the rows only

    [A, B]ᵀ [A, B] = Rᵀ R,        ‖A x − b‖ = ‖R_A x − r_b‖  for every x,

with R upper triangular (F, F), F = P + T. So the candidate matrix is never stored: rows come in
blocks, and R takes the place of all rows seen. There are two ways to R:

- the *triangular factor*: QR of [R; block], block after block (TSQR: Demmel, Grigori, Hoemmen &
  Langou, SIAM J. Sci. Comput. 34, 2012). As accurate as a QR of all rows.
- the *Gram matrix* of centred columns, scaled to unit length, three to five times faster. Its
  rounding, relative to ε, grows with the square of the condition number κ of these columns (Higham,
  Accuracy and Stability of Numerical Algorithms, 2002, §20.4), so it is taken only where κ ≤ 1000:
  then ε κ² ≤ 2e-10. κ comes from the eigenvalues of the Gram matrix itself, right-hand sides
  included (where they are met almost exactly, what is left would be lost). Means are kept beside
  and joined to the root at the end, so offsets of signals do not count in κ.

The Gram matrix is tried first; where κ is larger the rows are asked for again and factored.
Letters: N rows, F columns [A, B], K blocks.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem
from symhyb.numeric.kernels.buffers import Array

CONDITION_MOST = 1e3  # of centred, scaled columns: beyond, the Gram matrix is not good enough
CONSTANT = 1e-12  # of a column's RMS: what varies less is a constant and its rounding
DEPENDENT = 1e-13  # of a column's length: what is left of it beside the columns before it
LOST = 1e-6  # of the length of a direction in all rows: a draw with less has lost it
PANEL = 32  # columns that LAPACK factors at a time

Blocks = Callable[[], Iterable[Array]]


@dataclass(frozen=True, slots=True, eq=False)
class Factor:
    """What least squares needs of N ``rows``: ``triangle`` (F, F), upper triangular unless drawn,
    in the units of the columns; the last ``targets`` columns are right-hand sides. ``names`` (F)
    of all columns; ``by_gram`` says which way it was found."""

    triangle: Array
    rows: int
    names: tuple[str, ...]
    targets: int = 1
    by_gram: bool = False

    @property
    def columns(self) -> Array:
        """R_A (F, P): stands for the candidate columns, in their units."""
        return self.triangle[:, : self.triangle.shape[1] - self.targets]

    @property
    def right(self) -> Array:
        """r_b (F, T): stands for the right-hand sides, in their units. Its last T rows hold what no
        candidate explains, so residuals keep their size."""
        return self.triangle[:, self.triangle.shape[1] - self.targets :]

    def chosen(self, which: NDArray[np.bool_]) -> "Factor":
        """The factor of some of the candidates (P,) and all right-hand sides, units as they are."""
        kept = np.concatenate([which, np.ones(self.targets, bool)])
        names = tuple(name for name, stays in zip(self.names, kept, strict=True) if stays)
        return replace(self, triangle=self.triangle[:, kept], names=names)

    def scaled(self, column: Array, right: Array) -> "Factor":
        """The factor of candidates over ``column`` (P,) and right-hand sides over ``right`` (T,),
        both in the units of the columns: the result is dimensionless."""
        return replace(self, triangle=self.triangle / np.concatenate([column, right]))

    def least_squares(self) -> Array:
        """Coefficients (P, T) of the plain fit, units of B over units of A."""
        length = np.linalg.norm(self.columns, axis=0)
        length = np.where(length > 0, length, 1.0)
        solved = np.linalg.lstsq(self.columns / length, self.right, rcond=None)[0]
        return np.asarray(solved / length[:, None])

    def back_substituted(self) -> Array | None:
        """The same (P, T), units too, many times faster; None where the triangle is not one, or
        candidates depend on each other."""
        from scipy.linalg import solve_triangular

        count = self.columns.shape[1]
        square, length = self.columns[:count], np.linalg.norm(self.columns, axis=0)
        if np.tril(self.columns, -1).any() or self.rows < count or self._lost(length).any():
            return None
        return np.asarray(solve_triangular(square, self.right[:count], check_finite=False))

    def problems(self) -> tuple[Problem, ...]:
        """Why the coefficients are not determined; empty where they are."""
        count = self.triangle.shape[1] - self.targets
        if self.rows < count:
            return (
                Problem(
                    f"{self.rows} rows cannot tell {count} candidates apart; give at least as many "
                    "rows as candidates, or fewer candidates"
                ),
            )
        lost = self._lost(np.linalg.norm(self.columns, axis=0))
        return tuple(self._dependent(int(j)) for j in np.flatnonzero(lost))

    def _lost(self, length: Array) -> NDArray[np.bool_]:
        """Which candidates (P,) of this length are zero, or made of those before them."""
        left = np.abs(np.diagonal(self.columns))
        return np.asarray((length == 0) | (left <= DEPENDENT * length))

    def _dependent(self, j: int) -> Problem:
        """Which columns before it the column j is made of."""
        length = np.linalg.norm(self.columns[:, : j + 1], axis=0)
        name = self.names[j]
        if length[j] == 0:
            return Problem(f"candidate '{name}' is zero in every row; leave it out")
        length = np.where(length > 0, length, 1.0)
        unit = self.columns[:, : j + 1] / length
        share = np.linalg.lstsq(unit[:, :j], unit[:, j], rcond=DEPENDENT)[0]
        parts = [
            f"{share[i] * length[j] / length[i]:.6g} × '{self.names[i]}'"
            for i in np.flatnonzero(np.abs(share) > 1e-6 * np.abs(share).max(initial=0.0))
        ]
        return Problem(
            f"candidate '{name}' is {' + '.join(parts)} in every row; leave one of them out"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """A factored problem that can be put together anew from its blocks.

    ``factor`` of all rows, and the Gram matrix of each block in its basis, ``grams`` (K, F, F)
    dimensionless: with X the rows of a block it is (X R⁻¹)ᵀ(X R⁻¹), so all of them add up to the
    unit matrix, and a sum of drawn ones is well conditioned however alike the columns are. ``rows``
    (K,) counts the rows of each block.
    """

    factor: Factor
    grams: Array
    rows: Array

    def drawn(self, weights: Array) -> Iterator[Factor]:
        """The factor of rows in which block k counts ``weights[d, k]`` times, for each draw d of
        ``weights`` (D, K), dimensionless. Its triangle is only a root, (F, F), where a draw lost a
        column."""
        count = self.grams.shape[1]
        flat = self.grams.reshape(len(self.grams), -1)
        least = DEPENDENT * np.linalg.norm(self.factor.triangle, axis=0)
        for some in np.array_split(weights, max(1, len(weights) // 32)):
            for gram, weight in zip((some @ flat).reshape(-1, count, count), some, strict=True):
                triangle = _root(gram) @ self.factor.triangle
                triangle[:, np.linalg.norm(triangle, axis=0) <= least] = 0.0  # rounding of nothing
                rows = round(float(weight @ self.rows))
                yield replace(self.factor, triangle=triangle, rows=rows)


def factor_of(blocks: Blocks, names: Sequence[str], targets: int = 1) -> Factor:
    """Reduce the rows of a least-squares problem to its factor.

    ``blocks()`` begins anew and yields rows [A, B] (R, F) in any units, the same each time: it
    is called again where the Gram matrix is not good enough. The last ``targets`` columns are
    right-hand sides, ``names`` (F) are those of all columns.

    Raises:
        InputError: a number is not finite, with its column and row.
    """
    total = reduce(_merged, (_moments(*each) for each in _checked(blocks, names)))
    triangle = _from_moments(total)
    if triangle is None:
        every = (block for block, _ in _checked(blocks, names))
        triangle = reduce(_below, every, _nothing(len(names)))
        return Factor(triangle, total.rows, tuple(names), targets)
    return Factor(triangle, total.rows, tuple(names), targets, by_gram=True)


def pieces_of(blocks: Blocks, names: Sequence[str], targets: int = 1) -> Pieces:
    """The same with every block (R, F) of ``blocks``, in any units, kept as K·F² numbers to draw
    from.

    Raises:
        InputError: a number is not finite, or candidates depend on each other, which is named.
    """
    parts = [_moments(*each) for each in _checked(blocks, names)]
    rows, whole = np.array([float(part.rows) for part in parts]), reduce(_merged, parts)
    triangle = _from_moments(whole)
    factor = Factor(_nothing(len(names)), whole.rows, tuple(names), targets)
    if triangle is not None:
        factor = replace(factor, triangle=triangle, by_gram=True)
        _require(factor)
        return Pieces(factor, np.stack([_whitened(part, triangle) for part in parts]), rows)
    del parts
    roots = [_below(_nothing(len(names)), block) for block, _ in _checked(blocks, names)]
    factor = replace(factor, triangle=reduce(_below, roots, factor.triangle))
    _require(factor)
    units = [_over(root, factor.triangle) for root in roots]
    return Pieces(factor, np.stack([unit.T @ unit for unit in units]), rows)


@dataclass(frozen=True, slots=True, eq=False)
class _Moments:
    """Rows, their mean (F,) and the Gram matrix (F, F) about it."""

    rows: int
    mean: Array
    gram: Array


def _moments(block: Array, mean: Array) -> _Moments:
    away = block - mean
    return _Moments(len(block), mean, away.T @ away)


def _merged(one: _Moments, other: _Moments) -> _Moments:
    """Of both together; nothing is subtracted but means (Chan, Golub & LeVeque, The American
    Statistician 37, 1983)."""
    rows, step = one.rows + other.rows, other.mean - one.mean
    between = np.outer(step, step) * (one.rows * other.rows / rows)
    mean = one.mean + step * (other.rows / rows)
    return _Moments(rows, mean, one.gram + other.gram + between)


def _from_moments(total: _Moments) -> Array | None:
    """The triangle (F, F) from means and centred Gram matrix, or None where the columns are too
    much alike for it."""
    size, count = np.sqrt(np.diagonal(total.gram)), total.mean.size
    level = np.sqrt(total.rows) * np.abs(total.mean)
    varied = np.flatnonzero(size > CONSTANT * level)
    unit = total.gram[np.ix_(varied, varied)] / np.outer(size[varied], size[varied])
    power = np.linalg.eigvalsh(unit) if varied.size else np.ones(1)
    if power[0] <= power[-1] / CONDITION_MOST**2:
        return None
    stacked = np.zeros((1 + varied.size, count))
    stacked[0] = np.sqrt(total.rows) * total.mean
    stacked[1:, varied] = np.linalg.cholesky(unit).T * size[varied]
    triangle = _nothing(count)
    joined = np.linalg.qr(stacked, mode="r")
    triangle[: len(joined)] = joined
    return triangle


def _below(triangle: Array, block: Array) -> Array:
    """The triangle (F, F) of [triangle; block]."""
    from scipy.linalg.lapack import dtpqrt

    joined, *_ = dtpqrt(0, min(PANEL, len(triangle)), triangle, block)
    return np.asarray(joined)


def _nothing(count: int) -> Array:
    """The triangle of no rows."""
    return np.zeros((count, count), order="F")


def _whitened(part: _Moments, triangle: Array) -> Array:
    """The Gram matrix of a block in the basis of the triangle; mean and spread apart, for a large
    mean would drown the spread."""
    spread = _over(_over(part.gram, triangle).T, triangle)
    level = _over(np.sqrt(part.rows) * part.mean[None], triangle)
    return spread + level.T @ level


def _over(rows: Array, triangle: Array) -> Array:
    """rows · R⁻¹."""
    from scipy.linalg import solve_triangular

    return np.asarray(solve_triangular(triangle, rows.T, trans="T", check_finite=False).T)


def _root(gram: Array) -> Array:
    """C with CᵀC = gram (F, F), upper triangular unless a draw lost a direction: its rounding
    would else be taken for one."""
    try:
        root = np.linalg.cholesky(gram).T
        if np.diagonal(root).min() > LOST:
            return np.asarray(root)
    except np.linalg.LinAlgError:
        pass
    power, axes = np.linalg.eigh(gram)
    return np.asarray(np.sqrt(np.where(power > LOST**2, power, 0.0))[:, None] * axes.T)


def _require(factor: Factor) -> None:
    problems = factor.problems()
    if problems:
        raise InputError(problems)


def _checked(blocks: Blocks, names: Sequence[str]) -> Iterator[tuple[Array, Array]]:
    """The blocks, none of them empty, and the mean (F,) of each; refused where a number is not
    finite, which the mean shows."""
    first = 0
    for block in blocks():
        if not len(block):
            continue
        with np.errstate(invalid="ignore", over="ignore"):
            mean = np.full(len(block), 1 / len(block)) @ block
        if not np.isfinite(mean).all() and not np.isfinite(block).all():
            row, column = np.argwhere(~np.isfinite(block))[0]
            raise InputError(
                Problem(
                    f"'{names[column]}' is {block[row, column]:g} in row {first + row}; "
                    "leave out rows that are not finite"
                )
            )
        yield block, mean
        first += len(block)
    if not first:
        raise InputError(Problem("there are no rows; give at least as many as candidates"))
