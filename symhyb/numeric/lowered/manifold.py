"""Motion that meets the constraints of a machine: projected onto them, and free directions.

    c(q, t) = 0,   J v + ∂c/∂t = 0,   J a + γ = 0        J = ∂c/∂q, or nonholonomic: no c

Places are projected by Newton steps, speeds and accelerations by one each, along W Jᵀ (W: how
easily each coordinate moves; 1 by default). Coordinates that are given stay. Sizes: N rows, n
coordinates, f of them free, m rows of constraints, P parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.assembly import placing_rows
from symhyb.numeric.lowered.machine import Machine, structure_of

STEPS = 12
CLOSED = 1e-11  # of the size of the motion: gaps below need no further step
SINGULAR = 1e-9  # of the largest singular value of J: smaller ones hold nothing


@dataclass(frozen=True, slots=True)
class Gaps:
    """What constraints leave open along a motion, SI: c ``gap``, ċ ``rate``, c̈ ``bend`` (N, m),
    their ``slope`` J and ∂ċ/∂q ``turn`` (N, m, n)."""

    gap: Array
    rate: Array
    bend: Array
    slope: Array
    turn: Array


def placing(machine: Machine) -> list[int]:
    """The rows of constraints that hold places; the others, nonholonomic, hold speeds alone."""
    closure = machine.closure
    if closure is None:
        return []
    return kept(("placing", structure_of(machine.model)), lambda: placing_rows(closure))


def gaps_of(machine: Machine, q: Array, v: Array, a: Array, t: Array, p: Array) -> Gaps:
    """What the constraints leave open along q, v and a (N, n) at t (N,) with p (P,), SI."""
    assert machine.closure is not None
    total, n = t.size, machine.n
    gap, rate, bend, slope, turn = along(machine.closure, (q, v, a, t, p), (4,), total)
    shaped = (part.reshape(total, n, -1).swapaxes(1, 2) for part in (slope, turn))
    return Gaps(gap, rate, bend, *shaped)


@dataclass(frozen=True, slots=True)
class Closed:
    """A motion on the constraints: q, v, a (N, n), what is ``left`` open of each (N, m), and their
    ``slope`` J there (N, m, n). SI."""

    q: Array
    v: Array
    a: Array
    left: Array
    slope: Array


def shown_at(machine: Machine) -> ca.Function:
    """(q, u, t, p) -> what sensors of places show (m,), its slopes (m, n), what constraints of
    places leave open (c,), its slopes J (c, n)."""
    return kept(("shown", structure_of(machine.model)), lambda: _shown_at(machine))


def _shown_at(machine: Machine) -> ca.Function:
    assert machine.closure is not None
    q, t = ca.SX.sym("q", machine.n), ca.SX.sym("t")
    u, p = ca.SX.sym("u", len(machine.model.inputs)), ca.SX.sym("p", machine.values.size)
    still, z = ca.SX.zeros(machine.n), ca.SX.zeros(machine.inner_states)
    y = machine.outputs(q, still, still, z, u, t, p)
    gap, _, _, slope, _ = machine.closure(q, still, still, t, p)
    rows = placing_rows(machine.closure)
    gap, slope = gap[rows], slope[rows, :]
    parts = [ca.densify(part) for part in (y, ca.jacobian(y, q), gap, slope)]
    return ca.Function("shown", [q, u, t, p], parts, {"cse": True})


def closed(
    machine: Machine,
    motion: tuple[Array, Array, Array],
    t: Array,
    p: Array,
    given: Sequence[int] = (),
    ease: Array | None = None,
) -> Closed:
    """The motion (q, v and a, (N, n) each, at ``t`` (N,)) moved onto the constraints under ``p``
    (P,), SI; the ``given`` coordinates stay. ``ease`` (n,) says how easily a coordinate moves (the
    variance of an estimate)."""
    q, v, a = (part.copy() for part in motion)
    free = [i for i in range(machine.n) if i not in given]
    weight = np.ones(len(free)) if ease is None else ease[free]
    now, rows = gaps_of(machine, q, v, a, t, p), placing(machine)
    for _ in range(STEPS):
        size = 1 + np.abs(q).max(axis=1, keepdims=True, initial=0.0)
        if np.all(np.abs(now.gap) <= CLOSED * size):
            break
        q[:, free] -= _back(now.slope[:, rows][:, :, free], now.gap[:, rows], weight)
        now = gaps_of(machine, q, v, a, t, p)
    inverse = _inverse(now.slope[:, :, free], weight)
    v[:, free] -= (inverse @ now.rate[..., None])[..., 0]
    last = gaps_of(machine, q, v, a, t, p)
    a[:, free] -= (inverse @ last.bend[..., None])[..., 0]
    return Closed(q, v, a, now.gap, last.slope)


def _back(slope: Array, gap: Array, weight: Array) -> Array:
    """The shortest step (N, f), measured by ``weight``, that closes a gap (N, m) to first order."""
    return np.asarray((_inverse(slope, weight) @ gap[..., None])[..., 0])


def _inverse(slope: Array, weight: Array) -> Array:
    """W Jᵀ (J W Jᵀ)⁻¹ (N, f, m), without what J cannot move; 0 where J is not finite."""
    root = np.sqrt(weight)
    sound = np.isfinite(slope).all(axis=(1, 2), keepdims=True)
    safe = np.where(sound, slope * root, 0.0)
    return np.asarray(root[:, None] * inverse_of(safe))


def inverse_of(slope: Array) -> Array:
    """Jᵀ (J Jᵀ)⁻¹ (N, f, m) of slopes (N, m, f); where J has lost rank, a pseudo-inverse of its
    rows at unit length, which costs ten times as much."""
    size = np.linalg.norm(slope, axis=2, keepdims=True)
    unit = slope / np.where(size > 0, size, 1.0)
    gram = unit @ unit.swapaxes(1, 2)
    lost = np.abs(np.linalg.det(gram)) < SINGULAR
    gram[lost] = np.eye(gram.shape[1])
    inverse = np.linalg.solve(gram, unit).swapaxes(1, 2)
    if lost.any():
        inverse[lost] = np.linalg.pinv(unit[lost], rcond=SINGULAR)
    return np.asarray(inverse / np.where(size > 0, size, np.inf).swapaxes(1, 2))


def free_part(machine: Machine, q: Array, t: Array, p: Array, forces: Array) -> Array:
    """What constraints leave of generalized forces (N, n) or (N, n, C) at q (N, n), t (N,): the
    force without the reactions that it calls up, M times the acceleration that it makes. SI."""
    if machine.shared is None:
        return forces
    (shared,) = along(machine.shared, (q, t, p), (2,), t.size)
    matrix = shared.reshape(t.size, machine.n, machine.n).swapaxes(1, 2)
    if forces.ndim == 2:
        return np.asarray((matrix @ forces[..., None])[..., 0])
    return np.asarray(matrix @ forces)


@dataclass(frozen=True, slots=True)
class Tangent:
    """Free directions at states on the constraints, SI: ``basis`` (N, 2f, 2f − m − h) of (q, v),
    where h of the m rows hold places, and ``by_p`` (N, 2f, F): how the nearest state moves with
    parameters. The first f − h directions move places."""

    basis: Array
    by_p: Array


def tangent(
    machine: Machine,
    q: Array,
    v: Array,
    t: Array,
    p: Array,
    given: Sequence[int] = (),
    chosen: Sequence[int] = (),
) -> Tangent:
    """The free directions at q, v (N, n) and t (N,), with slopes by the ``chosen`` parameters:

    J δq + c_p δp = 0,   J δv + (∂ċ/∂q) δq + ċ_p δp = 0
    """
    assert machine.closure_slopes is not None
    total, m, rows = t.size, machine.constraints, placing(machine)
    free = [i for i in range(machine.n) if i not in given]
    f = len(free)
    now = gaps_of(machine, q, v, 0 * v, t, p)
    slope, turn = now.slope[:, :, free], now.turn[:, :, free]
    slope = np.where(np.isfinite(slope), slope, 0.0)
    inverse = inverse_of(slope)
    moves = null = np.linalg.svd(slope)[2][:, min(m, f) :].swapaxes(1, 2)
    if len(rows) < m:  # places may move where speeds may not
        moves = np.linalg.svd(slope[:, rows])[2][:, min(len(rows), f) :].swapaxes(1, 2)
    r = moves.shape[2]
    basis = np.zeros((total, 2 * f, r + null.shape[2]))
    basis[:, :f, :r] = moves
    basis[:, f:, :r] = -inverse @ (turn @ moves)
    basis[:, f:, r:] = null
    by_p = np.zeros((total, 2 * f, len(chosen)))
    if chosen:
        parts = along(machine.closure_slopes, (q, v, t, p), (3,), total)
        gap, rate = (
            part.reshape(total, -1, m).swapaxes(1, 2)[:, :, list(chosen)] for part in parts
        )
        placed = inverse_of(slope[:, rows]) if len(rows) < m else inverse
        by_p[:, :f] = -placed @ gap[:, rows]
        by_p[:, f:] = -inverse @ (rate + turn @ by_p[:, :f])
    return Tangent(basis, by_p)
