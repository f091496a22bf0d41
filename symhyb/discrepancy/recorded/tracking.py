"""Places of a machine with constraints, followed along a recording: a first guess of its motion.

Splines that begin anywhere would close a loop the wrong way round (the other assembly of a
four-bar, a turn more of a crank). So the places are followed from the declared start, sample by
sample: least squares on the sensors of places, on the constraints, and on where the motion before
points to.
Sizes: N samples, n coordinates, m sensors, c rows of constraints.
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import gaps_of, placing, shown_at

ROWS_MOST = 3000
APPROACH = 40  # steps from the declared start to where the recording begins
ROUNDS = 4
HOLD = 1e-3  # of a sensor's weight: how much the motion before counts
SHARE_LEAST = 1e-3  # of what a coordinate moves from sample to sample: its noise at least
SLIP = 10  # samples over which a speed that should be zero may add up to the noise of a place
FIRM = 1e3  # how much more a constraint counts than a sensor


def tracked(machine: Machine, y: Array, u: Array, t: Array, weights: Array) -> Array:
    """Places (N, n) along measurements (N, m) with ``weights`` (m,), one over their noise, under
    inputs (N, k) at t (N,), SI; between the rows that are followed they run linearly."""
    start = np.array(machine.model.start()[0])
    rows = np.unique(np.linspace(0, t.size - 1, min(t.size, ROWS_MOST)).astype(int))
    y = y[rows].copy()
    y[:, np.logical_not(_of_places(machine, start, u[0], float(t[0])))] = np.nan
    first = call(shown_at(machine), (start, u[0], float(t[0]), machine.values))[0][0]
    begin = np.array(
        [column[np.isfinite(column)][0] if np.isfinite(column).any() else np.nan for column in y.T]
    )
    q = start
    for share in np.linspace(0, 1, APPROACH):
        goal = first + share * (begin - first)
        q = _placed(machine, q, goal, u[0], float(t[0]), weights)
    found = np.empty((rows.size, start.size))
    before = q
    for i, row in enumerate(rows):
        ahead = q + (q - before)
        before, q = q, _placed(machine, ahead, y[i], u[row], float(t[row]), weights)
        found[i] = q
    return np.column_stack([np.interp(t, t[rows], column) for column in found.T])


def _of_places(machine: Machine, q: Array, u: Array, t: float) -> NDArray[np.bool_]:
    """Which sensors (m,) show places alone."""
    still, z = np.ones_like(q), np.zeros(machine.inner_states)
    _, by_v, by_a = call(machine.output_slopes, (q, still, still, z, u, t, machine.values))
    return np.asarray(np.abs(by_v).sum(axis=0) + np.abs(by_a).sum(axis=0) == 0)


def _placed(machine: Machine, q: Array, y: Array, u: Array, t: float, weights: Array) -> Array:
    """Places (n,) near q that meet the constraints and the sensors (m,) that are there."""
    function, p = shown_at(machine), machine.values
    seen = np.isfinite(y)
    scale = weights[seen]
    level = float(scale.min()) if seen.any() else 1.0
    firm = FIRM * float(scale.max()) if seen.any() else FIRM
    before, prior = q, HOLD * level * np.eye(q.size)
    for _ in range(ROUNDS):
        shown, by_q, gap, slope = call(function, (q, u, t, p))
        rows = np.concatenate([by_q.T[seen] * scale[:, None], firm * slope.T, prior])
        left = np.concatenate(
            [(y - shown[0])[seen] * scale, -firm * gap[0], HOLD * level * (before - q)]
        )
        if not (np.isfinite(rows).all() and np.isfinite(left).all()):
            return before
        step = np.linalg.lstsq(rows, left, rcond=None)[0]
        q = q + step
        if np.abs(step).max() <= 1e-6 * (1 + np.abs(q).max()):
            break
    return q if np.isfinite(q).all() else before


def firmness(machine: Machine, q: Array, t: Array, noise: Array) -> Array:
    """How much constraints count in the fit of splines, 1/sd (c,), SI, along places (N, n) that
    were followed sample by sample: a spline cannot meet them to the last digit, so they are met
    as closely as the ``noise`` (n,) of these places would move them. What is left is closed
    afterwards."""
    still = np.zeros_like(q)
    slope = gaps_of(machine, q, still, still, t, machine.values).slope
    size = np.sqrt(np.mean(slope**2, axis=0))
    least = SHARE_LEAST * np.std(np.diff(q, axis=0), axis=0)
    level = np.max(size * np.maximum(noise, least), axis=1)
    speeds = np.isin(np.arange(level.size), placing(machine), invert=True)
    level[speeds] /= SLIP * float(np.median(np.diff(t)))
    return np.asarray(1 / np.where(level > 0, level, 1.0))
