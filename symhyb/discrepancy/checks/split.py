"""A sensor under a periodic drive, split into linear response, noise, nonlinearity and transient.

What changes from period to period of the settled response is noise; what repeats at lines that the
drive does not excite is nonlinearity (at even lines of even order, where the drive has odd lines
only); what the first period has beyond the settled ones is transient. Nonlinearity at the excited
lines themselves counts as linear: one manoeuvre cannot show it. Source: Pintelon and Schoukens,
System Identification, 2nd ed., ch. 4. Sizes: N samples, k inputs, P samples a period.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.checks.repeats import same_input
from symhyb.judgement import HANDFUL, NEGLIGIBLE, OUTSTANDING, SMALL
from symhyb.numeric.kernels.buffers import Array

PERIODS_SPLIT = 4  # half of them are settled: two are needed to tell noise
LAGS_MOST = 60


@dataclass(frozen=True, slots=True)
class Split:
    """RMS of the parts of one sensor; ``even`` and ``odd`` are those of the nonlinear part where
    the drive has odd lines only, else None."""

    periods: int
    linear: float
    noise: float
    nonlinear: float
    transient: float
    even: float | None = None
    odd: float | None = None


def period_of(u: Array) -> int | None:
    """The period of all inputs (N, k), of any unit, together in samples, None if they do not
    repeat at least four times."""
    varying = [column - column.mean() for column in u.T if np.ptp(column) > 0]
    if not varying:
        return None
    size, total = len(u), 0.0
    for column in varying:
        spectrum = np.abs(np.fft.rfft(column, 2 * size)) ** 2
        total = total + np.fft.irfft(spectrum)[: size // PERIODS_SPLIT + 1] / np.sum(column**2)
    lags = np.arange(size // PERIODS_SPLIT + 1)
    near = np.asarray(total) / len(varying) * size / (size - lags)
    inner = near[1:-1]
    peaks = 1 + np.flatnonzero((inner >= near[:-2]) & (inner >= near[2:]) & (inner > 1 - SMALL))
    for lag in peaks[peaks >= HANDFUL][:LAGS_MOST]:
        if all(same_input(column[lag:], column[:-lag]) for column in varying):
            return int(lag)
    return None


def split_of(u: Array, y: Array, period: int) -> Split:
    """Split a sensor (N,), in its unit, under inputs (N, k) of a ``period`` in samples;
    counted from the end, where the machine has settled most. The mean is no part."""
    count = len(y) // period
    settled = count // 2
    drives = [settled_lines(column, period).mean(axis=0) for column in u.T]
    excited = np.any([excited_lines(drive) for drive in drives], axis=0)
    excited[0] = True  # the mean is neither
    lines = _lines(y, period, count)
    steady = settled_lines(y, period)
    mean, spread = steady.mean(axis=0), np.var(steady, axis=0, ddof=1)
    weight = np.full(mean.size, 2.0)
    weight[0] = 0.0
    if period % 2 == 0:
        weight[-1] = 1.0
    power = weight * np.abs(mean) ** 2
    noise = weight * spread
    order = np.arange(mean.size)
    odd_only = not np.any(excited[1:] & (order[1:] % 2 == 0))
    first = weight * np.abs(lines[0] - mean) ** 2

    def beyond(which: Array, seen: Array, share: float) -> float:
        """RMS of what lines have beyond their noise, 0 where noise alone explains them."""
        rest = float(np.sum(seen[which] - share * noise[which]))
        doubt = share * np.sqrt(np.sum(noise[which] ** 2) * (1 + 1 / (settled - 1)))
        return float(np.sqrt(rest)) if rest > OUTSTANDING * doubt else 0.0

    whole = np.ones_like(excited)
    return Split(
        count,
        linear=float(np.sqrt(np.sum(power[excited]))),
        noise=float(np.sqrt(np.sum(noise))),
        nonlinear=beyond(~excited, power, 1 / settled),
        transient=beyond(whole, first, 1 + 1 / settled),
        even=beyond(~excited & (order % 2 == 0), power, 1 / settled) if odd_only else None,
        odd=beyond(~excited & (order % 2 == 1), power, 1 / settled) if odd_only else None,
    )


def excited_lines(drive: NDArray[np.complex128]) -> NDArray[np.bool_]:
    """Which lines of a spectrum (F,) of a drive, in its unit, excite a machine; not the mean."""
    size = np.abs(drive)
    size[0] = 0.0
    return np.asarray(size > NEGLIGIBLE * size.max())


def settled_lines(signal: Array, period: int) -> NDArray[np.complex128]:
    """The spectra (S, F) of the later half S of all periods of a signal (N,), in its unit."""
    count = len(signal) // period
    return _lines(signal, period, count)[-(count // 2) :]


def _lines(signal: Array, period: int, count: int) -> NDArray[np.complex128]:
    """The spectrum of every period (count, P // 2 + 1), so that powers sum to mean squares."""
    rows = signal[len(signal) - count * period :].reshape(count, period)
    return np.asarray(np.fft.rfft(rows, axis=1) / period)
