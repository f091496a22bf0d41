"""Simulation of a machine by CVODES, once over the whole output grid.

Recorded inputs act by first-order hold, or along a spline where the model calls them smooth. Where
an input jumps, the integration ends and starts anew, so that no step reaches across. Failure is an
outcome with its reason, never an exception.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005 (through ``casadi.integrator``).
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from symhyb.model.expression import Node, Operation
from symhyb.model.space import gimbal_lock
from symhyb.model.types import Model
from symhyb.numeric.between import finer, smooth_columns
from symhyb.numeric.buffers import Array, call
from symhyb.numeric.dynamics import StateForm, state_form
from symhyb.numeric.lengths import at_unit_length
from symhyb.numeric.linear import state_slope
from symhyb.numeric.machine import Machine
from symhyb.numeric.vector import along

Options = dict[str, bool | int | float | str]

RELATIVE_TOLERANCE = 1e-8
ABSOLUTE_TOLERANCE = 1e-10  # of states divided by their scales
ROUGH = 1e-4  # relative tolerance of the run that finds the scales
ROUGH_OUTPUTS = 200
EARLY = 0.1  # of a run that nothing recorded drives: shows how large the motion is
SCALE_LEAST = 1e-12  # SI: a state that moves less is not seen
JUMP_SHARE = 0.2  # of an input's range within one sample: taken for a jump
JUMPS_MOST = 400
LONGEST_STEP = 2  # samples of an input: no pulse is stepped over
GROWN = 1e6  # a state this many scales large has grown without bound
STEPS_LEAST, STEPS_TOGETHER = 500, 2_000_000  # for one output, and shared by all of them
STEEP = ("friction", "friction_dynamic", "gap", "hysteresis", "relaxation")
NEAR_LOCK = 0.1  # |cos| of the second of three rotations where a run ended
DAMPED = 10.0  # a decay this many times faster than it swings is stiff


@dataclass(frozen=True, slots=True)
class Scenario:
    """What to simulate, SI: output times ``t`` (N,), start ``q``, ``v`` (n,), and inputs ``u``
    (K, k) at times ``t_u`` (K,).

    ``scales`` (X,) are typical sizes of the states (q, v, z), else found by a rough run; ``z`` the
    inner states at the start, else those of a machine at rest; ``given`` (K, 3·g) places, speeds
    and accelerations of the g imposed coordinates at ``t_u``.
    """

    t: Array
    q: Array
    v: Array
    t_u: Array
    u: Array
    scales: Array | None = None
    z: Array | None = None
    given: Array | None = None


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A simulated run, SI: ``q``, ``v``, ``a`` (N, n), ``y`` (N, m) sensors without noise, ``z``
    (N, z) inner states.

    ``reason`` is empty, or says why the integration stopped; rows from there on are NaN. ``method``
    is what CVODES used: BDF or Adams.
    """

    t: Array
    q: Array
    v: Array
    a: Array
    y: Array
    z: Array
    reason: str = ""
    method: str = "bdf"

    @property
    def complete(self) -> bool:
        """True if the integration reached the end."""
        return not self.reason


def simulate(machine: Machine, scenario: Scenario, p: Array | None = None) -> Trajectory:
    """Integrate M q'' = k_e − k_c over ``scenario.t`` with parameters ``p`` (P,) in SI, default
    the model's. Inputs must cover the output times.

    BDF with Newton's method where a law is steep or remembers, or where the machine linearised at
    the start has a decay that is fast against its swing; else Adams with functional iteration, and
    BDF if that fails.

    Raises:
        ValueError: an input that stops before the simulation does, or times that do not increase.
    """
    values = machine.values if p is None else np.asarray(p, dtype=float)
    _require_cover(scenario)
    scenario = _bent(scenario, machine)
    form = state_form(machine)
    start = form.state(scenario.q, scenario.v, _inner_start(machine, scenario, values))
    drive = _drive(form, scenario)
    if form.size == 0:
        x = np.zeros((scenario.t.size, 0))
        return _observe(form, scenario, drive, x, values, "", "none")
    methods = ("bdf",) if _stiff(form, scenario, drive, start, values) else ("adams", "bdf")
    for method in methods:
        scales = scenario.scales
        if scales is None:
            scales = _rough_scales(form, scenario, drive, start, values, method)
        x, reason = _integrate(
            form, scenario, drive, start, values, scales, method, RELATIVE_TOLERANCE
        )
        if not reason:
            break
    return _observe(form, scenario, drive, x, values, reason, method)


def _bent(scenario: Scenario, machine: Machine) -> Scenario:
    """The scenario with inputs that are smooth between samples on a finer grid."""
    smooth = smooth_columns(machine.model.inputs)
    if not smooth:
        return scenario
    t, u = finer(scenario.t_u, scenario.u, smooth)
    if scenario.given is None:
        return replace(scenario, t_u=t, u=u)
    given = [np.interp(t, scenario.t_u, column) for column in scenario.given.T]
    return replace(scenario, t_u=t, u=u, given=np.column_stack(given))


def _inner_start(machine: Machine, scenario: Scenario, p: Array) -> Array:
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
    if any(element.kind in STEEP for element in model.elements) or _culprits(model):
        return True
    first = drive[0] if len(drive) else np.zeros(form.drive)
    matrix = state_slope(form, start, first, float(scenario.t[0]), p)
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
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array, scales: Array,
    method: str, tolerance: float,
) -> tuple[Array, str]:  # fmt: skip
    """States (N, X) and the reason why they end early; one integration between jumps of inputs."""
    t = scenario.t
    jumps = _jumps(scenario.t_u, drive, t)
    grid = np.union1d(t, jumps)  # an input may jump between two outputs
    marks = [0, *np.searchsorted(grid, jumps).tolist(), grid.size - 1]
    rate = _rate(form, scenario, drive, scales)
    # finding a scale is no reason to work long, and a law that chatters never ends
    hopeless = tolerance >= ROUGH or _culprits(form.machine.model)
    most = STEPS_LEAST + STEPS_TOGETHER // (10 if hopeless else 1) // grid.size
    options = _options(scenario, drive, most, method, tolerance)
    x = np.full((grid.size, form.size), np.nan)
    x[0] = start
    reason = ""
    for first, last in pairwise(sorted(set(marks))):
        span = grid[first : last + 1]
        states, reason = _advance(rate, span, x[first] / scales, p, options)
        x[first + 1 : first + 1 + len(states)] = states * scales
        if reason:
            reason += _culprits(form.machine.model)
            break
    return x[np.searchsorted(grid, t)], reason


def solve_system(
    form: StateForm, scenario: Scenario, right: ca.Function, start: Array, p: Array
) -> tuple[Array, str]:
    """Integrate any system y' = right(y, d, t, p) along the drive of a scenario by BDF.

    Returns y (N, Y), of order 1 and dimensionless, at the output times, and why it ends early.
    """
    drive = _drive(form, scenario)
    kind: Any = ca.MX if form.drive else ca.SX
    y, t = kind.sym("y", start.size), kind.sym("t")
    symbols = kind.sym("p", p.size)
    d = _held(scenario.t_u, drive)(t) if form.drive else kind(0, 1)
    rate = {"x": y, "t": t, "p": symbols, "ode": right(y, d, t, symbols)}
    most = STEPS_LEAST + STEPS_TOGETHER // scenario.t.size
    options = _options(scenario, drive, most, "bdf", RELATIVE_TOLERANCE)
    rows = np.full((scenario.t.size, start.size), np.nan)
    rows[0] = start
    states, reason = _advance(rate, scenario.t, start, p, options)
    rows[1 : 1 + len(states)] = states
    return rows, reason


def _advance(
    rate: dict[str, Any], grid: Array, start: Array, p: Array, options: Options
) -> tuple[Array, str]:
    """States (N − 1, 2n) at the times ``grid[1:]`` in one integration. If it fails, halves are
    tried, so that the rows before the failure stand and the reason says when it was."""
    reason = ""
    try:
        run = ca.integrator("run", "cvodes", rate, grid[0], grid[1:].tolist(), options)
        states = call(run, (start, np.empty(0), p))[0]  # x, no algebraic states, p
        if np.all(np.isfinite(states)):
            return states, ""
        reason = _grown(grid)
    except RuntimeError as error:
        reason = _explain(error, start, grid, float(options["max_num_steps"]))
    if grid.size <= 2:
        return np.empty((0, start.size)), reason
    middle = grid.size // 2
    before, failed = _advance(rate, grid[: middle + 1], start, p, options)
    if failed:
        return before, failed
    after, failed = _advance(rate, grid[middle:], before[-1], p, options)
    return np.concatenate([before, after]), failed


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
    d = _held(scenario.t_u, drive)(t) if form.drive else kind(0, 1)
    full = x * scales
    slopes = form.rates()(full, d, t, p, kind.zeros(n))
    return {"x": x, "t": t, "p": p, "ode": ca.vertcat(full[f : 2 * f, 0], slopes) / scales}


def _held(t: Array, drive: Array) -> ca.Function:
    """First-order hold of the drive as a function of time."""
    options = {"lookup_mode": ["binary"]}  # rounded times are not evenly spaced to the last bit
    return ca.interpolant("d", "linear", [t], drive.ravel(), options)


def _options(scenario: Scenario, drive: Array, most: int, method: str, tolerance: float) -> Options:
    longest = np.inf
    if drive.shape[1]:
        longest = LONGEST_STEP * float(np.median(np.diff(scenario.t_u)))
    return {
        "reltol": tolerance,
        "abstol": ABSOLUTE_TOLERANCE * tolerance / RELATIVE_TOLERANCE,
        "max_num_steps": most,
        "max_step_size": 0.0 if np.isinf(longest) else longest,
        "linear_multistep_method": method,
        "nonlinear_solver_iteration": "newton" if method == "bdf" else "functional",
        "show_eval_warnings": False,
        "disable_internal_warnings": True,
    }


def _jumps(t: Array, drive: Array, outputs: Array) -> Array:
    """Times inside the simulation at which an input begins or ends a jump."""
    if drive.shape[1] == 0:
        return np.empty(0)
    reach = np.ptp(drive, axis=0)
    jumps = np.abs(np.diff(drive, axis=0)) > JUMP_SHARE * np.where(reach > 0, reach, np.inf)
    where = np.flatnonzero(jumps.any(axis=1))
    times = np.unique(t[np.concatenate([where, where + 1])])
    times = times[(times > outputs[0]) & (times < outputs[-1])]
    # a switching input: every sample a jump, none worth a restart
    return times if times.size <= JUMPS_MOST else np.empty(0)


def _grown(grid: Array) -> str:
    return f"the motion grew without bound between {grid[0]:.6g} and {grid[-1]:.6g} s"


def _explain(error: RuntimeError, start: Array, grid: Array, most: float) -> str:
    text = str(error)
    if np.abs(start).max() > GROWN:
        return _grown(grid)
    span = f"between {grid[0]:.6g} and {grid[-1]:.6g} s"
    if "TOO_MUCH_WORK" in text:
        return (
            f"CVODES needed more than {most:.0f} steps for one output {span}: the equations are "
            "stiff or chatter (a wider friction transition helps) or the motion grows without bound"
        )
    if "CONV_FAILURE" in text or "ERR_FAILURE" in text:
        return (
            f"CVODES could not meet its tolerance {span}: the motion grows without bound or jumps"
        )
    return f"CVODES stopped {span}: {text.strip().splitlines()[-1]}"


def _culprits(model: Model) -> str:
    """The laws that switch at a point and so may chatter, as the end of a sentence."""
    switching = [
        f"elements.{element.name}"
        for element in model.elements
        if any(_switches(expression.tree) for _, expression in element.values)
    ]
    if not switching:
        return ""
    return (
        f"; {', '.join(switching)} switches with sign(...), which chatters where the motion "
        "reverses: write it as kind 'friction', or with tanh(speed/transition)"
    )


def _switches(node: Node) -> bool:
    if not isinstance(node, Operation):
        return False
    return node.operator == "sign" or any(_switches(part) for part in node.arguments)


def _observe(
    form: StateForm, scenario: Scenario, drive: Array, x: Array, values: Array, reason: str,
    method: str,
) -> Trajectory:  # fmt: skip
    t, total = scenario.t, scenario.t.size
    d = np.column_stack(
        [np.interp(t, scenario.t_u, column) for column in drive.T] or [np.empty((total, 0))]
    )
    q, v = at_unit_length(form.machine.model, *form.motion(x, d))
    x = form.state(q, v, x[:, 2 * len(form.free) :])
    still = np.zeros(form.machine.n)
    y, a = along(form.outputs(), (x, d, t, values, still), repeated=(3, 4), samples=total)
    z = x[:, 2 * len(form.free) :]
    return Trajectory(t, q, v, a, y, z, _told(form.machine, q, reason), method)


def _told(machine: Machine, q: Array, reason: str) -> str:
    """Why a run ended, with the gimbal lock that it ran into, if it did: the last row of q (N, n)
    that was computed may lie a little before it."""
    last = np.flatnonzero(np.isfinite(q).all(axis=1))[-1:]
    if not reason or not last.size:
        return reason
    names = [coordinate.name for coordinate in machine.model.coordinates]
    near = dict(zip(names, (float(x) for x in q[last[0]]), strict=True))
    locked = gimbal_lock(machine.model, near, NEAR_LOCK)
    return f"{reason}; {locked}" if locked else reason
