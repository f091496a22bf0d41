"""Windows for tests, and slopes by differences."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.runs.windows import Block

Array = NDArray[np.float64]


def block(t: Array, u: Array, m: int, substeps: int | Array = 1) -> Block:
    """Windows (W, L) at times t with inputs u (W, L, k)."""
    parts = np.broadcast_to(np.asarray(substeps, np.int64), (t.shape[0], t.shape[1] - 1))
    return Block(t, u, np.zeros((*t.shape, m)), np.array(parts))


def uneven(windows: int, samples: int, seed: int) -> Array:
    """Times of windows that begin at different times, with uneven samples."""
    rng = np.random.default_rng(seed)
    gaps = 0.02 * rng.uniform(0.5, 1.5, (windows, samples - 1))
    begins = np.arange(windows)[:, None] * 1.7
    return begins + np.concatenate([np.zeros((windows, 1)), np.cumsum(gaps, axis=1)], axis=1)


def slope(function: Callable[[float], Array], step: float) -> Array:
    """Central difference with one step of Richardson."""
    wide, narrow = ((function(h) - function(-h)) / (2 * h) for h in (step, step / 2))
    return np.asarray((4 * narrow - wide) / 3)
