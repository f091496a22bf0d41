"""CVODES over a grid of outputs: its options, where it must start anew, and why it stopped.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005 (through ``casadi.integrator``).
"""

from typing import Any

import casadi as ca
import numpy as np

from symhyb.model.switching import switching_word
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.runs.sizes import GROWN

Options = dict[str, bool | int | float | str]

RELATIVE_TOLERANCE = 1e-8
ABSOLUTE_TOLERANCE = 1e-10  # of states divided by their scales
JUMP_SHARE = 0.2  # of an input's range within one sample: taken for a jump
JUMPS_MOST = 400
FLAGS = {  # what CVODES returns (its user guide, appendix B), apart from too much work
    "CONV_FAILURE": "could not meet its tolerance {span}: the motion grows without bound or jumps",
    "ERR_FAILURE": "could not meet its tolerance {span}: the motion grows without bound or jumps",
    "TOO_MUCH_ACC": "was asked for more digits than numbers hold {span}",
    "RHSFUNC": "met rates that are not finite {span} (a division by zero, a root or a logarithm of "
    "a negative number)",
    "LSETUP_FAIL": "met slopes of the equations that are singular or not finite {span}",
    "LSOLVE_FAIL": "met slopes of the equations that are singular or not finite {span}",
    "LINIT_FAIL": "could not begin {span}: its linear solver failed",
    "ILL_INPUT": "could not begin {span}: a start, a parameter or an input is not finite",
    "TOO_CLOSE": "could not begin {span}: the times lie too close together",
    "BAD_T": "was asked for a time outside of what it had computed {span}",
    "MEM_": "ran out of memory {span}",
}
JUMP_TAKES = 1e-6  # of the longest time between two samples: less is a jump of a held input
# for Newton's method: ∂x'/∂x as one function of scalar operations, which takes a third of the time
# of as many directional derivatives (an arm of six joints)
SLOPES_BY_STATES: dict[str, Any] = {
    "cse": True,
    "is_diff_in": [True, False, False, False],
    "jac_penalty": 0.0,
}
LONGEST_STEP = 2  # samples of an input: no pulse is stepped over
STEPS_LEAST, STEPS_TOGETHER = 500, 2_000_000  # for one output, and shared by all of them


def advanced(
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
    before, failed = advanced(rate, grid[: middle + 1], start, p, options)
    if failed:
        return before, failed
    after, failed = advanced(rate, grid[middle:], before[-1], p, options)
    return np.concatenate([before, after]), failed


def driven(right: ca.Function, t: Array, drive: Array) -> dict[str, Any]:
    """The system x' = right(x, d, t, p) along a drive (K, D), SI, recorded at times ``t`` (K,) in
    s, by first-order hold; of scalar operations alone where nothing drives it."""
    kind: Any = ca.MX if right.size1_in(1) else ca.SX
    x, time, p = (kind.sym(n, right.size1_in(i)) for n, i in (("x", 0), ("t", 2), ("p", 3)))
    if kind is ca.SX:
        return {"x": x, "t": time, "p": p, "ode": right(x, ca.SX(0, 1), time, p)}
    options = {"lookup_mode": ["binary"]}  # rounded times are not evenly spaced to the last bit
    held = ca.interpolant("d", "linear", [t], drive.ravel(), options)
    return {"x": x, "t": time, "p": p, "ode": right(x, held(time), time, p)}


def steps_of_output(outputs: int, hopeless: bool = False) -> int:
    """How many steps CVODES may take for one of so many outputs; a tenth where that is
    ``hopeless``."""
    return STEPS_LEAST + STEPS_TOGETHER // (10 if hopeless else 1) // outputs


def cvodes_options(
    t: Array, drive: Array, most: int, method: str, tolerance: float = RELATIVE_TOLERANCE
) -> Options:
    """Options of CasADi's CVODES along a drive (K, drive) recorded at times ``t`` (K,), s: at most
    ``most`` steps for one output."""
    longest = np.inf
    if drive.shape[1]:
        steps = np.diff(t)
        steps = steps[steps > JUMP_TAKES * np.max(steps, initial=0.0)]  # not those within a jump
        longest = LONGEST_STEP * float(np.median(steps))
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


def jumps_of(t: Array, drive: Array, outputs: Array) -> Array:
    """Times (J,) in s inside the ``outputs`` (N,) at which the drive (K, D), SI, recorded at times
    ``t`` (K,), begins or ends a jump."""
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
    said = next(
        (said for flag, said in FLAGS.items() if flag in text), "gave up {span} and says not why"
    )
    return f"CVODES {said.format(span=span)}"


def culprits(model: Model) -> str:
    """The laws that switch at a point and so may chatter, as the end of a sentence."""
    expressions = [
        (f"elements.{element.name}", text)
        for element in model.elements
        for _, text in element.values
    ]
    expressions += [(f"states.{state.name}", state.rate) for state in model.states]
    words = {place: word for place, text in expressions if (word := switching_word(text))}
    if not words:
        return ""
    return (
        f"; {', '.join(words)} switches with {' and '.join(dict.fromkeys(words.values()))}, which "
        "chatters where the motion reverses: write it as kind 'friction', or with "
        "tanh(speed/transition)"
    )
