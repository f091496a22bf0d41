"""Splines for the motion of a closed loop: of a few coordinates, which determine all others.

    q_d follows from q_s by c(q, t) = 0,   ∂q/∂q_s = Z,   Z_s = 1,   Z_d = −J_d⁻¹ J_s

The coordinates s are those whose motion the others repeat least enlarged, everywhere along the
recording: the crank of a slider-crank, not its slider, which says nothing at the dead centres.
Sizes: N samples, n coordinates, s chosen ones, m sensors, c rows of constraints.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, islice

import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import closed, gaps_of, inverse_of, placing

ENLARGED_MOST = 20.0  # of the share of its motion that a coordinate makes another move
CHOICES_MOST = 300
ROWS_MOST = 200

Triple = tuple[Array, Array, Array]


@dataclass(frozen=True, slots=True)
class Independent:
    """The ``chosen`` coordinates of a machine along the times ``t`` (N,), and places ``q`` (N, n)
    near which the others are sought, SI."""

    machine: Machine
    t: Array
    chosen: tuple[int, ...]
    q: Array

    def complete(self, motion: Triple) -> Triple:
        """q, v, a (N, n) of all coordinates from those of the chosen (N, s)."""
        full = self.q.copy(), np.zeros_like(self.q), np.zeros_like(self.q)
        for part, own in zip(full, motion, strict=True):
            part[:, list(self.chosen)] = own
        on = closed(self.machine, full, self.t, self.machine.values, self.chosen)
        return on.q, on.v, on.a

    def lifted(self, motion: Triple, slopes: Sequence[Array]) -> Triple:
        """Slopes (N, m, s) by the chosen coordinates, their speeds and accelerations, from those by
        all (N, m, n); how an acceleration of another depends on places and speeds is left out."""
        z, turned = self._ratios(*motion)
        by_q, by_v, by_a = slopes
        return by_q @ z + by_v @ turned, by_v @ z, by_a @ z

    def spread(self, motion: Triple, sd: Array) -> Array:
        """One sd (n,) of all coordinates from that of the chosen (s,); of speeds and accelerations
        likewise."""
        z, _ = self._ratios(*motion)
        return np.asarray(np.sqrt(np.mean((z * sd) ** 2, axis=0).sum(axis=1)))

    def _ratios(self, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
        """∂q/∂q_s and ∂v/∂q_s (N, n, s)."""
        now = gaps_of(self.machine, q, v, a, self.t, self.machine.values)
        return _ratios(now.slope, now.turn, self.chosen)


def independent(machine: Machine, q: Array, t: Array) -> Independent | None:
    """The coordinates that determine all others along places ``q`` (N, n) at ``t`` (N,), SI; None
    where no choice does so everywhere: never with a nonholonomic constraint, under which places
    depend on the way that led there."""
    free, c = list(machine.free), machine.constraints
    if c > len(free) or len(placing(machine)) < c:
        return None
    rows = np.unique(np.linspace(0, t.size - 1, min(t.size, ROWS_MOST)).astype(int))
    still = np.zeros_like(q[rows])
    now = gaps_of(machine, q[rows], still, still, t[rows], machine.values)
    moves = np.sqrt(np.mean(np.diff(q, axis=0) ** 2, axis=0))
    moves = np.maximum(moves, 1e-6 * max(float(moves.max(initial=0.0)), 1e-300))
    best, least = None, ENLARGED_MOST
    for others in islice(combinations(free, c), CHOICES_MOST):
        chosen = tuple(i for i in range(machine.n) if i not in others)
        z, _ = _ratios(now.slope, now.turn, chosen)
        own = [i for i in chosen if i in free]
        columns = [chosen.index(i) for i in own]
        size = np.abs(z[:, list(others)][:, :, columns]) * moves[own] / moves[list(others), None]
        worst = float(size.max(initial=0.0))
        if worst < least:
            best, least = chosen, worst
    return None if best is None else Independent(machine, t, best, q)


def _ratios(slope: Array, turn: Array, chosen: tuple[int, ...]) -> tuple[Array, Array]:
    n = slope.shape[2]
    others = [i for i in range(n) if i not in chosen]
    z = np.zeros((len(slope), n, len(chosen)))
    z[:, list(chosen)] = np.eye(len(chosen))
    inverse = inverse_of(slope[:, :, others])
    z[:, others] = -inverse @ slope[:, :, list(chosen)]
    turned = np.zeros_like(z)
    turned[:, others] = -inverse @ (turn @ z)
    return z, turned


def placed_with(machine: Machine, q: Array, t: Array, shown: Array) -> Array:
    """How far sensors of slopes (N, m, n) and constraints together place each coordinate (n,), at a
    few samples of ``q`` (N, n), SI: 1 what they determine, 0 what they leave open."""
    rows = np.unique(np.linspace(0, min(t.size - 1, 50), 5).astype(int))
    still = np.zeros_like(q[rows])
    slope = gaps_of(machine, q[rows], still, still, t[rows], machine.values).slope
    slope = slope[:, placing(machine)]
    placed = np.zeros(machine.n)
    for both in np.concatenate([shown[rows], slope], axis=1):
        scaled = both / np.maximum(np.linalg.norm(both, axis=1, keepdims=True), 1e-300)
        resolved = np.linalg.pinv(scaled, rcond=1e-6) @ scaled
        placed = np.maximum(placed, np.diag(resolved) > 1 - 1e-6)
    return placed
