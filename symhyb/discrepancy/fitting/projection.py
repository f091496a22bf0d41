"""Windows linearised about their simulation, with their initial states projected out.

Every window has its own initial state. A QR factorisation of its columns takes these out of what
is left and of what parameters do, window by window (variable projection: Golub & Pereyra, SIAM J.
Numer. Anal. 10, 1973).
Sizes: F free parameters, W windows, L samples a window, m sensors, X states, R directions in which
a start may move (X without constraints).
"""

from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.fitting.anchors import anchored
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

RIDGE = 1e-7  # of the scaled columns of initial states: what a window does not show stays


@dataclass(frozen=True, slots=True)
class Projected:
    """The windows of one recording, in units of the noise: the ``residual`` (W, L·m), what
    parameters do to it (``by_free``, (W, L·m, F)), the orthonormal ``basis`` (W, L·m, R) of what
    initial states do, with its ``triangle`` (W, R, R) under columns of the ``scale`` (W, R);
    ``rest`` (W, L·m, F + 1) is [by_free, residual] with the initial states projected out. A window
    that ran away is not finite. Starts move along the R directions of ``lift`` (W, X, R), where
    there are constraints. The last rows of a window are those of its inner states."""

    residual: Array
    by_free: Array
    basis: Array
    triangle: Array
    scale: Array
    rest: Array
    lift: Array | None = None

    def start_step(self, change: Array, damping: float) -> tuple[Array, Array]:
        """A step of the initial states (W, X), SI: their whole reply to a ``change`` (F,) of the
        parameters, and a damped one to the residual; and the decrease (W,) of the squares that it
        predicts. Not finite for a window that ran away."""
        across, share = self.basis.transpose(0, 2, 1), 1 / (1 + damping)
        with np.errstate(over="ignore", invalid="ignore"):
            along = (across @ self.residual[..., None])[..., 0]
            reply = (across @ (self.by_free @ change)[..., None])[..., 0]
            solved = np.linalg.solve(self.triangle, (share * along - reply)[..., None])[..., 0]
            step = solved / self.scale
            gain = (1 - (1 - share) ** 2) * np.sum(along**2, axis=1)
        return step if self.lift is None else (self.lift @ step[..., None])[..., 0], gain

    def with_rows(self, rows: NDArray[np.int64], fresh: Self) -> Self:
        """The same with some of the windows as they are in ``fresh``."""
        changed = {}
        for one in fields(self):
            mine, theirs = getattr(self, one.name), getattr(fresh, one.name)
            if mine is not None:
                changed[one.name] = mine.copy()
                changed[one.name][rows] = theirs
        return replace(self, **changed)

    def spread_out(self, own: tuple[int, ...], size: int) -> Self:
        """The same with the columns of this recording's free parameters, ``own``, among those of
        all ``size`` numbers."""
        by_free = np.zeros((*self.by_free.shape[:2], size))
        by_free[:, :, list(own)] = self.by_free
        rest = np.zeros((*self.rest.shape[:2], size + 1))
        rest[:, :, [*own, size]] = self.rest
        return replace(self, by_free=by_free, rest=rest)


def projected(model: WindowModel, item: Cut, p: Array, start: Array, sd: Array) -> Projected:
    """Linearise the windows that begin at ``start`` (W, X) under ``p`` (P,), noise ``sd`` (m,), all
    in SI, and project their initial states out."""
    with np.errstate(over="ignore", invalid="ignore"):  # a window that runs away
        linear = model.differentiate(item.block, start, p)
        by_start, by_free = linear.from_start_and_free()
    residual = np.where(np.isfinite(item.block.y), item.block.y - linear.output, 0.0)
    residual = item.white(residual[..., None], sd)[..., 0]
    by_start, by_free = item.white(by_start, sd), item.white(by_free, sd)
    first = 2 * len(model.form.free)
    if inner := start.shape[1] - first:  # a row more for each, which ties it to its prior
        anchor, windows = anchored(model, item, p, slopes=True), len(start)
        tied = np.zeros((windows, inner, by_start.shape[2]))
        each = np.arange(inner)
        tied[:, each, by_start.shape[2] - inner + each] = 1 / anchor.spread
        off = (anchor.z - start[:, first:]) / anchor.spread
        residual = np.concatenate([residual, off], axis=1)
        by_start = np.concatenate([by_start, tied], axis=1)
        by_free = np.concatenate([by_free, -anchor.by_free / anchor.spread[..., None]], axis=1)
    return _projected(residual, by_start, by_free, linear.begin)


def _projected(residual: Array, by_start: Array, by_free: Array, lift: Array | None) -> Projected:
    with np.errstate(over="ignore", invalid="ignore"):
        scale = np.linalg.norm(by_start, axis=1, keepdims=True)
    scale = np.where(scale > 0, scale, 1.0)
    windows, rows, directions = by_start.shape
    ridge = np.broadcast_to(RIDGE * np.eye(directions), (windows, directions, directions))
    basis, triangle = np.linalg.qr(np.concatenate([by_start / scale, ridge], axis=1))
    basis = basis[:, :rows]
    joined = np.concatenate([by_free, residual[..., None]], axis=2)
    with np.errstate(over="ignore", invalid="ignore"):
        rest = joined - basis @ (basis.transpose(0, 2, 1) @ joined)
    return Projected(residual, by_free, basis, triangle, scale[:, 0], rest, lift)
