"""What drives an exact run, and its functions under that drive.

Sizes: K samples of the drive, D entries of it, X states, P parameters, F frictions, S sides of
stops.
"""

from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

import numpy as np

from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True)
class Drive:
    """Inputs and given motion: values ``d`` (K, D), SI, at times ``t`` (K,), s, and linear
    between."""

    t: Array
    d: Array

    def at(self, t: float) -> Array:
        """The drive (D,) at one time in s, SI."""
        if self.d.shape[1] == 0:
            return np.asarray(self.d[0], dtype=np.float64)
        i = min(max(bisect_right(self.t, t) - 1, 0), self.t.size - 2)
        share = (t - self.t[i]) / (self.t[i + 1] - self.t[i])
        return np.asarray(self.d[i] + share * (self.d[i + 1] - self.d[i]), dtype=np.float64)


class Ready:
    """A function of (x, d, t, p, mode), called many times on memory that stays."""

    def __init__(self, function: Any, drive: Drive, p: Array):
        sizes = [function.nnz_in(i) for i in range(function.n_in())]
        self._given = [np.zeros(size) for size in sizes]
        self._given[3][:] = p
        self._drive, self._moves = drive, bool(drive.d.shape[1])
        rows, columns = function.size_out(0)
        self._result = np.zeros((columns, rows))
        self._buffer, self._trigger = function.buffer()
        for i, array in enumerate(self._given):
            self._buffer.set_arg(i, array.data)
        if self._result.size:
            self._buffer.set_res(0, self._result.reshape(-1).data)

    def mode(self, mode: Array) -> "Ready":
        """The same under another mode (2F + 2S,), SI."""
        self._given[4][:] = mode
        return self

    def __call__(self, t: float, y: Array) -> Array:
        """The result (rows,) or (columns, rows) at time t in s and y, whose first X numbers are
        the state, SI."""
        self._given[0][:] = y[: self._given[0].size]
        self._given[2][0] = t
        if self._moves:
            self._given[1][:] = self._drive.at(t)
        self._trigger()
        result: Array = self._result[0] if len(self._result) == 1 else self._result
        return result.copy()
