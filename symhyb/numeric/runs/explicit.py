"""Whole runs by an explicit Runge–Kutta method in machine code, where a C compiler is found.

The rates of a machine are an instruction list. The integrator, compiled once for all machines, runs
it as it is; when it has run one for longer than compiling takes, the rates are compiled too, in the
middle of a run as well. Both ways give the same numbers, so that nothing but the time depends on
what was run before.
Steps end where the drive changes its slope, which is what a restart at every sample is: a method
of one step begins anew at no cost.
Sizes: N outputs, X states, K samples of the drive, P parameters.

Source: Hairer, Nørsett & Wanner, Solving ODEs I, DOP853 (see :mod:`~.dormand_prince`).
"""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.compiled import find_compiler, library_of
from symhyb.numeric.kernels.instructions import NOTHING, Program, program
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.constrained import PULL
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.runs.dormand_prince import SLOPES
from symhyb.numeric.runs.explicit_call import POINTER, List, Task
from symhyb.numeric.runs.explicit_source import WORK, integrator_code, machine_code

STEPS_PART = 100  # a run has at least so many steps: what happens briefly is not stepped over
COMPILING, COMPILING_EACH = 50_000_000, 50_000  # what compiling costs, in instructions run
INSTRUCTIONS_MOST = 20_000  # above, compiling takes minutes
STABLE = 3.0  # a decay times the longest step; twice that is stable
COLLINEAR = 1e-12  # of the range of a drive: a bend that is rounding
GROWTH = "growth without bound"
STIFF = "stiff"
PAUSE = "a pause"
REASONS = (
    "",
    "more steps than allowed",
    "a step of no length",
    GROWTH,
    "a full tape",
    "something watched may have fallen through zero",
    STIFF,
    PAUSE,
)
NEVER = 1 << 62
Weigh = Callable[[float, float, Array], float]


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Relative, and absolute for each state (X,), SI; the ``bound`` (X,) of a sound state, SI;
    and how many steps may be tried: a tenth of them at first, all of them by the end."""

    relative: float
    absolute: Array
    bound: Array
    steps: int


@dataclass(frozen=True, slots=True)
class Steps:
    """States (N, X), SI, NaN from where the run stopped, with its ``reason``; how many steps were
    accepted and rejected, and how often the rates were evaluated; the largest size of each state
    at the end of a step, ``reach`` (X,), SI; where it stopped, at ``t`` s in the state ``last``
    (X,), SI."""

    x: Array
    reason: str
    reach: Array
    accepted: int
    rejected: int
    evaluations: int
    t: float
    last: Array


class Tape:
    """Room for the steps of a run: the states of their stages, where they began and ended, how
    long they were, and which outputs lie in them. One run at a time."""

    def __init__(self, steps: int, states: int):
        self.steps = steps
        self.stages = np.empty((steps, SLOPES, states))
        self.times, self.places = np.empty((steps, 3)), np.empty((steps, 3), np.int64)


class Desk:
    """What the integrator works on: a task for it, and the arrays that the task points to.

    Outputs at ``t`` (N,) go to ``rows`` (N, X), from ``start`` (X,) at ``t[0]``; the drive runs
    straight between ``nodes``, times (K,) and values (K, drive); SI. ``count``: rows written, steps
    accepted and rejected, evaluations, stiff steps and others since; ``reach`` (X,): largest sizes;
    ``place``: where the last step began and ended, its length, and how long the next wishes to be,
    all in s."""

    def __init__(
        self,
        t: Array,
        start: Array,
        nodes: tuple[Array, Array],
        limits: Tolerances,
        rows: Array,
        tape: Tape | None = None,
    ):
        given: list[NDArray[Any]] = [
            np.ascontiguousarray(a, float)
            for a in (*nodes, t, limits.absolute, limits.bound, start)
        ]
        self.count, self.reach = np.zeros(6, np.int64), np.zeros(start.size)
        self.place, self.work = np.zeros(4), np.zeros((WORK, start.size))
        drive = np.zeros(nodes[1].shape[1] + 1)
        given += [rows, self.work, drive, self.reach, self.count, self.place]
        taped = [] if tape is None else [tape.stages, tape.times, tape.places]
        addresses = [a.ctypes.data for a in (*given, *taped)] + [None] * (3 - len(taped))
        self._alive = given
        self.task = Task(
            start.size,
            nodes[1].shape[1],
            nodes[0].size,
            t.size,
            limits.steps,
            limits.relative,
            float(t[-1] - t[0]) / STEPS_PART or 1.0,
            *addresses,
            0 if tape is None else tape.steps,
            float(t[0]),
            float(t[-1]),
            0.0,
            1,
            pause=NEVER,
        )


@dataclass(frozen=True, slots=True)
class Prepared:
    """Rates for certain parameters: the function as C calls it, its memory, what must stay alive
    with it, and the integrator for these rates alone, if they are compiled."""

    rate: POINTER
    memory: POINTER
    alive: Any
    own: ctypes.CDLL | None = None


class Field:
    """The rates x' of a machine, ready to be integrated; any number of threads may do so."""

    def __init__(self, code: Program, library: ctypes.CDLL):
        self.code, self._library = code, library
        self._same = code.invariant(frozenset({3}))
        self._own: ctypes.CDLL | None = None
        self._tried, self._done = False, 0  # instructions run so far
        self._arrays = _lists(code, self._same)

    def integrate(
        self,
        t: Array,
        start: Array,
        p: Array,
        nodes: tuple[Array, Array],
        limits: Tolerances,
        tape: "Tape | None" = None,
        longest: float = np.inf,
        suspect: float = 0.0,
        weigh: Weigh = lambda t, h, x: 0.0,
    ) -> Steps:
        """States at ``t`` (N,) from ``start`` (X,) at ``t[0]``, with parameters ``p`` (P,) and a
        drive that runs straight between ``nodes``, times (K,) and values (K, drive), in steps that
        are at most ``longest`` s; SI. They are written down on the ``tape``, if there is one.

        Where the equations are stiff and steps shorter than ``suspect`` s, ``weigh`` gets the time
        , the length of a step and the state (X,), SI. The run goes on with what it returns in
        the place of ``suspect``, and ends there if that is 0."""
        rows = np.full((t.size, start.size), np.nan)
        desk = Desk(t, start, nodes, limits, rows, tape)
        desk.task.longest, desk.task.suspect = min(desk.task.longest, longest), suspect
        while True:
            ready = self.prepared(p)
            desk.task.pause = NEVER if self._tried else int(desk.count[3]) + self._until_compiled()
            reason = REASONS[self.advance(desk, ready)]
            at, step = desk.place[1:3].tolist()
            last = desk.work[int(reason == GROWTH)].copy()
            if reason == STIFF:
                desk.task.suspect = weigh(at, step, last)
            if reason != PAUSE and not (reason == STIFF and desk.task.suspect):
                break
            desk.task.resumed = 1
        done, accepted, rejected, evaluations = (int(number) for number in desk.count[:4])
        rows[done:] = np.nan
        return Steps(rows, reason, desk.reach, accepted, rejected, evaluations, at, last)

    def advance(self, desk: Desk, ready: Prepared) -> int:
        """Integrate the task of a workspace; how it ended, a place in ``REASONS``."""
        task, before = ctypes.byref(desk.task), int(desk.count[3]) if desk.task.resumed else 0
        if ready.own is None:
            status = self._library.integrate(ready.rate, ready.memory, task)
        else:
            status = ready.own.integrate(ready.memory, task)
        self.count(int(desk.count[3]) - before)
        return int(status)

    def _until_compiled(self) -> int:
        """How many evaluations are left until compiling pays."""
        size = max(len(self.code.steps), 1)
        return max((COMPILING + COMPILING_EACH * size - self._done) // size, 0) + 1

    def count(self, evaluations: int) -> None:
        """So many evaluations were run: what runs long is compiled."""
        self._done += evaluations * len(self.code.steps)

    def along(self, t: Array, x: Array, d: Array, p: Array) -> Array:
        """The function itself at N points: times ``t`` (N,), ``x`` (N, X), ``d`` (N, drive), and
        parameters ``p`` (P,) that are the same for all; SI, (N, results)."""
        made = np.zeros((t.size, self.code.results[0]))
        width = np.array([x.shape[1], d.shape[1], made.shape[1]], np.int64)
        ready = self.prepared(p)
        given = [np.ascontiguousarray(a, float) for a in (t, x, d)]
        self._library.rows(
            ready.rate,
            ready.memory,
            ctypes.c_longlong(t.size),
            *(address(a) for a in (width, *given, made)),
        )
        return made

    @property
    def compiled(self) -> bool:
        """Whether the rates themselves are machine code."""
        return self._own is not None

    def compile(self) -> bool:
        """Compile the rates, if that was not done before; False if there is no way to."""
        if not self._tried:
            self._tried = True
            if len(self.code.steps) <= INSTRUCTIONS_MOST:
                self._own = _library(machine_code(self.code))
        return self._own is not None

    def prepared(self, p: Array) -> Prepared:
        """The rates for parameters ``p`` (P,), SI; compiled, once they have run so long that it
        pays."""
        if self._done > COMPILING + COMPILING_EACH * len(self.code.steps):
            self.compile()
        own, p = self._own, np.ascontiguousarray(p, float)
        if own is not None:
            held = np.zeros(own.held() + 1)
            own.prepare(address(p), address(held))
            return Prepared(ctypes.cast(own.rate, POINTER), address(held), held, own)
        before, inside, loads, stores, constants, fixed = self._arrays
        slots = np.zeros(self.code.size + 1)
        slots[constants[:, 0].astype(int)] = constants[:, 1]
        slots[fixed[:, 0]] = p[fixed[:, 1]]
        self._library.execute(ctypes.c_longlong(len(before)), address(before), address(slots))
        listed = List(
            slots.ctypes.data,
            *(a.ctypes.data for a in (inside, loads, stores)),
            len(inside),
            len(loads),
            len(stores),
            self.code.results[0],
        )
        memory = ctypes.cast(ctypes.byref(listed), POINTER)
        return Prepared(ctypes.cast(self._library.interpret, POINTER), memory, (slots, listed))


def field(form: StateForm) -> Field | None:
    """The rates of a machine for the explicit method; None without a compiler that works, or for
    rates that are not made of scalar operations."""
    if not integrator_works():
        return None

    def made() -> Field | None:
        return field_of(rates_of(form)) if form.rates().is_a("SXFunction") else None

    return kept(("field", form.key), made)


def integrator_works() -> bool:
    """Whether there is a C compiler, and it compiles."""
    return _library(integrator_code()) is not None


def longest_step(form: StateForm) -> float:
    """What no step of an explicit run may exceed, s: stabilised constraints decay within a tenth of
    a second, and where a step barely follows that, outputs between its ends do not."""
    return STABLE / PULL if form.machine.constraints else np.inf


def compiler_fails() -> str:
    """A sentence if there is a C compiler that does not compile; else empty."""
    compiler = find_compiler()
    if compiler is None or integrator_works():
        return ""
    return (
        f"the C compiler {Path(compiler[0]).name} could not compile, or the cache folder cannot be "
        "used; integrated without it (SYMHYB_CC names another, or none)"
    )


def bends(t: Array, drive: Array) -> tuple[Array, Array]:
    """The samples of a drive (K, drive) at times ``t`` (K,) between which it runs straight, SI."""
    if t.size < 3 or drive.shape[1] == 0:
        return t[[0, -1]], drive[[0, -1]]
    share = ((t[1:-1] - t[:-2]) / (t[2:] - t[:-2]))[:, None]
    off = np.abs(drive[1:-1] - drive[:-2] - share * (drive[2:] - drive[:-2]))
    bent = np.any(off > COLLINEAR * np.ptp(drive, axis=0), axis=1)
    chosen = np.concatenate([[True], bent, [True]])
    return t[chosen], drive[chosen]


def field_of(function: ca.Function) -> Field | None:
    """Any function (x, d, t, p) -> x' made of scalar operations, as :func:`field`."""
    library, code = _library(integrator_code()), program(function)
    if library is None or code is None:
        return None
    return Field(code.divided_once(frozenset({3})), library)


def rates_of(form: StateForm) -> ca.Function:
    """(x, d, t, p) -> x' (X,), the rates of all states."""
    x, d, t, p, w = form.symbols()
    f = len(form.free)
    slopes = ca.vertcat(x[f : 2 * f, 0], form.rates()(x, d, t, p, ca.SX.zeros(w.numel())))
    return ca.Function("field", [x, d, t, p], [ca.densify(slopes)], {"cse": True})


def _lists(code: Program, same: tuple[bool, ...]) -> tuple[NDArray[Any], ...]:
    """Steps before and inside a run, loads, stores, constants and loads of parameters."""

    def rows(some: list[tuple[int, ...]], width: int) -> NDArray[np.int32]:
        return np.array(some, dtype=np.int32).reshape(-1, width)

    steps = [(o, v, left, left if right == NOTHING else right) for v, o, left, right in code.steps]
    return (
        rows([step for step in steps if same[step[1]]], 4),
        rows([step for step in steps if not same[step[1]]], 4),
        rows([load for load in code.loads if load[1] != 3], 3),
        rows([(value, entry) for _, entry, value in code.stores], 2),
        np.array(code.constants, dtype=float).reshape(-1, 2),
        rows([(value, entry) for value, argument, entry in code.loads if argument == 3], 2),
    )


def address(values: NDArray[Any]) -> POINTER:
    """Where an array of any shape (N,) and unit lies, for C."""
    return values.ctypes.data_as(POINTER)


@lru_cache(maxsize=200)
def _library(code: str) -> ctypes.CDLL | None:
    """Compiled code, loaded; None where that is impossible."""
    library = library_of(code)
    if library is None:
        return None
    if "long long held" in code:
        library.held.restype = ctypes.c_longlong
        library.prepare.restype = None
        library.integrate.argtypes = (POINTER,) * 2
    else:
        library.execute.restype = None
        library.integrate.argtypes = (POINTER,) * 3
        library.rows.restype = None
    return library
