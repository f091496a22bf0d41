"""Simulation of a machine, once over the whole output grid: by an explicit Runge–Kutta method in
machine code where that can be had and is quicker, else by CVODES.

Recorded inputs act by first-order hold; along a spline, or held from sample to sample, where the
model says so. Where an input jumps, the integration ends and starts anew, so that no step reaches
across. Failure is an outcome with its reason, never an exception.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005 (through ``casadi.integrator``).
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.model.space import gimbal_lock
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array, call, on_lines
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.lengths import at_unit_length
from symhyb.numeric.lowered.linear import free_slope
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.switched import switched
from symhyb.numeric.runs.between import finer, held_columns, smooth_columns, stepped
from symhyb.numeric.runs.closing import closed_rows, closed_start
from symhyb.numeric.runs.cvodes import (
    ABSOLUTE_TOLERANCE,
    GROWN,
    RELATIVE_TOLERANCE,
    advanced,
    culprits,
    cvodes_options,
    held_drive,
    jumps_of,
)
from symhyb.numeric.runs.explicit import compiler_fails, field, longest_step
from symhyb.numeric.runs.explicit_run import Course, explicit_states
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.settling import Event

ROUGH = 1e-4  # relative tolerance of the run that finds the scales
ROUGH_OUTPUTS = 200
EARLY = 0.1  # of a run that nothing recorded drives: shows how large the motion is
LEFT = "the motion left the bounds that were set for it"
PIECES = 50  # of a run of CVODES between which a bound is looked at
SCALE_LEAST = 1e-12  # SI: a state that moves less is not seen
STEPS_LEAST, STEPS_TOGETHER = 500, 2_000_000  # for one output, and shared by all of them
NEAR_LOCK = 0.1  # |cos| of the second of three rotations where a run ended
DAMPED = 10.0  # a decay this many times faster than it swings is stiff


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A simulated run, SI: ``q``, ``v``, ``a`` (N, n), ``y`` (N, m) sensors without noise, ``z``
    (N, z) inner states.

    ``reason`` is empty, or says why the integration stopped; rows from there on are NaN. ``method``
    integrated: *explicit* (Runge–Kutta of order 8), or CVODES by *bdf* or *adams*; ``note`` says
    what stood in the way of another, or where loops can fold over. Of an exact run it is DOP853 or
    Radau, between the located ``events``.
    """

    t: Array
    q: Array
    v: Array
    a: Array
    y: Array
    z: Array
    reason: str = ""
    method: str = "bdf"
    note: str = ""
    events: tuple[Event, ...] = ()

    @property
    def complete(self) -> bool:
        """True if the integration reached the end."""
        return not self.reason


def simulate(
    machine: Machine, scenario: Scenario, p: Array | None = None, exact: bool = False
) -> Trajectory:
    """Integrate M q'' = k_e − k_c over ``scenario.t`` with parameters ``p`` (P,) in SI, default
    the model's. Inputs must cover the output times.

    With a C compiler the explicit method, with as many steps as pay; else, or if they do not
    suffice, CVODES: BDF with Newton's method where a law is steep or remembers, or where the
    machine linearised at the start has a decay that is fast against its swing; else Adams with
    functional iteration, and BDF if that fails. A law that switches is left to BDF at once.

    ``exact``: dry friction holds instead of creeping, and stops touch; every transition is located
    and listed in ``events`` (:mod:`symhyb.numeric.runs.events`).

    Raises:
        ValueError: an input that stops before the simulation does, or times that do not increase.
    """
    values = machine.values if p is None else np.asarray(p, dtype=float)
    _require_cover(scenario)
    scenario = _bent(scenario, machine)
    form = state_form(machine)
    drive = _drive(form, scenario)
    start = form.state(scenario.q, scenario.v, inner_start(machine, scenario, values))
    start, reason = closed_start(form, start, drive, scenario, values)
    if reason:
        x = np.full((scenario.t.size, form.size), np.nan)
        return _observe(form, scenario, drive, x, values, reason, "none")
    if form.size == 0:
        x = np.zeros((scenario.t.size, 0))
        return _observe(form, scenario, drive, x, values, "", "none")
    if exact:
        return _exact(form, scenario, drive, start, values)
    stiff = _stiff(form, scenario, drive, start, values)
    explicit = _explicit(form, scenario, drive, start, values, stiff)
    if explicit is not None:
        x, left = _within(scenario.bound, scenario.t, explicit)
        x, reason, note = closed_rows(form, scenario, drive, x, values, left)
        if reason == left:
            run = _observe(form, scenario, drive, x, values, reason, "explicit")
            return replace(run, note=note)
    for method in ("bdf",) if stiff else ("adams", "bdf"):
        scales = scenario.scales
        if scales is None:
            scales = _rough_scales(form, scenario, drive, start, values, method)
        x, reason = _integrate(
            form, scenario, drive, start, values, scales, method, RELATIVE_TOLERANCE
        )
        x, reason, note = closed_rows(form, scenario, drive, x, values, reason)
        if not reason or reason.startswith(LEFT):
            break
    run = _observe(form, scenario, drive, x, values, reason, method)
    return replace(run, note="; ".join(filter(None, (compiler_fails(), note))))


def _explicit(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array, stiff: bool
) -> Array | None:
    """States (N, X) by the explicit method; None where CVODES is to do it."""
    rates = None if culprits(form.machine.model) else field(form)
    if rates is None:
        return None
    longest = longest_step(form)
    course = Course(scenario.t, start, p, scenario.t_u, drive, longest, scenario.bound)
    tolerances = (RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE)
    return explicit_states(rates, course, scenario.scales, tolerances, stiff)


def _within(bound: Array | None, t: Array, x: Array) -> tuple[Array, str]:
    """States (N, X) at ``t`` (N,), NaN from where one is beyond its ``bound`` (X,), SI, and why the
    run ends there; empty if it does not."""
    if bound is None:
        return x, ""
    far = np.maximum.accumulate(~(np.abs(x) <= bound).all(axis=1))
    if not far.any():
        return x, ""
    return np.where(far[:, None], np.nan, x), f"{LEFT} by {t[np.argmax(far)]:.6g} s"


def _bent(scenario: Scenario, machine: Machine) -> Scenario:
    """The scenario with inputs that are straight between its times: smooth ones on a finer grid,
    held ones with a time more right before each jump."""
    inputs = machine.model.inputs
    smooth, held = smooth_columns(inputs), held_columns(inputs)
    if not smooth and not held:
        return scenario
    t, u = stepped(*finer(scenario.t_u, scenario.u, smooth, held), held)
    if scenario.given is None:
        return replace(scenario, t_u=t, u=u)
    return replace(scenario, t_u=t, u=u, given=on_lines(scenario.t_u, scenario.given, t))


def _exact(form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array) -> Trajectory:
    """The run with located events."""
    from symhyb.numeric.runs.driven import Drive
    from symhyb.numeric.runs.events import is_stiff, locate_events

    if form.machine.constraints:
        text = "an exact run knows no constraints; leave out 'exact'"
        raise InputError(Problem(text, "constraints", form.machine.model.file))
    machine, model = switched(form), form.machine.model
    longest = float(cvodes_options(scenario.t_u, drive, 0, "bdf", 1.0)["max_step_size"]) or np.inf
    jumps = jumps_of(scenario.t_u, drive, scenario.t)
    held = Drive(scenario.t_u, drive)
    stiff = is_stiff(machine, scenario.t, start, held, p)
    run = locate_events(machine, scenario.t, start, held, p, jumps, stiff, longest)
    f = len(form.free)
    motion = form.motion(run.x, on_lines(scenario.t_u, drive, scenario.t))
    q, v = at_unit_length(model, *motion)
    reason = run.reason + (culprits(model) if run.reason else "")
    method = "radau" if stiff else "dop853"
    z = run.x[:, 2 * f :]
    return Trajectory(scenario.t, q, v, run.a, run.y, z, reason, method, events=run.events)


def inner_start(machine: Machine, scenario: Scenario, p: Array) -> Array:
    """The inner states (z,) with which a scenario begins, SI."""
    if scenario.z is not None:
        return scenario.z
    (z,) = call(machine.inner_rest, (scenario.q, float(scenario.t[0]), p))
    return z.reshape(-1)


def _drive(form: StateForm, scenario: Scenario) -> Array:
    """Inputs and given motion (K, drive) at the times of the inputs."""
    if not form.given:
        return scenario.u
    if scenario.given is None:
        names = [form.machine.model.coordinates[i].name for i in form.given]
        raise ValueError(f"the motion of {', '.join(names)} is imposed and was not given")
    return np.concatenate([scenario.u, scenario.given], axis=1)


def _stiff(form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array) -> bool:
    """Whether the machine asks for BDF; see :func:`simulate`."""
    model = form.machine.model
    if any(KINDS[element.kind].stiff for element in model.elements) or culprits(model):
        return True
    first = drive[0] if len(drive) else np.zeros(form.drive)
    matrix = free_slope(form, start, first, float(scenario.t[0]), p)
    if not np.isfinite(matrix).all():
        return True
    roots = np.linalg.eigvals(matrix)
    span = float(scenario.t[-1] - scenario.t[0]) or 1.0
    swing = float(np.abs(roots.imag).max(initial=1 / span))
    return bool(-roots.real.min(initial=0.0) > DAMPED * max(swing, 1 / span))


def _rough_scales(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array, method: str
) -> Array:
    """Largest size of each state (X,) in a run to ``ROUGH`` accuracy; 1 where it stands still.

    Without a recorded input the first part tells, unless a state still rests there: a size that is
    too small costs steps, and no accuracy."""
    unit = np.maximum(np.abs(start), 1e-3)
    size = np.zeros(start.size)
    for part in (1.0,) if form.drive else (EARLY, 1.0):
        last = part * (scenario.t.size - 1)
        rows = np.unique(np.linspace(0, last, ROUGH_OUTPUTS).astype(int))
        rough = replace(scenario, t=scenario.t[rows])
        x, _ = _integrate(form, rough, drive, start, p, unit, method, ROUGH)
        size = np.nanmax(np.abs(x), axis=0, initial=0.0)
        if np.all(size > SCALE_LEAST):
            break
    # the size of a run that grows without bound would hide all that it began with
    size = np.minimum(size, GROWN * unit)
    return np.asarray(np.where(size > SCALE_LEAST, size, 1.0))


def _integrate(
    form: StateForm,
    scenario: Scenario,
    drive: Array,
    start: Array,
    p: Array,
    scales: Array,
    method: str,
    tolerance: float,
) -> tuple[Array, str]:
    """States (N, X) and the reason why they end early; one integration between jumps of inputs."""
    t = scenario.t
    jumps = jumps_of(scenario.t_u, drive, t)
    grid = np.union1d(t, jumps)  # an input may jump between two outputs
    marks = [0, *np.searchsorted(grid, jumps).tolist(), grid.size - 1]
    if scenario.bound is not None:  # looked at between pieces of the run
        marks += np.linspace(0, grid.size - 1, PIECES).astype(int).tolist()
    rate = _rate(form, scenario, drive, scales)
    # finding a scale is no reason to work long, and a law that chatters never ends
    hopeless = tolerance >= ROUGH or culprits(form.machine.model)
    most = STEPS_LEAST + STEPS_TOGETHER // (10 if hopeless else 1) // grid.size
    options = cvodes_options(scenario.t_u, drive, most, method, tolerance)
    x = np.full((grid.size, form.size), np.nan)
    x[0] = start
    reason = ""
    for first, last in pairwise(sorted(set(marks))):
        span = grid[first : last + 1]
        states, reason = advanced(rate, span, x[first] / scales, p, options)
        x[first + 1 : first + 1 + len(states)] = states * scales
        if reason:
            reason += culprits(form.machine.model)
            break
        x[first : last + 1], reason = _within(scenario.bound, span, x[first : last + 1])
        if reason:
            break
    return x[np.searchsorted(grid, t)], reason


def solve_system(
    form: StateForm, scenario: Scenario, right: ca.Function, start: Array, p: Array
) -> tuple[Array, str]:
    """Integrate any system y' = right(y, d, t, p) along the drive of a scenario by BDF.

    Returns y (N, Y), of order 1 and dimensionless, at the output times, and why it ends early.
    """
    scenario = _bent(scenario, form.machine)
    drive = _drive(form, scenario)
    kind: Any = ca.MX if form.drive else ca.SX
    y, t = kind.sym("y", start.size), kind.sym("t")
    symbols = kind.sym("p", p.size)
    d = held_drive(scenario.t_u, drive)(t) if form.drive else kind(0, 1)
    rate = {"x": y, "t": t, "p": symbols, "ode": right(y, d, t, symbols)}
    most = STEPS_LEAST + STEPS_TOGETHER // scenario.t.size
    options = cvodes_options(scenario.t_u, drive, most, "bdf", RELATIVE_TOLERANCE)
    rows = np.full((scenario.t.size, start.size), np.nan)
    rows[0] = start
    states, reason = advanced(rate, scenario.t, start, p, options)
    rows[1 : 1 + len(states)] = states
    return rows, reason


def _require_cover(scenario: Scenario) -> None:
    if not np.all(np.diff(scenario.t) > 0):  # a NaN would never end
        raise ValueError("output times must increase")
    if scenario.u.shape[1] == 0 and scenario.given is None:
        return
    if scenario.t_u[0] > scenario.t[0] + 1e-9 or scenario.t_u[-1] < scenario.t[-1] - 1e-9:
        raise ValueError(
            f"the inputs cover {scenario.t_u[0]:.6g} to {scenario.t_u[-1]:.6g} s, the simulation "
            f"runs from {scenario.t[0]:.6g} to {scenario.t[-1]:.6g} s; shorten the simulation or "
            "give a longer input"
        )


def _rate(form: StateForm, scenario: Scenario, drive: Array, scales: Array) -> dict[str, Any]:
    """The equations for states divided by their scales; SX unless recorded inputs act."""
    f, n = len(form.free), form.machine.n
    kind: Any = ca.MX if form.drive else ca.SX
    x, t = kind.sym("x", form.size), kind.sym("t")
    p = kind.sym("p", form.machine.values.size)
    d = held_drive(scenario.t_u, drive)(t) if form.drive else kind(0, 1)
    full = x * scales
    slopes = form.rates()(full, d, t, p, kind.zeros(n))
    return {"x": x, "t": t, "p": p, "ode": ca.vertcat(full[f : 2 * f, 0], slopes) / scales}


def _observe(
    form: StateForm,
    scenario: Scenario,
    drive: Array,
    x: Array,
    values: Array,
    reason: str,
    method: str,
) -> Trajectory:
    t, total = scenario.t, scenario.t.size
    d = on_lines(scenario.t_u, drive, t)
    q, v = at_unit_length(form.machine.model, *form.motion(x, d))
    x = form.state(q, v, x[:, 2 * len(form.free) :])
    still = np.zeros(form.machine.n)
    y, a = along(form.outputs(), (x, d, t, values, still), repeated=(3, 4), samples=total)
    z = x[:, 2 * len(form.free) :]
    return Trajectory(t, q, v, a, y, z, _ending(form.machine, q, reason), method)


def drive_at(form: StateForm, scenario: Scenario) -> Array:
    """The drive (N, D) of a scenario at its output times, SI."""
    scenario = _bent(scenario, form.machine)
    return on_lines(scenario.t_u, _drive(form, scenario), scenario.t)


def _ending(machine: Machine, q: Array, reason: str) -> str:
    """Why a run ended, with the gimbal lock that it ran into, if it did: the last row of q (N, n)
    that was computed may lie a little before it."""
    last = np.flatnonzero(np.isfinite(q).all(axis=1))[-1:]
    if not reason or not last.size:
        return reason
    names = [coordinate.name for coordinate in machine.model.coordinates]
    near = dict(zip(names, (float(x) for x in q[last[0]]), strict=True))
    locked = gimbal_lock(machine.model, near, NEAR_LOCK)
    return f"{reason}; {locked}" if locked else reason
