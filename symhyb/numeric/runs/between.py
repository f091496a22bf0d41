"""How recorded inputs run between their samples: as straight lines, as smooth signals, or held.

A generator whose converter is followed by a low-pass (band-limited excitation) leaves a signal that
is smooth between samples, and with few samples a period a straight line cuts its corners: a sine of
f Hz sampled every h s loses (π f h)²/3 of its size. The quintic spline through the samples loses
less than a hundredth of that up to a third of the sampling rate. The output of a digital controller
holds each sample until the next: a straight line is half a sample ahead of it.
Sizes: K samples, k inputs.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.judgement import MOST
from symhyb.model.types import Input
from symhyb.numeric.kernels.buffers import SLACK, Array, held_at

FINER = 8  # points of a smooth input for one sample: lines between them cut 64 times less
DEGREE = 5  # of the spline
FEWEST = 32  # samples that tell
RAMP, ULPS = 1e-9, 16  # of a sample: as long as a jump takes at most, but some roundings of time


def smooth_columns(inputs: Sequence[Input]) -> tuple[int, ...]:
    """Which inputs of a model are smooth between samples."""
    return tuple(i for i, item in enumerate(inputs) if item.between == "smooth")


def held_columns(inputs: Sequence[Input]) -> tuple[int, ...]:
    """Which inputs of a model hold each sample until the next."""
    return tuple(i for i, item in enumerate(inputs) if item.between == "held")


def bent_columns(inputs: Sequence[Input]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Which inputs of a model are smooth between samples, and which are held."""
    return smooth_columns(inputs), held_columns(inputs)


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
    return missed[0] < MOST**2 * missed[1]


def finer(
    t: Array, values: Array, smooth: Sequence[int], held: Sequence[int] = ()
) -> tuple[Array, Array]:
    """Signals (K, c) at times ``t`` (K,), s, on a grid ``FINER`` times as fine: the columns
    ``smooth`` along quintic splines, those ``held`` held, all others along lines. Unchanged where
    none is smooth."""
    if not smooth or t.size <= DEGREE:
        return t, values
    from scipy.interpolate import make_interp_spline

    place, fine = np.arange(t.size), np.arange((t.size - 1) * FINER + 1) / FINER
    at = np.interp(fine, place, t)
    last = np.floor(fine).astype(int)

    def column(i: int) -> Array:
        if i in held:
            return np.asarray(values[last, i])
        if i in smooth:
            return np.asarray(make_interp_spline(t, values[:, i], k=DEGREE)(at))
        return np.interp(at, t, values[:, i])

    return at, np.column_stack([column(i) for i in range(values.shape[1])])


def stepped(t: Array, values: Array, held: Sequence[int]) -> tuple[Array, Array]:
    """Signals (K, c) at times ``t`` (K,), s, of which the columns ``held`` hold each value until
    the next time, as lines between more times: right before a jump there is one more."""
    columns = list(held)
    jumps = 1 + np.flatnonzero(np.any(np.diff(values[:, columns], axis=0) != 0, axis=1))
    if not jumps.size:
        return t, values
    step = t[jumps] - t[jumps - 1]
    ramp = np.minimum(np.maximum(RAMP * step, ULPS * np.spacing(np.abs(t[jumps]))), step / 2)
    before = values[jumps] - (ramp / step)[:, None] * (values[jumps] - values[jumps - 1])
    before[:, columns] = values[jumps - 1][:, columns]
    return np.insert(t, jumps, t[jumps] - ramp), np.insert(values, jumps, before, axis=0)


def with_jumps(
    t: Array, values: Array, held: Sequence[int], delays: Sequence[float]
) -> tuple[Array, Array]:
    """Signals (K, c) as recorded at times ``t`` (K,), s, and as they act: the columns ``held``
    later by ``delays`` (c,) s, at the times at which they then jump, too. All others act already,
    and run along lines to the new times."""
    late = [delays[i] for i in held if delays[i]]
    if not late:
        return t, values
    jumps = np.concatenate([t + delay for delay in late])
    inside = jumps[(jumps > t[0]) & (jumps < t[-1])]
    at = np.union1d(t, inside)
    apart = np.diff(at, prepend=-np.inf) > SLACK * np.median(np.diff(t))
    at = at[apart | np.isin(at, t)]
    columns = [
        held_at(t, column, at - delays[i]) if i in held else np.interp(at, t, column)
        for i, column in enumerate(values.T)
    ]
    return at, np.column_stack(columns)
