"""Sparse regression: PySINDy on the stored candidate matrix, and on what it is reduced to.

100 candidates of four broadband signals over 10⁵ rows: all products up to the fourth degree, dry
friction, quadratic drag and waves. The others get their candidate matrix made before the clock
starts; symhyb evaluates the candidates within it, block by block, every time.
"""

import tracemalloc
from collections.abc import Callable
from itertools import combinations, combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from pysindy.optimizers import STLSQ
from threadpoolctl import threadpool_limits
from timing import Row, in_turns, middle, milliseconds

from symhyb.correction.learning.factor import factor_of
from symhyb.correction.learning.regression import Candidates, regress, resampled

Array = NDArray[np.float64]
TRUE = {"x0": -2.0, "x2": -0.8, "x0x0x0": -1.5, "|x2|x2": -0.6, "tanh x3": -0.4}
NOISE = 0.1


def signals(rows: int, seed: int = 1) -> Array:
    """Four signals (4, rows) of unit size: 40 waves each from 0.1 to 5 Hz, sampled at 1 kHz."""
    rng = np.random.default_rng(seed)
    t = np.arange(rows) * 1e-3
    found = []
    for _ in range(4):
        rate, phase = rng.uniform(0.1, 5, 40), rng.uniform(0, 2 * np.pi, 40)
        size = rng.standard_normal(40)
        one = sum(
            a * np.sin(2 * np.pi * f * t + p) for a, f, p in zip(size, rate, phase, strict=True)
        )
        found.append(one / np.std(one))
    return np.array(found)


def names_of() -> tuple[str, ...]:
    """The 100 candidates, in the order of :func:`filled`."""
    one = range(4)
    powers = ["".join(f"x{i}" for i in w) for w in chosen()]
    drag = [f"|x{i}|x{j}" for i in one for j in one]
    rest = [f"|x{i}|" for i in one] + [f"|x{i}-x{j}|" for i, j in combinations(one, 2)]
    return ("1", *powers, *drag, *rest, *(f"tanh x{i}" for i in one))


def chosen() -> list[tuple[int, ...]]:
    """Which signals the products up to the fourth degree are made of."""
    return [w for d in (1, 2, 3, 4) for w in combinations_with_replacement(range(4), d)]


def filled(x: Array, joined: Array) -> None:
    """Evaluate the candidates of signals (4, rows) into ``joined`` (100 or more, rows)."""
    place = {(): 0}
    joined[0] = 1.0
    for row, which in enumerate(chosen(), 1):
        np.multiply(joined[place[which[:-1]]], x[which[-1]], out=joined[row])
        place[which] = row
    size, row = np.abs(x), len(place)
    joined[row : row + 16] = (size[:, None] * x).reshape(16, -1)
    joined[row + 16 : row + 20] = size
    for k, (i, j) in enumerate(combinations(range(4), 2), row + 20):
        np.abs(x[i] - x[j], out=joined[k])
    joined[row + 26 : row + 30] = np.tanh(x / 0.1)


def candidates_of(rows: int) -> Candidates:
    """The problem, evaluated when asked for."""
    x, names = signals(rows), names_of()
    right = NOISE * np.random.default_rng(2).standard_normal(rows)
    whole = np.empty((len(names), rows))
    filled(x, whole)
    for name, value in TRUE.items():
        right += value * whole[names.index(name)]

    def evaluate(some: slice) -> Array:
        joined = np.empty((len(names) + 1, right[some].size))
        filled(x[:, some], joined)
        joined[-1] = right[some]
        return joined.T

    return Candidates(evaluate, rows, (*names, "right"))


def optimizer() -> STLSQ:
    """STLSQ as it comes, with a threshold below the smallest true coefficient."""
    return STLSQ(threshold=0.2)


def stored(candidates: Candidates) -> tuple[Array, Array]:
    """The candidate matrix (rows, P) and the right-hand side (rows, 1)."""
    whole = candidates.evaluate(slice(0, candidates.rows))
    return np.ascontiguousarray(whole[:, :-1]), np.ascontiguousarray(whole[:, -1:])


def plain(matrix: Array, right: Array) -> Array:
    """Coefficients (1, P) of the plain call."""
    return np.asarray(optimizer().fit(matrix, right).coef_)


def redrawn(matrix: Array, right: Array, chunk: int, weights: Array) -> Array:
    """Coefficients (1, P) of the plain call on chunks that are repeated as often as ``weights``."""
    which = np.repeat(np.arange(weights.size), weights)
    rows = np.concatenate([np.arange(k * chunk, (k + 1) * chunk) for k in which])
    return plain(matrix[rows], right[rows])


def peak(work: Callable[[], object]) -> int:
    """The most bytes that some work had beside what was there before."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def rows(count: int = 100_000, chunk: int = 1000, draws: int = 100, repeats: int = 7) -> list[Row]:
    """Bars of one fit and of many fits drawn anew, everybody's BLAS in one thread."""
    with threadpool_limits(1):
        return _rows(count, chunk, draws, repeats)


def _rows(count: int, chunk: int, draws: int, repeats: int) -> list[Row]:
    candidates = candidates_of(count)
    matrix, right = stored(candidates)
    width, chunks = matrix.shape[1], count // chunk
    anew = np.random.default_rng(0).multinomial(chunks, np.full(chunks, 1 / chunks))
    many = middle(
        in_turns(
            {
                "plain": lambda: plain(matrix, right),
                "ours": lambda: regress(candidates, optimizer()),
                "both": lambda: plain(*stored(candidates)),
                "factor": lambda: factor_of(candidates.blocks(), candidates.names),
            },
            repeats,
        )
    )
    drawn = middle(
        in_turns(
            {
                "plain": lambda: redrawn(matrix, right, chunk, anew),
                "ours": lambda: resampled(candidates, optimizer(), chunk, draws),
            },
            max(repeats // 2, 1),
        )
    )
    theirs, ours = plain(matrix, right), regress(candidates, optimizer())
    apart = float(np.abs(ours - theirs).max() / np.abs(theirs).max())
    share = peak(lambda: regress(candidates, optimizer())) / matrix.nbytes
    once = redrawn(matrix, right, chunk, anew)
    mine = resampled(candidates, optimizer(), chunk, 1)[0]
    off = float(np.abs(mine - once).max() / np.abs(once).max())
    name = f"regression, {count:.0e} × {width}".replace("e+0", "e")
    return [
        Row(
            name,
            "time of PySINDy's STLSQ over ours, each from the signals to the coefficients",
            many["both"] / many["ours"],
            20,
            True,
            "×",
            f"{milliseconds(many['both'])}, {milliseconds(many['ours'])}, of which reduction "
            f"{milliseconds(many['factor'])}; coefficients of the {np.count_nonzero(ours)} terms "
            f"differ by {apart:.0e}",
        ),
        Row(
            name,
            "the same with its candidate matrix there already",
            many["plain"] / many["ours"],
            None,
            True,
            "×",
            milliseconds(many["plain"]),
        ),
        Row(
            name,
            "peak of memory over that of the candidate matrix",
            share,
            0.05,
            False,
            "×",
            f"{matrix.nbytes / 1e6:.0f} MB, tracemalloc",
        ),
        Row(
            name,
            f"{draws} fits of drawn chunks: time of PySINDy's STLSQ, one of them "
            f"{draws} times, over ours",
            draws * drawn["plain"] / drawn["ours"],
            200,
            True,
            "×",
            f"{milliseconds(draws * drawn['plain'])}, {milliseconds(drawn['ours'])}; coefficients "
            f"differ by {off:.0e}",
        ),
    ]
