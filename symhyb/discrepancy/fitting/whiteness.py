"""Whether what a simulation leaves is noise: its correlation with itself and with the inputs.

Box & Jenkins, Time Series Analysis, ch. 8; Ljung, System Identification, 2nd ed., sec. 16.6. Sizes:
W windows, L samples a window, m sensors, k inputs, K lags.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.discrepancy.evidence import CONFIDENCE, Residuals, Whiteness
from symhyb.numeric.kernels.buffers import Array

LAGS_MOST = 40  # samples, either way
LAGS_SHARE = 4  # windows are at least so many times as long as the largest lag


def whiteness(
    recording: str, left: Residuals, sensors: Sequence[str], inputs: Sequence[str]
) -> tuple[Whiteness, ...]:
    """The whiteness of every sensor that recorded something, from windows of one recording.

    The bounds of a correlation with an input allow for both being correlated in time (Bartlett's
    formula), those of a residual with itself are of white noise.
    """
    most = min(LAGS_MOST, left.left.shape[1] // LAGS_SHARE)
    found = []
    for j, sensor in enumerate(sensors):
        e = _centred(left.left[:, :, j])
        with np.errstate(over="ignore"):  # of a simulation that runs away there is nothing to tell
            sound = 0.0 < float(np.sum(e**2)) < np.inf
        if most < 1 or not sound:
            continue
        lags = np.arange(-most, most + 1)
        auto = correlation(e, e, most)
        bounds = {"": CONFIDENCE / np.sqrt(_pairs(e, e, most))}
        cross = {}
        for i, name in enumerate(inputs):
            u = _centred(left.driven[:, :, i])
            if not np.any(u):
                continue
            cross[name] = correlation(e, u, most)
            wide = max(float(np.sum(auto * correlation(u, u, most))), 1.0)
            bounds[name] = CONFIDENCE * np.sqrt(wide / _pairs(e, u, most))
        found.append(Whiteness(recording, sensor, lags * left.step, auto, cross, bounds))
    return tuple(found)


def correlation(e: Array, u: Array, most: int) -> Array:
    """The correlation (2·most + 1,) of ``e`` with ``u`` (both (W, L), any unit, of mean 0), ``e``
    later by −most … most samples; what is 0 counts as missing."""
    size = float(np.sqrt(np.sum(e**2) * np.sum(u**2)))
    whole = float(np.sqrt(np.count_nonzero(e) * np.count_nonzero(u)))
    parts = _shifted(e.shape[1], most)
    sums = np.array([float(np.sum(e[:, late] * u[:, early])) for late, early in parts])
    return np.asarray(sums / size * (whole / _pairs(e, u, most)))


def _pairs(e: Array, u: Array, most: int) -> Array:
    """How many pairs of samples (2·most + 1,) a correlation rests on, at least 1."""
    parts = _shifted(e.shape[1], most)
    seen = [np.count_nonzero((e[:, late] != 0) & (u[:, early] != 0)) for late, early in parts]
    return np.maximum(np.array(seen, dtype=np.float64), 1.0)


def _shifted(length: int, most: int) -> list[tuple[slice, slice]]:
    """The samples of a window that lie ``-most`` … ``most`` behind others, and these others."""
    return [
        (slice(max(lag, 0), length + min(lag, 0)), slice(max(-lag, 0), length - max(lag, 0)))
        for lag in range(-most, most + 1)
    ]


def _centred(values: Array) -> Array:
    """Samples (W, L) less their mean, in their unit; 0 where there is none."""
    seen = np.isfinite(values)
    if not seen.any():
        return np.zeros(values.shape)
    return np.where(seen, values - np.mean(values, where=seen), 0.0)
