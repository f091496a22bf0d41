"""Simulation of a machine by CVODES, once over the whole output grid.

Recorded inputs act by first-order hold. Where an input jumps, the integration ends and starts
anew, so that no step reaches across. Failure is an outcome with its reason, never an exception.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005 (through ``casadi.integrator``).
"""

from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from symhyb.numeric.buffers import Array, call, mapped
from symhyb.numeric.machine import Machine

Options = dict[str, bool | int | float]

RELATIVE_TOLERANCE = 1e-8
ABSOLUTE_TOLERANCE = 1e-10  # of states divided by their scales
JUMP_SHARE = 0.2  # of an input's range within one sample: taken for a jump
JUMPS_MOST = 400
LONGEST_STEP = 2  # samples of an input: no pulse is stepped over
GROWN = 1e6  # a state this many scales large has grown without bound
STEPS_MOST = 20_000  # between two outputs


@dataclass(frozen=True, slots=True)
class Scenario:
    """What to simulate, SI: output times ``t`` (N,), start ``q``, ``v`` (n,), and inputs ``u``
    (K, k) at times ``t_u`` (K,); ``scales`` (2n,) are typical sizes of (q, v)."""

    t: Array
    q: Array
    v: Array
    t_u: Array
    u: Array
    scales: Array | None = None


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A simulated run, SI: ``q``, ``v``, ``a`` (N, n), ``y`` (N, m) sensors without noise.

    ``reason`` is empty, or says why the integration stopped; rows from there on are NaN.
    """

    t: Array
    q: Array
    v: Array
    a: Array
    y: Array
    reason: str = ""

    @property
    def complete(self) -> bool:
        """True if the integration reached the end."""
        return not self.reason


def simulate(machine: Machine, scenario: Scenario, p: Array | None = None) -> Trajectory:
    """Integrate M q'' = k_e − k_c over ``scenario.t`` with parameters ``p`` (P,) in SI, default
    the model's. Inputs must cover the output times.

    Raises:
        ValueError: an input that stops before the simulation does, or times that do not increase.
    """
    values = machine.values if p is None else np.asarray(p, dtype=float)
    t, n = scenario.t, machine.n
    _require_cover(scenario)
    scales = np.ones(2 * n) if scenario.scales is None else scenario.scales
    jumps = _jumps(scenario)
    grid = np.union1d(t, jumps)  # an input may jump between two outputs
    marks = [0, *np.searchsorted(grid, jumps).tolist(), grid.size - 1]
    rate = _rate(machine, scenario, scales)
    x = np.full((grid.size, 2 * n), np.nan)
    x[0] = np.concatenate([scenario.q, scenario.v])
    reason = ""
    for first, last in pairwise(sorted(set(marks))):
        span = grid[first : last + 1]
        states, reason = _advance(rate, span, x[first] / scales, values, _options(scenario))
        x[first + 1 : first + 1 + len(states)] = states * scales
        if reason:
            break
    return _observe(machine, scenario, x[np.searchsorted(grid, t)], values, reason)


def _advance(
    rate: dict[str, ca.MX], grid: Array, start: Array, p: Array, options: Options
) -> tuple[Array, str]:
    """States (N − 1, 2n) at the times ``grid[1:]`` in one integration. If it fails, halves are
    tried, so that the rows before the failure stand and the reason says when it was."""
    reason = ""
    try:
        run = ca.integrator("run", "cvodes", rate, grid[0], grid[1:], options)
        states = np.asarray(run(x0=start, p=p)["xf"]).T
        if np.all(np.isfinite(states)):
            return states, ""
        reason = _grown(grid)
    except RuntimeError as error:
        reason = _explain(error, start, grid)
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
    if scenario.u.shape[1] == 0:
        return
    if scenario.t_u[0] > scenario.t[0] + 1e-9 or scenario.t_u[-1] < scenario.t[-1] - 1e-9:
        raise ValueError(
            f"the inputs cover {scenario.t_u[0]:.6g} to {scenario.t_u[-1]:.6g} s, the simulation "
            f"runs from {scenario.t[0]:.6g} to {scenario.t[-1]:.6g} s; shorten the simulation or "
            "give a longer input"
        )


def _rate(machine: Machine, scenario: Scenario, scales: Array) -> dict[str, ca.MX]:
    n = machine.n
    x, t, p = ca.MX.sym("x", 2 * n), ca.MX.sym("t"), ca.MX.sym("p", machine.values.size)
    q, v = x[:n] * scales[:n], x[n:] * scales[n:]
    u = _held(scenario)(t) if scenario.u.shape[1] else ca.MX(0, 1)
    a = machine.acceleration(q, v, u, t, p, ca.MX.zeros(n))
    return {"x": x, "t": t, "p": p, "ode": ca.vertcat(v, a) / scales}


def _held(scenario: Scenario) -> ca.Function:
    """First-order hold of the inputs as a function of time."""
    options = {"lookup_mode": ["binary"]}  # rounded times are not evenly spaced to the last bit
    return ca.interpolant("u", "linear", [scenario.t_u], scenario.u.ravel(), options)


def _options(scenario: Scenario) -> Options:
    longest = np.inf
    if scenario.u.shape[1]:
        longest = LONGEST_STEP * float(np.median(np.diff(scenario.t_u)))
    return {
        "reltol": RELATIVE_TOLERANCE,
        "abstol": ABSOLUTE_TOLERANCE,
        "max_num_steps": STEPS_MOST,
        "max_step_size": 0.0 if np.isinf(longest) else longest,
        "show_eval_warnings": False,
        "disable_internal_warnings": True,
    }


def _jumps(scenario: Scenario) -> Array:
    """Times inside the simulation at which an input begins or ends a jump."""
    if scenario.u.shape[1] == 0:
        return np.empty(0)
    reach = np.ptp(scenario.u, axis=0)
    jumps = np.abs(np.diff(scenario.u, axis=0)) > JUMP_SHARE * np.where(reach > 0, reach, np.inf)
    where = np.flatnonzero(jumps.any(axis=1))
    times = np.unique(scenario.t_u[np.concatenate([where, where + 1])])
    times = times[(times > scenario.t[0]) & (times < scenario.t[-1])]
    # a switching input: every sample a jump, none worth a restart
    return times if times.size <= JUMPS_MOST else np.empty(0)


def _grown(grid: Array) -> str:
    return f"the motion grew without bound between {grid[0]:.6g} and {grid[-1]:.6g} s"


def _explain(error: RuntimeError, start: Array, grid: Array) -> str:
    text = str(error)
    if np.abs(start).max() > GROWN:
        return _grown(grid)
    span = f"between {grid[0]:.6g} and {grid[-1]:.6g} s"
    if "TOO_MUCH_WORK" in text:
        return (
            f"CVODES needed more than {STEPS_MOST} steps for one output {span}: the equations are "
            "stiff or chatter (a wider friction transition helps) or the motion grows without bound"
        )
    if "CONV_FAILURE" in text or "ERR_FAILURE" in text:
        return (
            f"CVODES could not meet its tolerance {span}: the motion grows without bound or jumps"
        )
    return f"CVODES stopped {span}: {text.strip().splitlines()[-1]}"


def _observe(
    machine: Machine, scenario: Scenario, x: Array, values: Array, reason: str
) -> Trajectory:
    n, total = machine.n, scenario.t.size
    q, v = x[:, :n], x[:, n:]
    u = np.column_stack(
        [np.interp(scenario.t, scenario.t_u, column) for column in scenario.u.T]
        or [np.empty((total, 0))]
    )
    still = np.zeros((total, n))
    (a,) = call(
        mapped(machine.acceleration, total, repeated=(4,)), (q, v, u, scenario.t, values, still)
    )
    (y,) = call(mapped(machine.outputs, total, repeated=(5,)), (q, v, a, u, scenario.t, values))
    return Trajectory(scenario.t, q, v, a, y, reason)
