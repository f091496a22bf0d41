"""Two joints that share a loss: the place that is the sum or the difference of their rates.

The motor of a wrist often turns at the sum of two joints' rates, since its drive runs through the
one before; belts and differentials do the same. A file of links and joints does not say so. At the
level of forces that is seen where causes on single joints leave most: friction and damping of the
sum act on both joints alike.
Sizes: W windows, R rows of a window, L samples, f free coordinates, P pairs with a sign.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from symhyb.correction.search.force_screen import ForceScreen, modulated, weak_rows
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.selection import Subset
from symhyb.discrepancy.places.hypotheses import Library
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.judgement import LARGE, MOST
from symhyb.model.types import On
from symhyb.numeric.kernels.buffers import Array

Pair = tuple[int, int, float]  # two rows among free coordinates, and the sign of the second


def coupled_places(
    prepared: Prepared,
    library: Library,
    cuts: Sequence[Cut],
    band_hz: float,
    forces: ForceScreen,
    whole: Subset,
) -> tuple[On, ...]:
    """The sums and differences of two coordinates of one unit at which damping and dry friction
    take most [``MOST``] of the squares that a ``whole`` leaves on both; one of the two must keep a
    large part [``LARGE``] of what it lacks. No coordinate twice."""
    model, free = prepared.machine.model, prepared.machine.free
    left, all_of_it = forces.left(whole), np.diagonal(forces.total, axis1=1, axis2=2)[:, -1]
    poor = left > LARGE**2 * all_of_it
    units = [model.coordinates[i].unit for i in free]
    pairs: list[Pair] = [
        (i, j, sign)
        for i, j in combinations(range(len(free)), 2)
        if (poor[i] or poor[j]) and units[i] == units[j]
        for sign in (1.0, -1.0)
    ]
    if not pairs:
        return ()
    columns = [c for cause in whole.causes for c in forces.columns[cause]]
    gram = _gram(prepared, library, cuts, band_hz, columns, pairs)
    taken = _taken(gram, len(columns), pairs, np.where(left > 0, 1 / left, 0.0))
    found: list[On] = []
    used: set[int] = set()
    for share, (i, j, sign) in sorted(zip(taken, pairs, strict=True), reverse=True):
        if share > MOST and used.isdisjoint((i, j)):
            used |= {i, j}
            first, second = (model.coordinates[free[k]].name for k in (i, j))
            found.append(On(f"{first} {'+' if sign > 0 else '-'} {second}"))
    return tuple(found)


def _gram(
    prepared: Prepared,
    library: Library,
    cuts: Sequence[Cut],
    band_hz: float,
    columns: Sequence[int],
    pairs: Sequence[Pair],
) -> Array:
    """Gram matrices (f, C + 2P + 1, …) of the ``columns`` of a whole, of damping and friction of
    every pair, and of what is lacking, last; N·s or N·m·s a row."""
    free = list(prepared.machine.free)
    size = len(columns) + 2 * len(pairs) + 1
    gram = np.zeros((len(free), size, size))
    for item in cuts:
        test, _ = modulated(item.block.t, band_hz)
        rates = item.course(prepared.machine).v[item.rows][..., free]
        first = 0
        for held, rows in weak_rows(prepared.machine, library, item, band_hz):
            some = slice(first, first + held.size)
            first += held.size
            joint = np.zeros((*rows.shape[:3], 2 * len(pairs)))
            for k, (i, j, sign) in enumerate(pairs):
                rate = rates[some, :, i] + sign * rates[some, :, j]
                lost = -np.stack([rate, np.sign(rate)], axis=2)
                acting = test[some] @ lost
                joint[:, :, i, 2 * k : 2 * k + 2] = acting
                joint[:, :, j, 2 * k : 2 * k + 2] = sign * acting
            mine = np.concatenate([rows[..., list(columns)], joint, rows[..., -1:]], axis=3)
            each = mine.transpose(2, 0, 1, 3).reshape(len(free), -1, size)
            gram += each.transpose(0, 2, 1) @ each
    return gram


def _taken(gram: Array, known: int, pairs: Sequence[Pair], weights: Array) -> list[float]:
    """Which part of the squares that the ``known`` columns leave on its two coordinates the losses
    of each pair take beside them; 0 where one of them would drive the machine."""
    whole = np.tensordot(weights, gram, 1)
    before = _left(whole, range(known))[0]
    found = []
    for k, (i, j, _) in enumerate(pairs):
        chosen = [*range(known), known + 2 * k, known + 2 * k + 1]
        after, values = _left(whole, chosen)
        alone = (weights[i] > 0) + (weights[j] > 0)  # the whole leaves 1 on every coordinate
        found.append(float((before - after) / alone) if np.all(values[-2:] >= 0) else 0.0)
    return found


def _left(gram: Array, chosen: Sequence[int]) -> tuple[float, Array]:
    """What least squares in the ``chosen`` columns leave, and their coefficients."""
    block, right = gram[np.ix_(chosen, chosen)], gram[chosen, -1]
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
    solved = np.linalg.lstsq(block / np.outer(scale, scale), right / scale, rcond=None)[0] / scale
    return float(gram[-1, -1] - right @ solved), solved
