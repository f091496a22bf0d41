"""Windows of recordings, and the linear algebra that removes their initial states.

Each window has free initial states. They are eliminated by an orthogonal projection (variable
projection; Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973), so that what remains is a linear
regression of the whitened residual on the parameters and candidate forces.
Sizes: W windows, L samples a window, m sensors, n coordinates, F columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.motion import Motion, acting, measured
from symhyb.model.types import Model
from symhyb.numeric.buffers import Array
from symhyb.numeric.machine import Machine
from symhyb.numeric.windows import Block

FINITE_SHARE = 0.7  # of the samples of a window that must be there
STEEP = ("friction",)  # kinds that need finer steps at reversals
SLOW_SHARE = 0.02
SAMPLES_LEAST = 12  # samples a window has at least


@dataclass(frozen=True, slots=True)
class Laid:
    """Windows laid on one recording: the block, start states (W, 2n) and the motion (W, L, 2n)
    from smoothing, SI, and ``held`` (W,), True where a window only validates."""

    block: Block
    start: Array
    motion: Array
    held: NDArray[np.bool_]

    def chosen(self, rows: NDArray[np.int64]) -> "Laid":
        """Some of the windows; of these every third validates."""
        whole = self.block
        block = Block(whole.t[rows], whole.u[rows], whole.y[rows], whole.substeps[rows])
        return Laid(block, self.start[rows], self.motion[rows], np.arange(rows.size) % 3 == 2)

    def suited(self, model: Model) -> "Laid":
        """The windows with the fewest steps everywhere, unless the model has a steep law."""
        if any(element.kind in STEEP for element in model.elements):
            return self
        parts = np.full_like(self.block.substeps, self.block.substeps.min())
        return replace(self, block=replace(self.block, substeps=parts))

    def first(self) -> "Laid":
        """The first window alone."""
        return self.chosen(np.array([0]))


def lay(
    recording: Recording,
    machine: Machine,
    motion: Motion,
    length_s: float,
    substeps: NDArray[np.int64] | None = None,
) -> Laid | None:
    """Lay windows of ``length_s`` seconds without overlap; every third one validates.

    Windows that straddle a gap in time or miss too many samples are left out. ``substeps`` (N − 1,)
    are the integration steps between the samples of the recording, default one. Returns None if
    the recording holds no window.
    """
    step = float(np.median(np.diff(recording.t)))
    samples = max(round(length_s / step) + 1, SAMPLES_LEAST)
    if samples > recording.t.size:
        return None
    firsts = np.arange(0, recording.t.size - samples + 1, samples - 1)
    rows = firsts[:, None] + np.arange(samples)
    y, u = measured(recording, machine), acting(recording, machine)
    whole = (recording.t[rows[:, -1]] - recording.t[rows[:, 0]]) < 1.5 * (samples - 1) * step
    present = np.isfinite(y[:, np.isfinite(y).any(axis=0)])
    enough = present[rows].mean(axis=(1, 2)) >= FINITE_SHARE
    rows = rows[whole & enough]
    if len(rows) == 0:
        return None
    states = np.concatenate([motion.q, motion.v], axis=1)[rows]
    held = np.arange(len(rows)) % 3 == 2
    parts = np.ones(recording.t.size - 1, int) if substeps is None else substeps
    block = Block(recording.t[rows], u[rows], y[rows], parts[rows[:, :-1]])
    return Laid(block, states[:, 0], states, held)


def reversals(rates: Array) -> NDArray[np.bool_]:
    """Intervals between samples (N − 1,) near a reversal or a rest of one of ``rates`` (N, places),
    SI.

    There dry friction turns over or holds, and the integration needs finer steps: where a rate
    changes sign, three intervals to either side, and where it is below 2 % of its largest.
    """
    size = np.abs(rates).max(axis=0)
    slow = (np.abs(rates) < SLOW_SHARE * size).any(axis=1)
    turns = (np.sign(rates[1:]) * np.sign(rates[:-1]) <= 0).any(axis=1) | slow[1:] | slow[:-1]
    near = np.convolve(turns.astype(float), np.ones(7), mode="same") > 0
    return near[: turns.size]


@dataclass(frozen=True, slots=True)
class Reduced:
    """Whitened windows with the initial states projected out: ``count`` (W,) samples that are
    there, less the initial states; ``held`` (W,); ``grams`` (W, F + 1, F + 1) of [columns,
    residual], where the residual is dimensionless and a column is per SI unit of its number."""

    count: NDArray[np.int64]
    held: NDArray[np.bool_]
    grams: Array


def reduce(
    residual: Array, by_start: Array, columns: Array, sd: Array, held: NDArray[np.bool_]
) -> Reduced:
    """Project the initial states out of residual (W, L, m) and columns (W, L, m, F).

    ``by_start`` (W, L, m, 2n), ``sd`` (m,) in SI. Missing residuals are NaN.
    """
    windows, length, m = residual.shape
    seen = np.isfinite(residual)
    weight = np.where(seen, 1 / sd, 0.0).reshape(windows, length * m, 1)
    flat = np.where(seen, residual, 0.0).reshape(windows, length * m, 1)
    joined = np.concatenate([columns.reshape(windows, length * m, -1), flat], axis=2) * weight
    starts = by_start.reshape(windows, length * m, -1) * weight
    scale = np.linalg.norm(starts, axis=1, keepdims=True)
    basis, triangle = np.linalg.qr(starts / np.where(scale > 0, scale, 1.0))
    pivots = np.abs(np.diagonal(triangle, axis1=1, axis2=2))
    basis = basis * (pivots > 1e-9)[:, None, :]
    joined = joined - basis @ (basis.transpose(0, 2, 1) @ joined)
    grams = joined.transpose(0, 2, 1) @ joined
    count = seen.reshape(windows, -1).sum(axis=1) - (pivots > 1e-9).sum(axis=1)
    return Reduced(count, held, grams)


def merge(
    parts: Sequence[Reduced],
) -> tuple[Array, NDArray[np.int64], NDArray[np.bool_]]:
    """Grams (ΣW, F + 1, F + 1) in the units of :class:`Reduced`, counts and held flags (ΣW,) of
    several recordings."""
    return (
        np.concatenate([part.grams for part in parts]),
        np.concatenate([part.count for part in parts]),
        np.concatenate([part.held for part in parts]),
    )


def correlation_time(residuals: Sequence[Array], m: int) -> float:
    """Integrated autocorrelation c ≥ 1 of whitened residuals [(W, L·m), …], in samples.

    c = 1 + 2 Σ ρ_k, summed to the first lag where ρ drops below 0.05 (a plain initial-sequence
    estimate: Geyer, Statistical Science 7, 1992); the largest over the sensors.
    """
    worst = 1.0
    for sensor in range(m):
        series = [part.reshape(part.shape[0], -1, m)[:, :, sensor] for part in residuals]
        longest = min(part.shape[1] for part in series)
        power = sum(float(np.sum(part**2)) for part in series)
        if power == 0:
            continue
        total = 1.0
        for lag in range(1, longest):
            cross = sum(float(np.sum(part[:, lag:] * part[:, :-lag])) for part in series)
            rho = cross / power
            if rho < 0.05:
                break
            total += 2 * rho
        worst = max(worst, total)
    return worst
