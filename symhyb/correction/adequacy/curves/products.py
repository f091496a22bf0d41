"""What forces do, and what is to be explained, beside the numbers of a structure: their products.

The numbers of the structure are eliminated, each as well known as the model file states it: a
spring that is uncertain by 2 % is none of any size.
Sizes: N samples, n coordinates, F numbers of the structure, G forces.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.correction.adequacy.classes.worth import less_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, tracks_of
from symhyb.correction.search.trajectory import limits_of
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Track, white_forces, white_problem
from symhyb.numeric.kernels.buffers import Array

Products = tuple[Array, float]
"""Products (G + 1, G + 1) of what 1 SI unit of each force does, and, last, of what is left without
them, all in units of the noise; ln L without them, less that with all of the unknown force."""


def products_of(
    recorded: Recorded, trial: Fitted, forces: Sequence[Array], held: Sequence[str] = ()
) -> tuple[Products, ...]:
    """The products of forces (N, n, G), SI, of every stretch around a fitted structure, for every
    size of the unknown force that may be left beside them. Numbers that are ``held``, by path, stay
    as they are."""
    rows = [i for i, path in enumerate(trial.paths) if path not in held]
    columns = [trial.machine.column(trial.paths[i]) for i in rows]
    tracks = tracks_of(recorded, trial, columns)
    limits = limits_of(trial.machine, trial.all_causes, recorded.step_s)
    mean, spread = (row[rows] for row in limits[2:])
    numbers = trial.fit.values[rows]
    known = 1 / spread**2, (numbers - mean) / spread**2
    found = [_products(tracks, noise, forces, *known) for noise in less_of(trial.fit.noise)]
    return tuple((gram, likely - found[0][1]) for gram, likely in found)


def solved(gram: Array, more: float, i: int, size: float) -> tuple[float, float]:
    """What the i-th force of :data:`Products`, whose ``gram`` (G + 1, G + 1) has no unit, is worth
    by itself in ln evidence, and its strength, SI, with a prior deviation of ``size``."""
    seen = 1 + size**2 * gram[i, i]
    toward = -size * gram[i, -1]  # residual + force is left
    return float(0.5 * toward**2 / seen - 0.5 * np.log(seen) + more), float(size * toward / seen)


def _products(
    tracks: Sequence[Track],
    noise: NoiseModel,
    forces: Sequence[Array],
    precision: Array,
    offset: Array,
) -> Products:
    """The products with one noise model, and ln L; ``precision`` (F,) of the numbers, and their
    ``offset`` (F,) from what is stated times it."""
    count = precision.size
    size = count + forces[0].shape[2] + 1
    whole, logs = np.zeros((size, size)), 0.0
    for one, force in zip(tracks, forces, strict=True):
        residual, own, log = white_problem(one, noise)
        joined = np.column_stack([own, white_forces(one, noise, force), residual])
        whole += joined.T @ joined
        logs += log
    block, across = whole[:count, :count] + np.diag(precision), whole[:count, count:].copy()
    across[:, -1] += offset
    unit = np.sqrt(np.diag(block).clip(1e-300))
    taken = np.linalg.pinv(block / np.outer(unit, unit), hermitian=True) / np.outer(unit, unit)
    gram = whole[count:, count:] - across.T @ taken @ across
    return gram, -0.5 * float(logs + gram[-1, -1])
