"""A signal that acts in steps of one size, as a converter puts it out, with its slope by that size.

    y = q·round(u/q)

A held signal steps at its samples alone. A line steps anywhere between its times, where nothing
that samples a signal would see it: here it is the mean over one time step about each time, whose
impulse is exact. For x = u/q and k = round(x) the area under the steps is G(x) = k·x − k²/2, so
that the mean over a line from a to b is

    M = q·ΔG/Δx,   ∂M/∂q = (ΔG − Δk²/2)/Δx,   Δ from a to b

The slope by q holds how the steps move in time, too; of a held signal it is that of the line
through its samples: no difference of two values of q shows where single samples step.
Sizes: K times.
"""

import numpy as np

from symhyb.numeric.kernels.buffers import Array

EPS = 1e-9  # of a step: what moves less between two times stays on its level


def quantised(
    t: Array, u: Array, quantum: float, held: bool = False, over: int = 1
) -> tuple[Array, Array]:
    """The signal ``u`` (K,) at times ``t`` (K,), s, in steps of a ``quantum``, in its unit, and its
    slope by that (K,), dimensionless. A line counts with its mean over ``over`` times, half of them
    before and half behind."""
    if over == 1:  # half steps end between two times
        middle = 0.5 * (t[:-1] + t[1:])
        at = np.insert(middle, np.arange(t.size - 1), t[:-1]), t[-1:]
        fine = np.concatenate(at)
        reach, every = 1, slice(None, None, 2)
    else:
        fine, reach, every = t, over // 2, slice(None)
    x = np.interp(fine, t, u) / quantum
    means = [_over(fine, one, reach)[every] for one in _between(x)]
    if held:
        return quantum * np.round(u / quantum), means[1]
    return quantum * means[0], means[1]


def _between(x: Array) -> tuple[Array, Array]:
    """Mean of round(x) along each line from one value to the next (K − 1,), and of the slope of a
    step signal by the size of its steps, dimensionless."""
    level = np.round(x)
    area, rise = level * x - 0.5 * level**2, np.diff(x)
    still = np.abs(rise) < EPS
    safe = np.where(still, 1.0, rise)
    stays = np.round(0.5 * (x[:-1] + x[1:]))
    mean = np.where(still, stays, np.diff(area) / safe)
    slope = np.where(still, stays, (np.diff(area) - 0.5 * np.diff(level**2)) / safe)
    return mean, slope


def _over(t: Array, means: Array, reach: int) -> Array:
    """Means (K,) over ``reach`` steps to either side of each time, of means over each step."""
    area = np.concatenate([[0.0], np.cumsum(means * np.diff(t))])
    at = np.arange(t.size)
    first, last = np.maximum(at - reach, 0), np.minimum(at + reach, t.size - 1)
    return np.asarray((area[last] - area[first]) / (t[last] - t[first]))
