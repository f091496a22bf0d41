"""A signal behind a play, with its slopes: what is driven rests while the driver turns back.

           y ^      ___        y = min(max(y, u − b/2), u + b/2)   from what y was before,
             |     /  /        b is the width of the play
             |    /  /
             |___/__/          up along the right line, down along the left one
             +---|b|----▶ u

The play operator (Krasnosel'skii & Pokrovskii, Systems with Hysteresis, 1989, §2). Along lines it
rests or follows, and where it begins to follow its slopes jump. It begins in the middle.
Sizes: K times, B numbers by which slopes are asked for.
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.jit import jitted

JUMP = 1e-9  # of a sample: how long slopes take to jump
ROUNDED = 1e-14  # of a signal: so near an end of the play is at it


def with_backlash(
    t: Array, columns: Array, width: float, held: bool, own: int | None
) -> tuple[Array, Array]:
    """Times ``t`` (K,), s, and columns (K, 1 + B), the signal in its unit and its slopes, behind a
    play of a ``width``, with two times more wherever it begins to follow a line that is not
    ``held``; ``own`` is the column of the slope by the width."""
    if not held:
        t, columns = _with_grips(t, columns, width)
    sides, source = _gripped(columns[:, 0], width)
    made = columns[source]  # while it rests, the slopes of where it stopped
    made[:, 0] -= 0.5 * width * sides
    if own is not None:
        made[:, own] -= 0.5 * sides
    return t, made


def _gripped(u: Array, width: float) -> tuple[Array, NDArray[np.int64]]:
    """On which side of the play each value (K,) is: 1 pushed up, −1 down, 0 before either; and at
    which time it last followed."""
    slack = ROUNDED * (width + float(np.abs(u).max()))
    sides, source = np.zeros(u.size), np.zeros(u.size, dtype=np.int64)
    _grip(np.ascontiguousarray(u), 0.5 * width, slack, sides, source)
    return sides, source


@jitted
def _grip(u: Array, half: float, slack: float, sides: Array, source: NDArray[np.int64]) -> None:
    """Write the side and when it last followed for every value."""
    y, side, last = u[0], 0.0, 0
    for i in range(u.size):
        if u[i] - half >= y - slack:
            y, side, last = u[i] - half, 1.0, i
        elif u[i] + half <= y + slack:
            y, side, last = u[i] + half, -1.0, i
        sides[i] = side
        source[i] = last


def _with_grips(t: Array, columns: Array, width: float) -> tuple[Array, Array]:
    """Times and columns with two times more where the play ends between two times: right before
    that it rests."""
    u = columns[:, 0]
    sides, source = _gripped(u, width)
    y = u[source] - 0.5 * width * sides
    i = 1 + np.flatnonzero((sides[1:] != sides[:-1]) | (np.diff(source) > 1))
    edge = y[i - 1] + 0.5 * width * sides[i]  # where u ends the play
    share = (edge - u[i - 1]) / (u[i] - u[i - 1])
    inside = (share > 0) & (share < 1)
    i, edge = i[inside], edge[inside]
    at = t[i - 1] + (t[i] - t[i - 1]) * share[inside]
    before = at - JUMP * float(np.median(np.diff(t)))
    times = np.concatenate([t, before, at])
    order = np.argsort(times, kind="stable")
    found = np.column_stack([np.interp(times, t, column) for column in columns.T])
    found[t.size + i.size :, 0] = edge
    return times[order], found[order]
