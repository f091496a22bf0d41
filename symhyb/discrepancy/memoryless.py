"""Whether the missing force is a function of the state at all: of positions, speeds and inputs now.

A flexible force of (q, q', u), on every coordinate that moves freely, is fitted to the linearised
windows and judged on windows that were held out; then laws that remember are added to it. What a
function of the state cannot explain and they can depends on the past of the motion.
Sizes: W windows, L samples a window, N samples, n coordinates, k inputs, B functions.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.hypotheses import Library
from symhyb.discrepancy.locate import explained, hats, knots
from symhyb.discrepancy.results import Memory
from symhyb.discrepancy.windows import Laid, merge, reduce
from symhyb.discrepancy.wording import percent_text
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.buffers import Array
from symhyb.numeric.windows import WindowModel

BUMPS = 120  # Gaussian functions of the state, shared out among the coordinates
KNOTS = 17  # of piecewise linear functions of each position, rate and input
RIDGE = 1e-6  # of a column scaled to unit length
SLIP = 1e-3  # of the largest rate: where a function may jump with its sign
FUNCTION = 0.9  # of the mismatch explained: the missing force is a function of the state
LEAST = 0.01  # of the mismatch, that such a function leaves: less is the error of the smoothing
PART_LEFT = 0.5  # of what such a function leaves: the past explains it


@dataclass(frozen=True, slots=True, eq=False)
class Bumps:
    """Where functions of the state sit: ``mean`` and ``spread`` (2n + k,) in SI; in spreads the
    ``centres`` (B, 2n + k) and the ``width`` of Gaussians and the knots of each part of it."""

    mean: Array
    spread: Array
    centres: Array
    width: float
    corners: tuple[Array, ...]


def memoryless(
    library: Library, model: WindowModel, laid: Sequence[Laid], p: Array, sd: Array
) -> Memory | None:
    """How much of the mismatch a function of the state explains on held windows, without and with
    memory; None where no window is held, or nothing is left but noise.

    ``p`` (P,) and ``sd`` (m,) in SI.
    """
    laid = [item.suited(model.machine) for item in laid]
    bumps = _bumps(
        [_variables(item, model) for item in laid], len(model.machine.free) or model.machine.n
    )
    remembering = [
        column
        for hypothesis, columns in zip(library.hypotheses, library.columns, strict=True)
        if KINDS[hypothesis.kind].state
        for column in columns
    ]
    parts = []
    for item in laid:
        linear = model.along(item.block, item.states, p)
        state = _on_each(_functions(item, model, bumps), model)[item.rows]
        past = library.forces(item.course(library.machine))[item.rows][..., remembering]
        residual = item.block.y - linear.output - linear.from_defect()
        forces = linear.from_forces(np.concatenate([state, past], axis=3))
        parts.append(reduce(residual, linear.from_start(), forces, sd, item.held))
    grams, count, held = merge(parts)
    if not held.any():
        return None
    fitted, unseen = grams[~held].sum(axis=0), grams[held].sum(axis=0)
    floor = float(count[held].sum())
    size = fitted.shape[0] - 1 - len(remembering)
    chosen = [*range(size), fitted.shape[0] - 1]
    alone = explained(unseen[np.ix_(chosen, chosen)], _ridge(fitted[np.ix_(chosen, chosen)]), floor)
    both = explained(unseen, _ridge(fitted), floor)
    if alone is None or both is None:
        return None
    return Memory(alone, max(alone, both), memory_sentence(alone, max(alone, both)))


def memory_sentence(state: float, past: float) -> str:
    """Say whether the missing force is a function of the state, from two explained shares."""
    said = f"explains {percent_text(state)} of the mismatch on windows that were held out"
    if 1 - state > LEAST and past - state > PART_LEFT * (1 - state):
        return (
            f"What is missing remembers: a function of position, speed and input {said}, "
            f"with laws that remember it is {percent_text(past)}."
        )
    if state >= FUNCTION:
        return f"What is missing is a function of position, speed and input: such a force {said}."
    return (
        f"What is missing is no function of position, speed and input alone: such a force {said}, "
        f"with laws that remember {percent_text(past)}."
    )


def _variables(item: Laid, model: WindowModel) -> Array:
    """q, q' and u (N, 2n + k) along a recording, SI."""
    course = item.course(model.machine)
    return np.concatenate([course.q, course.v, course.u], axis=1)


def _bumps(variables: Sequence[Array], coordinates: int) -> Bumps:
    """Where functions of the state sit, from the states (N, 2n + k) of all recordings, SI."""
    joined = np.concatenate(variables)
    mean, spread = joined.mean(axis=0), joined.std(axis=0)
    spread = np.where(spread > 0, spread, 1.0)
    count = min(max(BUMPS // coordinates, 8), len(joined))
    rows = np.random.default_rng(0).choice(len(joined), count, replace=False)
    centres = (joined[rows] - mean) / spread
    apart = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    width = float(np.median(apart[apart > 0])) if np.any(apart > 0) else 1.0
    corners = tuple(knots([column], KNOTS) for column in ((joined - mean) / spread).T)
    return Bumps(mean, spread, centres, width, corners)


def _ridge(gram: Array) -> Array:
    """Coefficients (B,) of a Gram matrix (B + 1, B + 1) whose last column is the residual."""
    size = np.sqrt(np.maximum(np.diag(gram)[:-1], 1e-300))
    unit = gram[:-1, :-1] / np.outer(size, size) + RIDGE * np.eye(size.size)
    return np.asarray(np.linalg.solve(unit, gram[:-1, -1] / size) / size)


def _functions(item: Laid, model: WindowModel, bumps: Bumps) -> Array:
    """Functions of the state (N, B) along a recording: the state itself, piecewise linear functions
    of each part of it, Gaussians, and what jumps with the sign of a rate, alone and times each
    position and its size."""
    mean, spread, centres, width = bumps.mean, bumps.spread, bumps.centres, bumps.width
    raw = _variables(item, model)
    x = (raw - mean) / spread
    near = np.exp(-np.sum((x[:, None] - centres[None]) ** 2, axis=2) / (2 * width**2))
    n = model.machine.n
    q, v = x[:, :n], raw[:, n : 2 * n]
    fastest = np.maximum(np.quantile(np.abs(v), 0.99, axis=0), 1e-300)
    jumps = np.tanh(v / (SLIP * fastest))
    bent = [hats(x[:, i], at) for i, at in enumerate(bumps.corners)]
    return np.concatenate([x, *bent, near, jumps, jumps * q, jumps * np.abs(q)], axis=1)


def _on_each(functions: Array, model: WindowModel) -> Array:
    """The functions (N, B) as forces on every free coordinate, (N, n, n·B); on all where all are
    imposed."""
    n = model.machine.n
    free = list(model.machine.free) or list(range(n))
    forces = np.zeros((len(functions), n, len(free), functions.shape[1]))
    for i, coordinate in enumerate(free):
        forces[:, coordinate, i] = functions
    return forces.reshape(len(functions), n, -1)
