"""Where in a step something that is watched falls through zero.

A step is looked at in a few places of its dense output, and between them where a parabola through
three looks may lie below zero, so that a short excursion is not missed. W things are watched.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import brentq

from symhyb.exact.switched import TINY
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.explicit_source import DIPS, LOOKS

INSIDE = np.linspace(0.0, 1.0, LOOKS + 1)  # of a step: where it is looked for events
ROUNDING = 8 * np.finfo(float).eps

Watch = Callable[[float, Array], Array]


def first_crossing(
    watch: Watch, dense: Any, solver: Any, before: Array
) -> tuple[float, list[int], Array]:
    """Where in the last step of a solver something first falls through zero, in s (else its end),
    what crosses there, and what is watched at its end. ``before`` (W,) was watched at its start, in
    the SI units of what is watched."""
    times = solver.t_old + INSIDE * (solver.t - solver.t_old)
    states = dense(times[1:])
    seen = [watch(t, y) for t, y in zip(times[1:].tolist(), states.T, strict=True)]
    values = np.array([before, *seen])
    lowest = values[1:].min(axis=0) if values.size else values[0]
    if not np.all(lowest > 0) or _dips(values):
        times, values = _with_dips(watch, dense, times, values)
        crossings = [
            (*_crossing(watch, dense, times, values[:, k], k), k) for k in range(before.size)
        ]
        found = [(t, k) for t, crosses, k in crossings if crosses]
        if found:
            first = min(t for t, _ in found)
            near = first + ROUNDING * max(abs(first), solver.t - solver.t_old)
            return first, [k for t, k in found if t <= near], seen[-1]
    return float(solver.t), [], seen[-1]


def _lowest(values: Array) -> Array:
    """The least values of parabolas through three looks each, where they are lowest in the middle;
    else what was seen. (looks − 2, watches), in the units of the watches, SI."""
    left, middle, right = values[:-2], values[1:-1], values[2:]
    bend, slope = left - 2 * middle + right, (right - left) / 2
    dips = (middle <= left) & (middle <= right) & (bend > 0)
    return np.where(dips, middle - slope**2 / (2 * np.where(dips, bend, 1.0)), middle)


def _dips(values: Array) -> bool:
    lowest = _lowest(values)
    return bool(np.any(lowest < DIPS * values[1:-1]))


def _with_dips(watch: Watch, dense: Any, times: Array, values: Array) -> tuple[Array, Array]:
    """The looks, and one more at each minimum between them that may be below zero."""
    lowest = _lowest(values)
    rows, columns = np.nonzero((lowest < DIPS * values[1:-1]) & (values[1:-1] > 0))
    more = []
    for i, k in zip(rows.tolist(), columns.tolist(), strict=True):
        left, middle, right = values[i : i + 3, k]
        share = (left - right) / (2 * (left - 2 * middle + right))
        more.append(times[i + 1] + share * (times[1] - times[0]))
    if not more:
        return times, values
    added = [watch(t, dense(t)) for t in more]
    order = np.argsort([*times, *more], kind="stable")
    return np.array([*times, *more])[order], np.array([*values, *added])[order]


def _crossing(watch: Watch, dense: Any, times: Array, values: Array, k: int) -> tuple[float, bool]:
    """When watch ``k`` falls through zero, and whether it does. What begins at zero (a friction
    that has just begun to slide) falls only if it is below zero from there on."""
    above = np.flatnonzero(values > 0)
    if above.size == 0:
        return float(times[0]), bool(values.min() < 0)
    below = np.flatnonzero(values[above[0] :] <= 0)
    if below.size == 0:
        return 0.0, False
    later = int(above[0] + below[0])
    if values[later] == 0.0 or values[later - 1] <= TINY:  # flat at 0, to or from there
        return _edge(lambda t: watch(t, dense(t))[k], times[later - 1], times[later]), True
    found = brentq(
        lambda t: watch(t, dense(t))[k],
        times[later - 1],
        times[later],
        xtol=1e-300,
        rtol=4 * np.finfo(float).eps,
    )
    return float(found), True


def _edge(value: Callable[[float], float], above: float, below: float) -> float:
    """The first time from which on ``value`` is not positive, by halving, s: it is where this time
    says, not a rounding before."""
    middle = (above + below) / 2
    while above < middle < below:
        above, below = (middle, below) if value(middle) > 0 else (above, middle)
        middle = (above + below) / 2
    return float(below)
