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
from symhyb.numeric.buffers import Array

FINER = 8  # points of a smooth input for one sample: lines between them cut 64 times less
DEGREE = 5  # of the spline


def smooth_columns(inputs: Sequence[Input]) -> tuple[int, ...]:
    """Which inputs of a model are smooth between samples."""
    return tuple(i for i, item in enumerate(inputs) if item.between == "smooth")


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
