"""How much noise a channel has, from what the smoothed motion leaves of it.

What is left is noise, what a fault of the channel leaves where other sensors show the same motion,
and what the spline is too slow for: after an impact, a current or an acceleration runs ahead of it
for a few samples. Noise is about normal. Where a few samples hold most of the power, these are
motion, and the noise is what the many scatter by.
Sizes: N samples.
"""

import numpy as np

from symhyb.judgement import BURSTS, SAMPLES_TELL
from symhyb.numeric.kernels.buffers import Array

NORMAL = 1.4826  # standard deviation of normal noise over its median deviation (Hampel 1974)


def noise_spread(residual: Array, y: Array, t: Array) -> float:
    """One standard deviation of the noise of a sensor that recorded ``y`` (N,) at ``t`` (N,), s,
    from what a smoothed motion leaves of it (N,); NaN without samples."""
    own = _own_noise(residual, y, t)
    own = own[np.isfinite(own)]
    if not own.size:
        return float("nan")
    size = float(np.sqrt(np.mean(own**2)))
    if own.size < SAMPLES_TELL or not size > 0 or not excess_kurtosis(own) > BURSTS:
        return size
    return min(NORMAL * float(np.median(np.abs(own - np.median(own)))), size) or size


def excess_kurtosis(values: Array) -> float:
    """How much heavier the tails of values (N,) of any unit are than those of normal noise (0);
    NaN where they do not scatter. Fisher's definition."""
    squares = (values - values.mean()) ** 2
    with np.errstate(invalid="ignore"):
        return float(np.mean(squares**2) / np.mean(squares) ** 2 - 3)


def _own_noise(residual: Array, y: Array, t: Array) -> Array:
    """The residual (N,) of a sensor that recorded ``y`` (N,) without what an offset, a gain or a
    delay of it would leave where other sensors show the same motion: that is no noise."""
    seen = np.isfinite(residual) & np.isfinite(y)
    if seen.sum() < SAMPLES_TELL:
        return residual
    fitted = (y - residual)[seen]
    columns = np.column_stack([np.ones(fitted.size), fitted, np.gradient(fitted, t[seen])])
    columns[:, 1:] /= np.maximum(np.abs(columns[:, 1:]).max(axis=0), 1e-300)
    values = np.linalg.lstsq(columns, residual[seen], rcond=1e-9)[0]
    return np.asarray(residual[seen] - columns @ values)
