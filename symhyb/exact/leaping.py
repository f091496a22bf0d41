"""Steps in machine code from one step in which something may switch to the next.

In most steps of an exact run nothing switches. The explicit method in machine code
(:mod:`symhyb.numeric.runs.explicit`) looks into its own steps, as :mod:`~.crossings` does, and
comes back where something watched is not clearly above zero, with that step undecided. A watched
step is used as a solver of ``scipy.integrate`` is.
Sizes: N outputs, Y states of the integration, P parameters with the modes behind them, W watches.
"""

import operator
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate

import casadi as ca
import numpy as np

from symhyb.exact.switched import Held, Switched
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.runs.explicit import (
    REASONS,
    Desk,
    Field,
    Tolerances,
    field_of,
    integrator_works,
)
from symhyb.numeric.runs.explicit_source import CURVE, CURVE_AT, LOOKS

DONE, TIRED, NO_STEP, GROWN, _, WATCHED = range(len(REASONS))[:6]  # how the integrator ends
WIDER = 2.0  # what has grown so many times asks for another absolute tolerance


@dataclass(frozen=True, slots=True)
class Fields:
    """Rates (Y,) and watches (W,) of a switched machine for the explicit method, SI."""

    rates: Field
    watch: Field


def fields(machine: Switched, held: Held) -> Fields | None:
    """Both while the frictions ``held`` hold; None without a compiler that works."""

    def make() -> Fields | None:
        rates = field_of(_joined(machine.rates(held), len(machine.frictions)))
        watch = field_of(_joined(machine.watch(held), len(machine.frictions)))
        return None if rates is None or watch is None else Fields(rates, watch)

    return kept(("switched field", machine.structure, held), make) if integrator_works() else None


def _joined(function: ca.Function, forces: int) -> ca.Function:
    """(x, d, t, p, mode) as (x with the integrals of forces behind it, d, t, p with mode)."""
    x, d, t, p, mode = (function.sx_in(i) for i in range(5))
    y, given = ca.vertcat(x, ca.SX.sym("lasting", forces)), ca.vertcat(p, mode)
    return ca.Function("joined", [y, d, t, given], [function(x, d, t, p, mode)], {"cse": True})


class Leap:
    """Watched steps under one mode, with parameters ``p`` (P,), SI. Outputs that lie in them are
    written.

    ``outputs`` are times (N,), s, and rows (N, Y), SI; ``row`` is the next of them. ``y`` (Y,), SI,
    is the state at ``t``, where it stands; ``undecided``: whether something may have switched since
    ``t_old``, when the state was ``y_old``, and outputs from there on are still to be written.
    ``atol`` (Y,) is the absolute tolerance, and sizes beyond ``bound`` (Y,) end a step, SI;
    ``taken`` steps and ``written`` rows are those of the last call; ``step_size`` in s.
    """

    t: float
    t_old: float
    y: Array
    y_old: Array
    row: int
    atol: Array
    bound: Array
    step_size: float | None
    status: str
    undecided: bool
    taken: int
    written: int

    def __init__(
        self,
        both: Fields,
        nodes: tuple[Array, Array],
        p: Array,
        outputs: tuple[Array, Array],
        relative: float,
        longest: float,
        steps: int,
    ):
        self._rates, self._ready = both.rates, both.rates.prepared(p)
        size = outputs[1].shape[1]
        self._start, self._absolute, self._bound = np.zeros(size), np.zeros(size), np.zeros(size)
        limits = Tolerances(relative, self._absolute, self._bound, steps)
        self._desk = Desk(outputs[0], self._start, nodes, limits, outputs[1])
        self._outputs = outputs[0]
        task, watches = self._desk.task, both.watch.code.results[0]
        self._at, self._length = (task.t, task.x), 0.0
        self._seen = np.zeros((LOOKS + 1, max(watches, 1)))
        self._watch = watch = both.watch.prepared(p)
        task.watch, task.watch_memory, task.watches = watch.rate, watch.memory, watches
        task.seen, task.row, task.longest = self._seen.ctypes.data, 0, longest

    def begin(
        self,
        span: tuple[float, float],
        row: int,
        y: Array,
        size: Array,
        atol: Array,
        first: float | None,
    ) -> "Leap":
        """Stand at ``span[0]`` in ``y`` (Y,), on the way to ``span[1]``, s, with steps that begin
        ``first`` s long; sizes and absolute tolerances (Y,), SI."""
        (self.t, end), self.t_old, self.row = span, span[0], row
        self.y, self.y_old, self.step_size = y, y, first
        self.status, self.undecided, self.taken, self.written = "running", False, 0, 0
        self._desk.task.end = end
        self._last = int(np.searchsorted(self._outputs, end, side="right"))
        self.follow(size, atol)
        return self

    def follow(self, size: Array, atol: Array) -> None:
        """Another absolute tolerance (Y,), for a motion of this ``size`` (Y,), SI."""
        self.atol, self.bound = atol, WIDER * size

    def step(self) -> str | None:
        """On to the next step that is to be looked into, or where the absolute tolerance is to
        follow the motion, or to the end; why it failed, if it did, as SciPy says it."""
        task, desk = self._desk.task, self._desk
        self._start[:], self._absolute[:], self._bound[:] = self.y, self.atol, self.bound
        task.begin, task.first = self.t, self.step_size or 0.0
        task.t, task.x = self._at[0] + 8 * self.row, self._at[1] + 8 * self.row * self.y.size
        task.outputs = self._last - self.row
        how = self._rates.advance(desk, self._ready)
        self.written, self.taken = int(desk.count[0]), int(desk.count[1] + desk.count[2])
        if how == TIRED:
            self.undecided = False
            return None
        if how not in (DONE, GROWN, WATCHED):
            self.status, self.t = "failed", float(desk.place[0])
            return "spacing" if how == NO_STEP else None
        self.t_old, self.t, self._length, self.step_size = desk.place.tolist()
        self.y_old, self.y = desk.work[0].copy(), desk.work[1].copy()
        self.undecided = how == WATCHED
        if self.t >= task.end:
            self.status = "finished"
        return None

    def dense_output(self) -> Callable[[Array | float], Array]:
        """The states at times t in the last step, s: (Y,) at one, (Y, T) at many, SI."""
        begun, length, before = self.t_old, self._length, self.y_old
        curve = self._desk.work[CURVE_AT : CURVE_AT + CURVE].copy()

        def dense(t: Array | float) -> Array:
            s = (t - begun) / length
            z = 1 - s
            weights = list(accumulate([s, z, s, z, s, z, s], operator.mul))
            return (before + np.array(weights).T @ curve).T

        return dense
