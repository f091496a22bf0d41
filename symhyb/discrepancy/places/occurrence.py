"""When a mismatch acts at a place, at which frequencies, and beyond which amplitude.

Each is asked of the data before any law is named. Beginning or ending: a force surface that is
fitted to the windows after (before) some moment and is zero elsewhere is held against one that acts
throughout, on windows that were held out. Frequencies: the cross-spectrum of the missing force and
of the surface, whose noise averages out because the surface is smooth. Amplitude: the missing force
averaged over narrow bins of the stretch. Sizes: W windows, B knots of the surface, N samples.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.results import Change
from symhyb.judgement import (
    BEYOND_LEAST,
    FEWEST,
    HANDFUL,
    MARGIN,
    MOST,
    NEAR_NOISE,
    NOTABLE,
    SAMPLES_TELL,
    SIGNIFICANT,
    SURE,
)
from symhyb.numeric.kernels.buffers import Array

BAND = (0.1, 0.9)  # of the power: the band between these quantiles
BINS = 24  # of the size of the stretch


@dataclass(frozen=True, slots=True)
class Placed:
    """Reduced windows of all recordings at one place: ``grams`` (W, B + 1, B + 1) in units of the
    noise, ``count`` and ``held`` (W,), the ``recording`` (W,) each belongs to, its first and last
    time ``t`` (W, 2) in s."""

    grams: Array
    count: NDArray[np.int64]
    held: NDArray[np.bool_]
    recording: NDArray[np.int64]
    t: Array


Solve = Callable[[Array], Array]


def costs(grams: Array, values: Array) -> Array:
    """χ² (W,), dimensionless, of windows under the coefficients (B,) of a surface."""
    mix = np.append(-values, 1.0)
    return np.asarray(np.einsum("i,wij,j->w", mix, grams, mix))


def change_of(placed: Placed, solve: Solve, names: Sequence[str]) -> Change | None:
    """Whether what the place lacks begins or ends within a recording; ``solve`` gives the
    coefficients (B,) of the surface for a sum of Gram matrices (B + 1, B + 1), in units of the
    noise, ``names`` those of the recordings.

    Of all moments between windows the best is taken; it must be significant for the number of
    moments tried, and take half of what acting throughout leaves beyond the noise.
    """
    fitted, held = ~placed.held, placed.held
    if not held.any():
        return None
    before = placed.grams[:, -1, -1]
    always = float(costs(placed.grams, solve(placed.grams[fitted].sum(axis=0)))[held].sum())
    best: tuple[float, int, float, bool] | None = None
    tried = 0
    for r in np.unique(placed.recording):
        rows = np.flatnonzero(placed.recording == r)
        for k in range(FEWEST, rows.size - FEWEST + 1):
            moment = float((placed.t[rows[k - 1], 1] + placed.t[rows[k], 0]) / 2)
            for begins in (True, False):
                tried += 1
                calm = np.zeros(before.size, bool)
                calm[rows[:k] if begins else rows[k:]] = True
                if not (fitted & ~calm).any() or not _quiet(placed, calm):
                    continue
                values = solve(placed.grams[fitted & ~calm].sum(axis=0))
                total = float(np.where(calm, before, costs(placed.grams, values))[held].sum())
                if best is None or total < best[0]:
                    best = total, int(r), moment, begins
    if best is None:
        return None
    total, r, moment, begins = best
    floor = float(placed.count[held].sum())
    unit = max(total / max(floor, 1.0), 1.0)
    sure = (always - total) / unit > SIGNIFICANT + 2 * np.log(tried)
    part = (always - total) / max(always - min(floor, total), 1e-12)
    if not sure or part < MOST:
        return None
    rows = np.flatnonzero(placed.recording == r)
    width = float(np.median(placed.t[rows, 1] - placed.t[rows, 0]))
    return Change(names[r], moment, width, "begins" if begins else "ends")


def _quiet(placed: Placed, calm: NDArray[np.bool_]) -> bool:
    """Whether windows in which nothing is said to act show no mismatch, by the rule for a whole
    recording."""
    count = max(float(placed.count[calm].sum()), 1.0)
    left = float(placed.grams[calm, -1, -1].sum()) / count
    return left <= NEAR_NOISE + SURE * float(np.sqrt(2 / count))


def still(placed: Placed, change: Change, names: Sequence[str]) -> NDArray[np.bool_]:
    """The windows (W,) in which nothing acts, by a change."""
    mine = placed.recording == list(names).index(change.recording)
    if change.kind == "begins":
        return np.asarray(mine & (placed.t[:, 0] < change.time_s - 1e-9))
    return np.asarray(mine & (placed.t[:, 1] > change.time_s + 1e-9))


def sharpened(change: Change, fine: Placed, solve: Solve, names: Sequence[str]) -> Change:
    """The moment of a change on shorter windows (W,): the one within a window of the first guess
    that leaves least, in units of the noise, with no surface before (after) it."""
    r = list(names).index(change.recording)
    mine = np.flatnonzero(fine.recording == r)
    begins = change.kind == "begins"
    later = fine.t[:, 0] >= change.time_s + change.width_s
    earlier = fine.t[:, 1] <= change.time_s - change.width_s
    sure = np.where(fine.recording == r, later if begins else earlier, True)
    if not sure.any() or mine.size == 0:
        return change
    gain = fine.grams[:, -1, -1] - costs(fine.grams, solve(fine.grams[sure].sum(axis=0)))
    edges = np.append(fine.t[mine, 0], fine.t[mine[-1], 1])
    sums = np.concatenate([[0.0], np.cumsum(gain[mine])])  # gained before each edge
    kept = sums[-1] - sums if begins else sums
    near = np.abs(edges - change.time_s) <= 1.5 * change.width_s
    if not near.any():
        return change
    at = int(np.argmax(np.where(near, kept, -np.inf)))
    width = float(np.median(fine.t[mine, 1] - fine.t[mine, 0]))
    return Change(change.recording, float(edges[at]), width, change.kind)


def spectrum(t: Array, missing: Array, acting: Array) -> tuple[Array, Array]:
    """Frequencies (F,) in Hz and the power (F,), in squares of the unit of the forces, of a
    ``missing`` force (N,) that the ``acting`` one (N,) explains, over ``t`` (N,) in s: the real
    part of their cross-spectrum, smoothed over three lines. Empty where samples lie unevenly."""
    step = float(np.median(np.diff(t))) if t.size > SAMPLES_TELL else 0.0
    if step <= 0 or np.max(np.abs(np.diff(t) - step)) > 0.5 * step:
        return np.empty(0), np.empty(0)
    window = np.hanning(t.size)
    first, second = (np.fft.rfft((x - x.mean()) * window) for x in (missing, acting))
    power = np.convolve(np.real(first * np.conj(second)), np.ones(3) / 3, mode="same")
    return np.arange(power.size) / (t.size * step), np.asarray(np.maximum(power, 0.0), dtype=float)


def band_of(lines: Array, power: Array) -> tuple[float, float] | None:
    """The band in Hz that holds the middle four fifths of the ``power`` (F,) over frequencies
    ``lines`` (F,) in Hz; None if it is no narrower than half of what the samples resolve."""
    if lines.size < HANDFUL or not power.sum() > 0:
        return None
    total = np.cumsum(power) / power.sum()
    low, high = (float(lines[np.searchsorted(total, share)]) for share in BAND)
    return None if high - low > MOST * lines[-1] else (low, high)


def beyond_of(stretch: Array, missing: Array) -> float | None:
    """The size of the ``stretch`` (N,), from zero, below which no force is ``missing`` (N,) on
    average, and beyond which one is, SI; None for a force that is there from the start, or where
    the stretch never was below."""
    size, most = np.abs(stretch), float(np.quantile(np.abs(stretch), 0.999))
    if most <= 0:
        return None
    edges = np.linspace(0.0, most, BINS + 1)
    means, errors = np.zeros(2 * BINS), np.full(2 * BINS, np.inf)
    for i in range(BINS):
        for side in (0, 1):
            inside = (size >= edges[i]) & (size < edges[i + 1]) & ((stretch < 0) == bool(side))
            if inside.sum() >= HANDFUL:
                means[2 * i + side] = float(missing[inside].mean())
                errors[2 * i + side] = float(missing[inside].std() / np.sqrt(inside.sum() / 4))
    largest = int(np.argmax(np.abs(means)))
    if not abs(means[largest]) > SURE * errors[largest]:
        return None
    loud = np.abs(means) > np.maximum(
        NOTABLE * abs(means[largest]), MARGIN * np.minimum(errors, 1e300)
    )
    first = int(np.flatnonzero(loud)[0]) // 2 if loud.any() else 0
    threshold = float(edges[first])
    if threshold < BEYOND_LEAST * most or size.min() >= threshold:
        return None
    inner, outer = (
        float(np.sqrt(np.mean(missing[rows] ** 2)))
        for rows in (size < threshold, size >= threshold)
    )
    return threshold if inner < MOST * outer else None
