"""Whether the missing force is a function of the state at all: of positions, speeds and inputs now.

A flexible force of (q, q', u), on every coordinate that moves freely, and the laws of the
vocabulary that are such functions are fitted to the linearised windows and judged on windows that
were held out; then laws that remember are added. What a function of the state cannot explain and
they can depends on the past of the motion.
Sizes: W windows, L samples a window, N samples, n coordinates, k inputs, B functions.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.places.hypotheses import Library
from symhyb.discrepancy.places.locate import explained, hats, knots, surface
from symhyb.discrepancy.recorded.windows import Cut, Reduced, reduce
from symhyb.discrepancy.results import Memory
from symhyb.discrepancy.words.wording import percent_text
from symhyb.judgement import MOST, NEGLIGIBLE, SMALL
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

BUMPS = 120  # Gaussian functions of the state, shared out among the coordinates
CUBIC_MOST = 5  # parts of the state, of which cubic products are made
KNOTS = 17  # of piecewise linear functions of each position, rate and input
RIDGES = (1e-8, 1e-6, 1e-4, 1e-2, 1.0, 100.0)  # of a column scaled to unit length: one half chooses
CHOSEN = (1, 2, 4, 8, 16, 32)  # functions that are chosen one by one
FUNCTIONS_MOST = 300  # over all coordinates
CHUNK = 15  # windows at once; every third is held
SLIP = 1e-3  # of the largest rate: where a function may jump with its sign


@dataclass(frozen=True, slots=True, eq=False)
class Bumps:
    """Where functions of the state sit: ``mean`` and ``spread`` (2n + k,) in SI, and the
    ``fastest`` rates (n,), SI; in spreads the ``centres`` (B, 2n + k) and the ``width`` of
    Gaussians and the knots of each part of it."""

    mean: Array
    spread: Array
    fastest: Array
    centres: Array
    width: float
    corners: tuple[Array, ...]


def memoryless(
    library: Library, model: WindowModel, cuts: Sequence[Cut], p: Array, sd: Array
) -> Memory | None:
    """How much of the mismatch a function of the state explains on held windows, without and with
    memory; None where no window is held, or nothing is left but noise.

    ``p`` (P,) and ``sd`` (m,) in SI.
    """
    cuts = [item.suited(model.machine) for item in cuts]
    coordinates = len(model.machine.free) or model.machine.n
    bumps = _bumps([_variables(item, model) for item in cuts], coordinates, model.machine.n)
    remembering = _columns(library, [k.name for k in KINDS.values() if k.states])
    known = _columns(library, [k.name for k in KINDS.values() if not k.states and k.of_state])
    sums = _Sums()
    for item in cuts:
        variables, laws = _variables(item, model), library.forces(item.course(library.machine))
        for first in range(0, len(item.start), CHUNK):  # a Gram matrix a window: not all at once
            part = item.chosen(np.arange(first, min(first + CHUNK, len(item.start))))
            rows = part.rows.reshape(-1)
            state = _functions(variables[rows], model, bumps)[:, : FUNCTIONS_MOST // coordinates]
            listed = laws[rows][:, :, [*known, *remembering]]
            forces = np.concatenate([_on_each(state, model), listed], axis=2)
            linear = model.along(part.block, part.states, p)
            residual = part.block.y - linear.output - linear.from_defect()
            columns = linear.from_forces(forces.reshape(*part.rows.shape, *forces.shape[1:]))
            sums.add(reduce(part, residual, linear.from_start(), columns, sd))
    total = np.arange(sums.held.shape[0])
    own = np.delete(total, np.arange(total.size - 1 - len(remembering), total.size - 1))
    alone, both = (sums.explained(which) for which in (own, total))
    if alone is None or both is None:
        return None
    return Memory(alone, max(alone, both), memory_sentence(alone, max(alone, both)))


def _columns(library: Library, kinds: Sequence[str]) -> list[int]:
    """The columns of all laws of these kinds."""
    return [
        column
        for hypothesis, columns in zip(library.hypotheses, library.columns, strict=True)
        if hypothesis.kind in kinds
        for column in columns
    ]


class _Sums:
    """Gram matrices (B + 1, B + 1) summed over two halves of the fitted windows, in turn, and over
    the held ones, and the ``count`` of samples of the held ones."""

    def __init__(self) -> None:
        self.halves = [np.zeros((1, 1)), np.zeros((1, 1))]
        self.held, self.count = np.zeros((1, 1)), 0.0

    def add(self, part: Reduced) -> None:
        fitted = part.grams[~part.held]
        for i in (0, 1):
            self.halves[i] = self.halves[i] + fitted[i::2].sum(axis=0)
        self.held = self.held + part.grams[part.held].sum(axis=0)
        self.count += float(part.count[part.held].sum())

    def explained(self, which: NDArray[np.int64]) -> float | None:
        """The share of the held windows that the columns ``which`` explain, the residual being the
        last; one half of the fitted windows says how much the other is to be smoothed."""
        if not all(np.isfinite(gram).all() for gram in (*self.halves, self.held)):
            return None
        first, second = (half[np.ix_(which, which)] for half in self.halves)
        errors = [
            _left(second, one) + _left(first, other)
            for one, other in zip(_fits(first), _fits(second), strict=True)
        ]
        values = _fits(first + second)[int(np.argmin(errors))]
        return explained(self.held[np.ix_(which, which)], values, self.count)


def _fits(gram: Array) -> list[Array]:
    """Coefficients (B,) of a Gram matrix (B + 1, B + 1) whose last column is the residual: all
    functions smoothed by a ridge, and the few that greedily take most."""
    alive = np.diag(gram)[:-1] > 0  # a function that is zero all along has no coefficient
    size = np.sqrt(np.where(alive, np.diag(gram)[:-1], 1.0))
    unit = gram[:-1, :-1] / np.outer(size, size) + np.diag(~alive)
    right = gram[:-1, -1] / size
    each = np.eye(size.size)
    fits = [np.linalg.solve(unit + share * each, right) / size for share in RIDGES]
    chosen: list[int] = []
    values = np.zeros(size.size)
    for count in range(1, min(CHOSEN[-1], size.size) + 1):
        promise = np.abs(right - unit @ values)
        promise[chosen] = -1.0  # none twice
        chosen.append(int(np.argmax(promise)))
        block = np.ix_(chosen, chosen)
        values = np.zeros(size.size)
        values[chosen] = np.linalg.solve(unit[block] + RIDGES[0] * each[block], right[chosen])
        if count in CHOSEN:
            fits.append(values / size)
    return fits


def _left(gram: Array, values: Array) -> float:
    mix = np.append(-values, 1.0)
    return float(mix @ gram @ mix)


def memory_sentence(state: float, past: float) -> str:
    """Say whether the missing force is a function of the state, from two explained shares."""
    said = f"explains {percent_text(state)} of the mismatch on windows that were held out"
    if 1 - state > NEGLIGIBLE and past - state > MOST * (1 - state):
        return (
            f"What is missing remembers: a function of position, speed and input {said}, "
            f"with laws that remember it is {percent_text(past)}."
        )
    if state >= 1 - SMALL:
        return f"What is missing is a function of position, speed and input: such a force {said}."
    return (
        f"A function of position, speed and input {said}, with laws that remember "
        f"{percent_text(past)}: what is missing depends on something else too, or so sharply that "
        "these recordings cannot tell."
    )


def _variables(item: Cut, model: WindowModel) -> Array:
    """q, q' and u (N, 2n + k) along a recording, SI."""
    course = item.course(model.machine)
    return np.concatenate([course.q, course.v, course.u], axis=1)


def _bumps(variables: Sequence[Array], coordinates: int, n: int) -> Bumps:
    """Where functions of the state sit, from the states (N, 2n + k) of all recordings, SI, the
    first 2n of which are places and rates."""
    joined = np.concatenate(variables)
    mean, spread = joined.mean(axis=0), joined.std(axis=0)
    spread = np.where(spread > 0, spread, 1.0)
    count = min(max(BUMPS // coordinates, 8), len(joined))
    rows = np.random.default_rng(0).choice(len(joined), count, replace=False)
    centres = (joined[rows] - mean) / spread
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    width = float(np.median(apart[apart > 0])) if np.any(apart > 0) else 1.0
    corners = tuple(knots([column], KNOTS) for column in ((joined - mean) / spread).T)
    fastest = np.quantile(np.abs(joined[:, n : 2 * n]), 0.99, axis=0)
    return Bumps(mean, spread, np.maximum(fastest, 1e-300), centres, width, corners)


def _functions(raw: Array, model: WindowModel, bumps: Bumps) -> Array:
    """Functions (N, B) of states (N, 2n + k), SI: products of its parts, piecewise linear functions
    of each part, surfaces over each position and its rate, Gaussians, and what jumps with the sign
    of a rate, alone and times each position and its size."""
    centres, width = bumps.centres, bumps.width
    x = (raw - bumps.mean) / bumps.spread
    near = np.exp(-np.sum((x[:, None] - centres[None]) ** 2, axis=2) / (2 * width**2))
    n = model.machine.n
    q, v = x[:, :n], raw[:, n : 2 * n]
    jumps = np.tanh(v / (SLIP * bumps.fastest))
    bent = [hats(x[:, i], at) for i, at in enumerate(bumps.corners)]
    own = [
        surface(x[:, i], x[:, n + i], [bumps.corners[i][::4], bumps.corners[n + i][::2]])
        for i in range(n)
    ]
    return np.concatenate(
        [x, jumps, jumps * q, jumps * np.abs(q), *_powers(x), *own, *bent, near], axis=1
    )


def _powers(x: Array) -> list[Array]:
    """Products of two parts of the state (N, V), and of three where those are few, (N, …) each."""
    parts = range(x.shape[1])
    degrees = (2, 3) if x.shape[1] <= CUBIC_MOST else (2,)
    return [
        np.stack(
            [np.prod(x[:, list(i)], axis=1) for i in combinations_with_replacement(parts, d)], 1
        )
        for d in degrees
    ]


def _on_each(functions: Array, model: WindowModel) -> Array:
    """The functions (N, B) as forces on every free coordinate, (N, n, n·B); on all where all are
    imposed."""
    n = model.machine.n
    free = list(model.machine.free) or list(range(n))
    forces = np.zeros((len(functions), n, len(free), functions.shape[1]))
    for i, coordinate in enumerate(free):
        forces[:, coordinate, i] = functions
    return forces.reshape(len(functions), n, -1)
