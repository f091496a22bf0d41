"""Exact simulation: dry friction that holds, stops that touch and jumps that the model file writes,
every transition located.

Between two events the equations are smooth. They are integrated by DOP853 (in machine code where
there is a C compiler; Radau IIA where the machine is stiff), and what may switch is watched inside
every step; where it crosses zero, the root is located on the dense output, the modes are settled
anew (:mod:`symhyb.exact.settling`) and the integration begins again. Forces that hold are
integrated beside the states, so that a machine at rest is not stepped over. Inputs act by
first-order hold; jumps are restarts.

Source: Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, 1993, sections II.5,
II.6 (through ``scipy.integrate``).
"""

from collections import deque
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import DOP853, Radau

from symhyb.exact.crossings import ROUNDING, first_crossing
from symhyb.exact.driven import Drive, Ready
from symhyb.exact.leaping import Leap, fields
from symhyb.exact.reasons import GROWN, chatters, failure, tired
from symhyb.exact.settling import (
    Instant,
    Modes,
    after,
    first_modes,
    resampled,
    returned,
    transitions,
)
from symhyb.exact.switched import Held, Switched
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array, call, on_lines
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.runs.explicit import bends
from symhyb.numeric.runs.sampled import Samples
from symhyb.numeric.runs.scenario import Event

RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-12  # of the largest size of each state so far
SMALLER = 1e-4  # of the largest place (or speed) of all: what moves less is resolved as if it did
SIZE_LEAST = 1e-4  # SI: at 1 µm accuracy is still 1e-10 of it; below it lies rounding
LOOSER = 1e6  # for the integrals of forces that hold: they only see that no load is missed
AT_ONCE, APART = 64, 1e-12  # events in a row that lie closer (of the run) never end
STEPS_MOST = 400_000
EVENTS_MOST = 100_000
MODES_MOST = 50  # whose solvers are kept
DAMPED = 10.0  # a decay this many times faster than it swings is stiff,
DECAYS = 2e4  # if a run lasts so many of its times: stability then asks for 3000 explicit steps


@dataclass(frozen=True, slots=True)
class Located:
    """A run with located events: states ``x`` (N, X) SI, accelerations ``a`` (N, n), sensors ``y``
    (N, m), the ``events`` in order, and why it ended early (``reason``, else empty)."""

    x: Array
    a: Array
    y: Array
    events: tuple[Event, ...]
    reason: str


@dataclass(slots=True)
class _Run:
    """One run under way."""

    machine: Switched
    drive: Drive
    p: Array
    t: Array
    stiff: bool
    longest: float
    x: Array
    states: int  # X
    free: int  # coordinates that move by forces
    row: int = 1  # the next output
    modes: list[Modes] = field(default_factory=list)  # one for each stretch without an event
    which: Array = field(default_factory=lambda: np.empty(0, dtype=int))
    events: list[Event] = field(default_factory=list)
    cluster: tuple[int, Modes] = (0, Modes((), (), (), ()))  # events of one instant, modes before
    size: Array = field(default_factory=lambda: np.empty(0))
    step: float | None = None
    steps: int = 0
    stretch: Array = field(default_factory=lambda: np.empty(0))  # (F,) where frictions hold
    functions: dict[tuple[str, Held], Ready] = field(default_factory=dict)
    leaps: dict[Modes, Leap | None] = field(default_factory=dict)
    nodes: tuple[Array, Array] = (np.empty(0), np.empty((0, 0)))  # of the drive

    def instant(self, t: float, y: Array) -> Instant:
        return Instant(self.machine, y[: self.states], self.drive.at(t), t, self.p)

    def enter(self, here: Instant, modes: Modes) -> None:
        """A new stretch under ``modes``; what goes on holding does so where it held before."""
        before = self.modes[-1].held if self.modes else ()
        s = here.contact(modes)[0]
        for i in before:
            if i in modes.held:
                s[i] = self.stretch[i]
        self.stretch = s
        self.modes.append(modes)

    def tell(self, t: float, modes: Modes, apart: float) -> tuple[str, ...]:
        """Note what changes at t, and name it. What changes several times at one instant (what
        breaks away lets others break away) is one event: the last of these changes."""
        names, before = self.machine.names(), self.modes[-1]
        changed = tuple(event.element for event in transitions(names, t, before, modes))
        if not self.events or t - self.events[-1].time > apart:
            self.cluster = len(self.events), before
        first, before = self.cluster
        self.events[first:] = transitions(names, t, before, modes)
        return changed

    def returned(self, t: float, y: Array) -> Array:
        """y with the places that hold where they held first."""
        x = returned(self.instant(t, y), self.modes[-1], self.stretch)
        return np.concatenate([x, y[self.states :]])

    @property
    def curved(self) -> bool:
        return self.machine.curved(self.modes[-1].held)

    def written(self, rows: int) -> None:
        """So many more outputs are there, under the modes that are."""
        self.which[self.row : self.row + rows] = len(self.modes) - 1
        self.row += rows

    def ready(self, name: str) -> Ready:
        modes = self.modes[-1]
        key = name, modes.solved
        if key not in self.functions:
            function = getattr(self.machine, name)(modes.solved)
            self.functions[key] = Ready(function, self.drive, self.p)
        return self.functions[key].mode(modes.vector())


def is_stiff(machine: Switched, t: Array, start: Array, drive: Drive, p: Array) -> bool:
    """Whether an implicit method is needed for output times ``t`` (N,) s from ``start`` (X,), SI:
    a steep law stays, or a decay at the start, with all stops open or all closed, is fast against
    the swing."""
    model = machine.form.machine.model
    left = [e for i, e in enumerate(model.elements) if i not in machine.frictions]
    if any(KINDS[element.kind].dry for element in left):
        return True
    total, sides, least = len(machine.frictions), len(machine.stops), 1 / float(t[-1] - t[0])
    for pressing in (0.0, 1.0) if sides else (0.0,):
        mode = np.zeros(2 * total + 2 * sides + len(machine.jumps))
        mode[2 * total : 2 * total + sides] = pressing
        given = (start, drive.at(t[0]), float(t[0]), p, mode)
        slopes = call(machine.slopes(()), given)[0][:, : start.size]
        if not np.all(np.isfinite(slopes)):
            return True
        roots = np.linalg.eigvals(slopes.T)
        swing = float(np.abs(roots.imag).max(initial=least))
        decay = -float(roots.real.min(initial=0.0))
        if decay > max(DAMPED * swing, DECAYS * least):
            return True
    return False


def locate_events(
    machine: Switched,
    t: Array,
    start: Array,
    drive: Drive,
    p: Array,
    jumps: Array,
    stiff: bool,
    longest: float,
    samples: Samples,
    most: int = STEPS_MOST,
) -> Located:
    """Integrate from ``start`` (X,) over output times ``t`` (N,) s, restarting at ``jumps`` (J,) s
    and where states are sampled, with no step longer than ``longest`` s and at most ``most`` steps;
    all SI."""
    wide = start.size + len(machine.frictions)
    run = _Run(
        machine,
        drive,
        p,
        t,
        stiff,
        longest,
        np.full((t.size, wide), np.nan),
        start.size,
        len(machine.form.free),
    )
    run.which, run.nodes = np.zeros(t.size, dtype=int), bends(drive.t, drive.d)
    reason, y = "", start
    try:
        start = samples.after(float(t[0]), start, drive.at(float(t[0])))
        here = run.instant(float(t[0]), start)
        x, modes = first_modes(here)
        run.enter(replace(here, x=x), modes)
        y = np.concatenate([x, np.zeros(len(machine.frictions))])
        run.x[0] = y
        for now, end in pairwise(np.unique([t[0], *jumps, *samples.times, t[-1]]).tolist()):
            y, reason = _between_jumps(run, now, end, y, most)
            if reason:
                break
            y = _sampled(run, samples, end, y)
    except ValueError as error:
        reason = str(error)
    a, seen = _seen(run)
    return Located(run.x[:, : run.states], a, seen, tuple(run.events), reason)


def _between_jumps(run: _Run, now: float, end: float, y: Array, most: int) -> tuple[Array, str]:
    """The state at ``end``, and why it was not reached."""
    recent: deque[tuple[float, tuple[str, ...]]] = deque(maxlen=AT_ONCE)
    span = float(run.t[-1] - run.t[0])
    while end - now > ROUNDING * max(abs(end), span):
        now, y, fired, reason = _until_event(run, now, end, y, most)
        if reason:
            return y, reason
        if not fired:
            continue
        here = run.instant(now, y)
        x, modes = after(here, run.modes[-1], fired)
        known = run.tell(now, modes, APART * (span + abs(now)))
        run.enter(replace(here, x=x), modes)
        y = np.concatenate([x, y[run.states :]])
        recent.append((now, known))
        closely = len(recent) == AT_ONCE and now - recent[0][0] <= APART * (span + abs(now))
        if closely or len(run.events) > EVENTS_MOST:
            return y, chatters(recent)
    while run.row < run.t.size and run.t[run.row] <= end:  # an event at the very end
        run.x[run.row], run.which[run.row] = y, len(run.modes) - 1
        run.row += 1
    return y, ""


def _sampled(run: _Run, samples: Samples, t: float, y: Array) -> Array:
    """The state at ``t`` s after what is sampled then, under the modes that follow from it."""
    x = samples.after(t, y[: run.states], run.drive.at(t))
    if np.array_equal(x, y[: run.states]):
        return y
    before, here = run.instant(t, y), run.instant(t, x)
    x, modes = resampled(before, here, run.modes[-1])
    if modes != run.modes[-1]:
        run.tell(t, modes, APART * (float(run.t[-1] - run.t[0]) + abs(t)))
        run.enter(replace(here, x=x), modes)
    y = np.concatenate([x, y[run.states :]])
    if run.t[run.row - 1] == t:
        run.x[run.row - 1], run.which[run.row - 1] = y, len(run.modes) - 1
    return y


def _until_event(
    run: _Run, now: float, end: float, y: Array, most: int
) -> tuple[float, Array, list[int], str]:
    """Integrate until something switches or to ``end``: time, state, watches that crossed zero."""
    watch = run.ready("watch")
    solver = _solver(run, now, end, y)
    before = watch(now, y)
    while True:
        _resize(run, solver)
        failed = solver.step()
        if isinstance(solver, Leap):
            run.steps += solver.taken
            run.written(solver.written)
        else:
            run.steps += 1
        if solver.status == "failed" or not np.all(np.abs(solver.y) < GROWN):
            return solver.t, solver.y, [], failure(solver, failed)
        if run.steps > most:
            return solver.t, solver.y, [], tired(solver.t, most)
        stop, fired = solver.t, list[int]()
        if not isinstance(solver, Leap) or solver.undecided:
            if isinstance(solver, Leap):
                before = watch(solver.t_old, solver.y_old)
            dense = solver.dense_output()
            stop, fired, before = first_crossing(watch, dense, solver, before)
            _fill(run, dense, stop)
        if fired:
            run.step = max(solver.t - solver.t_old, ROUNDING * abs(solver.t))
            y = np.asarray(dense(stop))
            return stop, run.returned(stop, y) if run.curved else y, fired, ""
        if run.curved:
            solver.y = run.returned(solver.t, solver.y)
            solver.f = run.ready("rates")(solver.t, solver.y)
            before = watch(solver.t, solver.y)
        if solver.status == "finished":
            run.step = solver.step_size
            return end, solver.y, [], ""


def _solver(run: _Run, now: float, end: float, y: Array) -> Any:
    first = None if run.step is None else max(min(run.step, run.longest, end - now), 1e-300)
    run.size = _sizes(run, y)
    leap, atol = _leap(run), _tolerances(run)
    if leap is not None:
        return leap.begin((now, end), run.row, y, run.size, atol, first)
    options: dict[str, Any] = {
        "rtol": RELATIVE_TOLERANCE,
        "atol": atol,
        "max_step": run.longest,
        "first_step": first,
    }
    right = run.ready("rates")
    if not run.stiff:
        return DOP853(right, now, y, end, **options)
    slopes, total = run.ready("slopes"), len(run.machine.frictions)

    def jacobian(t: float, y: Array) -> Array:
        return np.hstack(
            [slopes(t, y).reshape(y.size - total, y.size).T, np.zeros((y.size, total))]
        )

    return Radau(right, now, y, end, jac=jacobian, **options)


def _leap(run: _Run) -> Leap | None:
    """The solver in machine code for the modes that are, where there is one."""
    modes = run.modes[-1]
    if run.stiff or run.curved:
        return None
    if modes not in run.leaps:
        both = fields(run.machine, modes.solved)
        p, outputs = np.concatenate([run.p, modes.vector()]), (run.t, run.x)
        steps = 10 * (STEPS_MOST + 1)  # a tenth of them at once
        given = (run.nodes, p, outputs, RELATIVE_TOLERANCE, run.longest, steps)
        run.leaps[modes] = None if both is None else Leap(both, *given)
        if len(run.leaps) > MODES_MOST:
            run.leaps.pop(next(iter(run.leaps)))
    return run.leaps[modes]


def _resize(run: _Run, solver: Any) -> None:
    """The absolute tolerance follows the size of what has moved so far."""
    if np.any(np.abs(solver.y) > run.size):
        run.size = _sizes(run, solver.y)
        solver.atol = _tolerances(run)
        if isinstance(solver, Leap):
            solver.follow(run.size, solver.atol)
    if isinstance(solver, Leap):
        solver.row = run.row


def _sizes(run: _Run, y: Array) -> Array:
    size = np.abs(y) if run.size.size == 0 else np.maximum(run.size, np.abs(y))
    free = run.free
    if free > 1:
        for part in (slice(0, free), slice(free, 2 * free)):
            size[part] = np.maximum(size[part], SMALLER * size[part].max())
    return np.maximum(size, SIZE_LEAST)


def _tolerances(run: _Run) -> Array:
    atol = ABSOLUTE_TOLERANCE * run.size
    atol[run.states :] *= LOOSER
    return atol


def _fill(run: _Run, dense: Any, stop: float) -> None:
    """The outputs up to ``stop``."""
    last = int(np.searchsorted(run.t, stop, side="right"))
    if last > run.row:
        rows = slice(run.row, last)
        run.x[rows] = dense(run.t[rows]).T
        for i in range(run.row, last) if run.curved else ():
            run.x[i] = run.returned(float(run.t[i]), run.x[i])
        run.written(last - run.row)


def _seen(run: _Run) -> tuple[Array, Array]:
    """Accelerations (N, n) and sensors (N, m) along the outputs, under the modes of each row."""
    machine, total = run.machine.form.machine, run.t.size
    a, y = np.full((total, machine.n), np.nan), np.full((total, len(machine.model.sensors)), np.nan)
    d = on_lines(run.drive.t, run.drive.d, run.t)
    rows = np.arange(run.row if run.modes else 0)
    held = [modes.solved for modes in run.modes]
    kinds = list(dict.fromkeys(held))
    kind = np.array([kinds.index(h) for h in held], dtype=int)
    modes = np.array([modes.vector() for modes in run.modes])
    for k, which in enumerate(kinds):
        mine = rows[kind[run.which[rows]] == k]
        if mine.size:
            switched = modes[run.which[mine]]
            given = (run.x[mine, : run.states], d[mine], run.t[mine], run.p, switched)
            function = run.machine.outputs(which)
            y[mine], a[mine] = along(function, given, repeated=(3,), samples=mine.size)
    return a, y
