"""The smoothed motion of many pieces of one recording that are sampled alike.

Where the samples are even, none is missing, and every sensor is linear in the motion, the splines
of all pieces of one length solve the same equations: they are factored once. The result is that of
:func:`.motion_of` for these knots, but for rounding.
Sizes: N samples, n coordinates, m sensors, B coefficients a coordinate.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.recorded.signals import measured
from symhyb.discrepancy.recorded.splines import design, ridge, spline_basis
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine

JITTER = 1e-3  # of a step: what is nearer to even times is even
PROBES = 50  # samples that show whether a sensor is linear
LINEAR = 1e-9  # of the largest slope: slopes that differ by less are constant


@dataclass(frozen=True, slots=True, eq=False)
class Even:
    """Splines on ``samples`` even samples, ``step_s`` apart: ``values`` are q, v and a by
    coefficients, ``right`` (n·B, N·m) makes the right side of the normal equations of what the
    ``seen`` sensors (m,) show less ``resting`` (m,), SI, and ``solve`` solves them."""

    samples: int
    step_s: float
    values: tuple[sparse.csr_array, ...]
    seen: NDArray[np.intp]
    right: sparse.csr_array
    resting: Array
    solve: Callable[[Array], Array]

    def fits(self, recording: Recording, y: Array) -> bool:
        """Whether a recording with sensors ``y`` (N, m), SI, is sampled so."""
        return (
            y.shape[0] == self.samples
            and bool(np.isfinite(y[:, self.seen]).all())
            and is_even(recording.t, self.step_s)
        )

    def motion(self, recording: Recording, y: Array, like: Motion) -> Motion:
        """The motion by sensors ``y`` (N, m), SI, with the bands of another one."""
        found = self.solve(self.right @ np.ravel((y[:, self.seen] - self.resting).T))
        parts = found.reshape(-1, self.values[0].shape[1]).T
        q, v, a = (np.ascontiguousarray(basis @ parts) for basis in self.values)
        return replace(like, t=recording.t, q=q, v=v, a=a)


def even_of(recording: Recording, machine: Machine, motion: Motion) -> Even | None:
    """The equations of all pieces that are sampled like a ``recording``, with the knots and the
    noise of its ``motion``; None where they are not the same for all."""
    y = measured(recording, machine)
    step = float(np.median(np.diff(recording.t)))
    seen = np.flatnonzero(np.isfinite(motion.sd))
    plain = not (machine.constraints or motion.blind)
    if not plain or not is_even(recording.t, step) or not np.isfinite(y[:, seen]).all():
        return None
    linear = _linear(machine, motion, seen)
    if linear is None:
        return None
    slopes, resting = linear
    basis = spline_basis(recording.t, motion.spacing_s)
    weights = 1 / motion.sd[seen]
    each = [np.broadcast_to(slope, (recording.t.size, *slope.shape)) for slope in slopes]
    rows = design(basis, each, np.ones((y.shape[0], seen.size), dtype=bool), weights)
    normal = (rows.T @ rows).tocsc()
    solver = splu(normal + ridge(normal))
    weighted = sparse.diags_array(np.repeat(weights, recording.t.size))
    right = sparse.csr_array(rows.T @ weighted)
    return Even(recording.t.size, step, basis, seen, right, resting, solver.solve)


def smoothed(recording: Recording, machine: Machine, even: Even | None, like: Motion) -> Motion:
    """The motion of a piece, with the knots of another one."""
    y = measured(recording, machine)
    if even is not None and even.fits(recording, y):
        return even.motion(recording, y, like)
    return motion_of(recording, machine, [like.spacing_s])


def is_even(t: Array, step: float) -> bool:
    """Whether times (N,) in s are even, ``step`` s apart."""
    even = t[0] + step * np.arange(t.size)
    return bool(np.abs(t - even).max() <= JITTER * step)


def _linear(
    machine: Machine, motion: Motion, seen: NDArray[np.intp]
) -> tuple[tuple[Array, ...], Array] | None:
    """Slopes of the ``seen`` sensors (m, n) by q, v and a, and what they show at zero (m,), SI;
    None where one is not linear in the motion, or shows anything else."""
    some = np.unique(np.linspace(0, motion.t.size - 1, PROBES).astype(int))
    total, m, n = some.size, len(machine.model.sensors), machine.n
    moved = motion.q[some], motion.v[some], motion.a[some]
    rng = np.random.default_rng(1)  # whatever else acts, it must not show
    z, u = (rng.normal(size=(total, machine.outputs.size1_in(i))) for i in (3, 4))
    given = *moved, z, u, motion.t[some], machine.values
    (y,) = along(machine.outputs, given, (6,), total)
    resting, slopes = y.reshape(total, m)[:, seen], []
    size = np.abs(resting).max(initial=1e-300)
    for one, part in zip(along(machine.output_slopes, given, (6,), total), moved, strict=True):
        slope = one.reshape(total, n, m).transpose(0, 2, 1)[:, seen]
        if np.ptp(slope, axis=0).max() > LINEAR * np.abs(slope).max(initial=1e-300):
            return None
        slopes.append(slope[0])
        resting = resting - part @ slope[0].T
    return (tuple(slopes), resting[0]) if np.ptp(resting, axis=0).max() <= LINEAR * size else None
