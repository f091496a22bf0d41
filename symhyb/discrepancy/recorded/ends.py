"""The ends of a smoothed motion, where a spline swings and its derivatives are none of the motion.

Sizes: N samples.
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.recorded.motion import Motion
from symhyb.numeric.kernels.buffers import Array

END_KNOTS = 3  # at either end, between which a spline is not held from both sides


def margin_of(motion: Motion) -> float:
    """How long, in s, either end of a smoothed motion is."""
    return END_KNOTS * motion.spacing_s


def between_ends(motion: Motion, t: Array) -> NDArray[np.bool_]:
    """Which samples at ``t`` (N,) in s lie between both ends; all where the ends are as much as the
    half of the motion."""
    margin, first, last = margin_of(motion), motion.t[0], motion.t[-1]
    if 4 * margin > last - first:
        return np.ones(t.size, dtype=bool)
    return np.asarray((t >= first + margin) & (t <= last - margin))
