"""CasADi functions called on NumPy memory without copies.

CasADi matrices are column-major, so a C-contiguous array (N, rows) is the matrix (rows, N).
"""

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLACK = 1e-6  # of a sample: times this near to one are that one


def call(function: ca.Function, arguments: Sequence[Array | float]) -> tuple[Array, ...]:
    """Evaluate ``function`` with dense outputs; shapes are CasADi's, transposed.

    An argument that CasADi declares as (rows, N) is given as (N, rows) (any shape with as many
    entries in that order), SI; each output (rows, columns) comes back as (columns, rows).

    Raises:
        ValueError: an argument has not as many entries as the function declares.
    """
    buffer, trigger = function.buffer()
    kept = []
    for i, argument in enumerate(arguments):
        dense = np.ascontiguousarray(argument, dtype=np.float64).reshape(-1)
        if dense.size != function.nnz_in(i):
            raise ValueError(
                f"{function.name()}: argument {function.name_in(i)} has {dense.size} entries, "
                f"needs {function.nnz_in(i)}"
            )
        kept.append(dense)
        buffer.set_arg(i, dense.data)  # type: ignore[call-arg]  # the size is taken from the view
    results = []
    for i in range(function.n_out()):
        rows, columns = function.size_out(i)
        result = np.zeros((columns, rows))
        if result.size:
            buffer.set_res(i, result.reshape(-1).data)  # type: ignore[call-arg]
        results.append(result)
    trigger()
    return tuple(results)


def aligned(rows: int, width: int, values: Array | None = None) -> Array:
    """Memory (R, W) for so many rows of so many numbers, each row at a multiple of its size, with
    ``values`` (R, W) or zeros, in any unit."""
    size = width * np.dtype(np.float64).itemsize
    room = np.zeros(rows * size + size, np.uint8)
    begin = -room.ctypes.data % size
    made = room[begin : begin + rows * size].view(np.float64).reshape(rows, width)
    if values is not None:
        made[:] = values
    return made


def later(t: Array, values: Array, delay: float) -> Array:
    """A signal (K,) recorded at times ``t`` (K,), as it is ``delay`` seconds later: values(t −
    delay), held before its first sample and after its last; at delay 0 as recorded.

    Between samples it is Akima's cubic, which follows a smooth signal closer than straight lines
    and rings little at a jump (Akima, J. ACM 17, 1970)."""
    return resampled(t, values, t - delay) if delay else values


def resampled(t: Array, values: Array, at: Array) -> Array:
    """A signal (K,) recorded at times ``t`` (K,), s, at other times (any shape), in its unit."""
    from scipy.interpolate import Akima1DInterpolator

    if t.size < 5:
        return np.asarray(np.interp(at, t, values))
    curve = Akima1DInterpolator(t, values, method="makima")
    return np.asarray(curve(np.clip(at, t[0], t[-1])))


def held_at(t: Array, values: Array, at: Array) -> Array:
    """A signal (K,) that is held from each of the times ``t`` (K,), s, to the next, at other times
    (any shape), in its unit; its first and last value hold outside. Rounding of a time does not
    bring back the value before."""
    return np.asarray(values[_held_since(t, at)])


def _held_since(t: Array, at: Array) -> NDArray[np.int64]:
    """Which sample a held signal has at other times (any shape)."""
    slack = SLACK * float(np.median(np.diff(t))) if t.size > 1 else 0.0
    return np.clip(np.searchsorted(t, at + slack, side="right") - 1, 0, t.size - 1)


def held_line(t: Array, values: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    """The straight line over each step from ``begin`` to ``end`` (S,), s, end > begin, that has the
    impulse of the same signal u and its first moment, ∫(end − s)·u ds, so that a mass that it
    pushes has the right speed and the right place at the end. Its values at both ends (2, S), in
    the unit of the signal, and the slopes (2, S) of these, per s, by a shift of the step.

        one jump Δ at the share f of the step:   mean ∓ 3 Δ f (1 − f)
    """
    first, then = _held_since(t, begin), _held_since(t, end)
    h, stood = end - begin, values[first]
    mean, moment = stood.astype(float), np.full(h.shape, 0.5) * stood
    for jump in range(1, int((then - first).max(initial=0)) + 1):
        k = np.minimum(first + jump, t.size - 1)
        left = np.where(jump <= then - first, end - t[k], 0.0) / h
        change = values[k] - values[k - 1]
        mean, moment = mean + change * left, moment + 0.5 * change * left**2
    tilt = 6 * mean - 12 * moment
    rise = (values[then] - stood) / h
    turn = (12 * (mean - stood)) / h - 6 * rise
    sides = np.array([[-0.5], [0.5]])
    return mean + sides * tilt, rise - sides * turn


def on_line(t: Array, values: Array, at: Array) -> Array:
    """A signal (K,) recorded at times ``t`` (K,), s, along straight lines to other times (N,)."""
    return np.asarray(np.interp(at, t, values))


def on_lines(t: Array, columns: Array, at: Array) -> Array:
    """Signals (K, D) recorded at times ``t`` (K,), s, at the times ``at`` (N,) by first-order hold:
    (N, D) in their units."""
    held = [on_line(t, column, at) for column in columns.T]
    return np.column_stack(held) if held else np.empty((at.size, 0))


def mean_of_seen(values: Array, axis: int = 0) -> Array:
    """The mean of ``values`` (N, …) along an ``axis``, in their unit, missing ones (NaN) left out;
    NaN where all are missing."""
    seen = ~np.isnan(values)
    count = seen.sum(axis=axis)
    total = np.where(seen, values, 0.0).sum(axis=axis)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))
