"""The linear problem of a curve once more, along the motion of a structure that has one.

The first time a force without a name is seen along the smoothed motion, whose rates are off where
the force is steep. The structure with a curve has a better motion. What acts there is the curve
that it has, and what is left: both together are what a new one explains.
Sizes: N samples, n coordinates, G forces.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.classes.columns import Motions
from symhyb.correction.adequacy.curves.products import Products, products_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.trajectory import paths_of
from symhyb.discrepancy.places.hypotheses import CurvePoint, Hypothesis
from symhyb.laws.characteristic import Characteristic, through
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import state_form


class Instead(NamedTuple):
    """A product that a structure has, ``cause``, and stretch and rate (N, places) and directions
    (N, n, places) as the structure moves (``motions``), SI."""

    cause: Hypothesis
    motions: Motions


def motions_along(recorded: Recorded, trial: Fitted) -> Motions:
    """Stretch and rate (N, places) and directions (N, n, places) along every stretch, SI, as a
    fitted structure moves."""
    machine, found = recorded.library.machine, []
    free = list(state_form(machine).free)
    for item, states in zip(recorded.items, trial.fit.states, strict=True):
        rows = item.rows[0]
        whole = item.course(machine)
        part = whole.at(rows)
        q, v = part.q.copy(), part.v.copy()
        q[:, free], v[:, free] = states[:, : len(free)], states[:, len(free) : 2 * len(free)]
        stretch, rate = recorded.library.motion(replace(part, q=q, v=v))
        found.append((stretch, rate, recorded.library.directions(whole)[rows]))
    return tuple(found)


def curve_through(points: Sequence[CurvePoint]) -> Characteristic:
    """The curve through the points of a cause, SI."""
    x, y, _ = zip(*points, strict=True)
    return through("curve", x, y)


def force_of(cause: Hypothesis, s: Array, r: Array) -> Array:
    """The force (N,), SI, of a product as it is stated, at stretch and rate (N,)."""
    return curve_through(cause.points)(r) * curve_through(cause.by_stretch)(s)


def products_instead(
    recorded: Recorded,
    trial: Fitted,
    forces: Sequence[Array],
    old: Sequence[Array],
    cause: Hypothesis,
) -> tuple[Products, ...]:
    """The products of forces (N, n, G), SI, of every stretch in place of a ``cause`` of a fitted
    structure, which pushes with the ``old`` ones (N, n, 1): what is to be explained is what is left
    without it."""
    both = [np.concatenate(pair, axis=2) for pair in zip(forces, old, strict=True)]
    held = paths_of(trial.all_causes.index(cause), cause)
    return without_last(products_of(recorded, trial, both, held))


def without_last(products: Sequence[Products]) -> tuple[Products, ...]:
    """The products (G + 2, G + 2) of forces, the last of which the structure has, as those (G + 1,
    G + 1) of the others, in units of the noise: what is to be explained is
    what is left without it."""
    found = []
    for gram, likely in products:
        count = gram.shape[0] - 2
        turn = np.zeros((count + 2, count + 1))
        turn[:count, :count] = np.eye(count)
        turn[count, count], turn[count + 1, count] = -1.0, 1.0
        new = turn.T @ gram @ turn
        found.append((new, likely + 0.5 * float(gram[-1, -1] - new[-1, -1])))
    return tuple((gram, likely - found[0][1]) for gram, likely in found)
