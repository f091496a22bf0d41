"""The covariance of the Kalman filter (:mod:`~.filter`): how it begins, what a measurement takes
from it, and how it moves on, compiled once for all machines.

Rows of matrices end in zeros, so that they fill whole vector registers.
Sizes: X states, n forces, m sensors, d = X + n + c with c coloured sensors.
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.jit import jitted

LANES = 4  # of a vector register


@jitted
def padded(d: int) -> int:  # pragma: no cover - compiled
    """How long a row of ``d`` numbers is."""
    return -(-d // LANES) * LANES


@jitted
def transition(
    F: Array,
    share: Array,
    phi: Array,
    left: Array,
    right: Array,
    keep: Array,
    hold: Array,
    i: int,
) -> None:  # pragma: no cover - compiled
    """Write the transition of the i-th step, SI: ``F`` (X, d), the next states by states and
    forces, and what ``share`` (d,) of itself each force and colour is then."""
    _, states, forces = left.shape
    for s in range(states):
        for t in range(states):
            F[s, t] = phi[i, s, t]
        for t in range(forces):
            F[s, states + t] = left[i, s, t] + keep[i, t] * right[i, s, t]
    for t in range(forces):
        share[states + t] = keep[i, t]
    for t in range(hold.shape[1]):
        share[states + forces + t] = hold[i, t]


@jitted
def start(P0: Array, force: Array, colour: Array, coloured: bool) -> Array:  # pragma: no cover
    """The covariance (d, d) at the first sample, SI."""
    states, forces, sensors = P0.shape[0], force.size, colour.size if coloured else 0
    d = states + forces + sensors
    P = np.zeros((d, padded(d)))
    for s in range(states):
        for t in range(states):
            P[s, t] = P0[s, t]
    for t in range(forces):
        P[states + t, states + t] = force[t]
    for t in range(sensors):
        P[states + forces + t, states + forces + t] = colour[t]
    return P


@jitted
def observe(
    h: Array, C: Array, D: Array, place: NDArray[np.int64], i: int, j: int
) -> None:  # pragma: no cover - compiled
    """Write how the j-th sensor sees the i-th state (d,), SI."""
    states, forces = C.shape[2], D.shape[2]
    for s in range(states):
        h[s] = C[i, j, s]
    for s in range(forces):
        h[states + s] = D[i, j, s]
    for s in range(states + forces, h.size):
        h[s] = 0.0
    if place[j] >= 0:
        h[states + forces + place[j]] = 1.0


@jitted
def seen_through(k: Array, P: Array, h: Array) -> None:  # pragma: no cover - compiled
    """Write P·h (d,), SI: how the state with covariance P (d, d) varies with what a sensor sees of
    it, h, most of which is zero."""
    for s in range(k.size):
        k[s] = 0.0
    for t in range(P.shape[0]):
        if h[t] != 0.0:
            part = h[t]
            for s in range(k.size):
                k[s] += P[t, s] * part


@jitted
def measured(P: Array, k: Array, by: float) -> None:  # pragma: no cover - compiled
    """Take k·kᵀ·by from the covariance (d, d), SI, in place."""
    for s in range(P.shape[0]):
        part = k[s] * by
        for t in range(k.size):
            P[s, t] -= part * k[t]


@jitted
def predict(
    P: Array,
    T: Array,
    F: Array,
    share: Array,
    right: Array,
    force: Array,
    colour: Array,
    i: int,
) -> None:  # pragma: no cover - compiled
    """Move the covariance (d, d), SI, on by the i-th step, in place. Force and colour are each
    their own share of what they were: only the states mix."""
    (d, width), states, forces = P.shape, F.shape[0], force.size
    first = states + forces
    for s in range(states):
        for t in range(width):
            T[s, t] = 0.0
        for u in range(first):
            part = F[s, u]
            for t in range(width):
                T[s, t] += part * P[u, t]
    for s in range(states):
        for t in range(s, states):
            total = 0.0
            for u in range(first):
                total += T[s, u] * F[t, u]
            for u in range(forces):
                fresh = force[u] * (1 - share[states + u] ** 2)
                total += right[i, s, u] * fresh * right[i, t, u]
            P[s, t] = total
            P[t, s] = total
        for t in range(states, d):
            total = T[s, t] * share[t]
            if t < first:
                u = t - states
                total += right[i, s, u] * force[u] * (1 - share[t] ** 2)
            P[s, t] = total
            P[t, s] = total
    for s in range(states, d):
        for t in range(s, d):
            total = share[s] * P[s, t] * share[t]
            if s == t:
                fresh = force[s - states] if s < first else colour[s - first]
                total += fresh * (1 - share[s] ** 2)
            P[s, t] = total
            P[t, s] = total
