"""Runs of a machine with sampled states: piece by piece, from one sample to the next.

    z(t_k) = next(q, v, z before t_k, u(t_k), t_k),   held until the next sample

All states that are sampled at one instant are sampled at once, from the values before. At an
instant a run has the values after it.
Sizes: N outputs, X states, K samples of the drive, D entries of it, P parameters, S samples.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array, call, on_lines
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.runs.scenario import Scenario

SAME = 1e-9  # of the time between two samples: an output this near to one is at it
# states (N, X), SI, of a piece from a start (X,), why they end early, the method, and a note
Piece = Callable[[Scenario, Array, Array], tuple[Array, str, str, str]]


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """When states of a machine are sampled along a run under ``p`` (P,), SI: ``times`` (S,), s, and
    which of its declared states then (``which``, (S, states))."""

    form: StateForm
    p: Array
    times: Array
    which: NDArray[np.bool_]

    def after(self, t: float, x: Array, d: Array) -> Array:
        """The state (X,) after the sample at ``t`` s, from that before under the drive (D,), SI."""
        where = np.flatnonzero(self.times == t)
        function = self.form.machine.sampled
        if not where.size or function is None:
            return x
        q, v = self.form.motion(x, d)
        first, declared = 2 * len(self.form.free), self.which.shape[1]
        u = d[: self.form.inputs]
        (taken,) = call(function, (q, v, x[first:], u, t, self.p))
        which, after = self.which[where[0]], x.copy()
        after[first : first + declared][which] = taken.reshape(-1)[which]
        return after


def samples_of(form: StateForm, t: Array, p: Array) -> Samples:
    """The samples along output times ``t`` (N,), s, of which one may be the first and the last."""
    states = form.machine.model.states
    found: dict[float, list[int]] = {}
    for i, state in enumerate(states):
        if state.next is None:
            continue
        begin = max(int(np.ceil((t[0] - state.first) / state.every - SAME)), 0)
        end = int(np.floor((t[-1] - state.first) / state.every + SAME))
        times = state.first + state.every * np.arange(begin, end + 1, dtype=np.float64)
        for time in _at_outputs(times, t, SAME * state.every):
            found.setdefault(time, []).append(i)
    times = np.array(sorted(found), dtype=np.float64)
    which = np.zeros((times.size, len(states)), dtype=bool)
    for row, time in enumerate(times.tolist()):
        which[row, found[time]] = True
    return Samples(form, p, times, which)


def _at_outputs(times: NDArray[np.floating], t: Array, reach: float) -> list[float]:
    """Times (S,), s, or the outputs ``t`` (N,) that they mean: those within ``reach``."""
    right = np.minimum(np.searchsorted(t, times), t.size - 1)
    left = np.maximum(right - 1, 0)
    near = np.where(np.abs(t[left] - times) < np.abs(t[right] - times), t[left], t[right])
    found: list[float] = np.where(np.abs(near - times) <= reach, near, times).tolist()
    return found


def sampled_run(
    samples: Samples, scenario: Scenario, drive: Array, start: Array, advance: Piece
) -> tuple[Array, str, str, str]:
    """States (N, X), SI, from ``start`` (X,) along a ``drive`` (K, D), why they end early, the
    method at the end, and a note; ``advance`` integrates from one sample to the next."""
    t, t_u = scenario.t, scenario.t_u

    def at(time: float) -> Array:
        return np.asarray(on_lines(t_u, drive, np.array([time]))[0], dtype=np.float64)

    rows = np.full((t.size, start.size), np.nan)
    now, x = float(t[0]), samples.after(float(t[0]), start, at(float(t[0])))
    rows[0] = x
    reason, method, notes = "", "explicit", dict[str, None]()
    for end in np.union1d(samples.times, t[-1:]).tolist():
        if end <= now:
            continue
        first, last = np.searchsorted(t, [now, end], side="right")
        grid = np.union1d(np.concatenate([[now], t[first:last]]), [end])
        low = max(int(np.searchsorted(t_u, now, side="right")) - 1, 0)
        high = int(np.searchsorted(t_u, end, side="left")) + 1
        part = replace(
            scenario,
            t=grid,
            t_u=t_u[low:high],
            u=scenario.u[low:high],
            given=None if scenario.given is None else scenario.given[low:high],
        )
        states, reason, method, note = advance(part, drive[low:high], x)
        notes[note] = None
        rows[first:last] = states[1 : 1 + last - first]
        if reason:
            break
        now, x = end, samples.after(end, states[-1], at(end))
        if last > first and t[last - 1] == end:
            rows[last - 1] = x
    return rows, reason, method, "; ".join(filter(None, notes))
