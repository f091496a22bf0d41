"""How recorded inputs run between their samples: as straight lines, or as smooth signals.

A generator whose converter is followed by a low-pass (band-limited excitation) leaves a signal that
is smooth between samples, and with few samples a period a straight line cuts its corners: a sine of
f Hz sampled every h s loses (π f h)²/3 of its size. The quintic spline through the samples loses
less than a hundredth of that up to a third of the sampling rate.
Sizes: K samples, k inputs.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.model.types import Input
from symhyb.numeric.kernels.buffers import Array

FINER = 8  # points of a smooth input for one sample: lines between them cut 64 times less
DEGREE = 5  # of the spline
SMOOTHER = 0.5  # of what lines miss of samples that were left out: splines may miss no more
FEWEST = 32  # samples that tell


def smooth_columns(inputs: Sequence[Input]) -> tuple[int, ...]:
    """Which inputs of a model are smooth between samples."""
    return tuple(i for i, item in enumerate(inputs) if item.between == "smooth")


def looks_smooth(t: Array, values: Array) -> bool:
    """Whether a signal (K,), sampled at times (K,) s, is smooth between its samples: with every
    second one left out, the spline through the others misses those less than half as far (RMS) as
    lines do. What jumps, is held or is mostly noise is not."""
    from scipy.interpolate import make_interp_spline

    kept = t.size - (t.size + 1) % 2  # ends with one that is not left out
    if kept < FEWEST:
        return False
    known, left_out = slice(0, kept, 2), slice(1, kept, 2)
    curve = make_interp_spline(t[known], values[known], k=DEGREE)(t[left_out])
    lines = np.interp(t[left_out], t[known], values[known])
    missed = [float(np.sum((guess - values[left_out]) ** 2)) for guess in (curve, lines)]
    return missed[0] < SMOOTHER**2 * missed[1]


def finer(t: Array, values: Array, smooth: Sequence[int]) -> tuple[Array, Array]:
    """Signals (K, c) at times ``t`` (K,), s, on a grid ``FINER`` times as fine: the columns
    ``smooth`` along quintic splines, all others along lines. Unchanged where none is smooth."""
    if not smooth or t.size <= DEGREE:
        return t, values
    from scipy.interpolate import make_interp_spline

    place, fine = np.arange(t.size), np.arange((t.size - 1) * FINER + 1) / FINER
    at = np.interp(fine, place, t)
    columns = [
        make_interp_spline(t, column, k=DEGREE)(at) if i in smooth else np.interp(at, t, column)
        for i, column in enumerate(values.T)
    ]
    return at, np.column_stack(columns)
