"""A run, or a piece of one, by CVODES: BDF with Newton's method, or Adams by functional iteration.

Sizes: N outputs, X states, K samples of the drive, D entries of it, P parameters.

Source: Hindmarsh et al., SUNDIALS, ACM TOMS 31, 2005 (through ``casadi.integrator``).
"""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.linear import free_slope
from symhyb.numeric.runs.closing import closed_rows
from symhyb.numeric.runs.cvodes import (
    RELATIVE_TOLERANCE,
    SLOPES_BY_STATES,
    advanced,
    culprits,
    cvodes_options,
    driven,
    jumps_of,
    steps_of_output,
)
from symhyb.numeric.runs.scenario import LEFT, Scenario, within
from symhyb.numeric.runs.sizes import EARLY, ROUGH, rough_sizes

PIECES = 50  # of a run between which a bound is looked at
DAMPED = 10.0  # a decay this many times faster than it swings is stiff


def implicit_run(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array
) -> tuple[Array, str, str, str]:
    """States (N, X), SI, of a run by CVODES, why they end early, a note, and the method."""
    for method in ("bdf",) if is_stiff(form, scenario, drive, start, p) else ("adams", "bdf"):
        scales = scenario.scales
        if scales is None:
            scales = implicit_sizes(form, scenario, drive, start, p, method)
        x, reason = implicit_states(form, scenario, drive, start, p, scales, method)
        x, reason, note = closed_rows(form, scenario, drive, x, p, reason)
        if not reason or reason.startswith(LEFT):
            break
    return x, reason, note, method


def is_stiff(form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array) -> bool:
    """Whether the machine asks for BDF along a ``drive`` (K, D) from ``start`` (X,), SI: a law is
    steep, remembers or switches, or the machine linearised there has a decay that is fast against
    its swing and the samples of what is recorded."""
    model = form.machine.model
    if any(KINDS[element.kind].stiff for element in model.elements) or culprits(model):
        return True
    first = drive[0] if len(drive) else np.zeros(form.drive)
    matrix = free_slope(form, start, first, float(scenario.t[0]), p)
    if not np.isfinite(matrix).all():
        return True
    roots = np.linalg.eigvals(matrix)
    span = float(scenario.t[-1] - scenario.t[0]) or 1.0
    if form.drive:  # steps follow what is recorded
        span = min(span, float(np.median(np.diff(scenario.t_u))))
    swing = float(np.abs(roots.imag).max(initial=1 / span))
    return bool(-roots.real.min(initial=0.0) > DAMPED * max(swing, 1 / span))


def implicit_sizes(
    form: StateForm, scenario: Scenario, drive: Array, start: Array, p: Array, method: str
) -> Array:
    """Largest size of each state (X,), SI, in a rough run; where something recorded drives it, over
    all of it."""

    def run(t: Array, unit: Array) -> tuple[Array, bool]:
        rough = replace(scenario, t=t)
        x, reason = implicit_states(form, rough, drive, start, p, unit, method, ROUGH)
        return np.nanmax(np.abs(x), axis=0, initial=0.0), not reason

    return rough_sizes(scenario.t, start, run, (1.0,) if form.drive else (EARLY, 1.0))


def implicit_states(
    form: StateForm,
    scenario: Scenario,
    drive: Array,
    start: Array,
    p: Array,
    scales: Array,
    method: str,
    tolerance: float = RELATIVE_TOLERANCE,
    most: int = 0,
    doubtful: bool = False,
) -> tuple[Array, str]:
    """States (N, X), SI, and the reason why they end early; one integration between jumps of
    inputs, of at most ``most`` steps for an output. One that is ``doubtful`` goes by pieces that
    double: what fails soon has not cost much."""
    t = scenario.t
    jumps = jumps_of(scenario.t_u, drive, t)
    grid = np.union1d(t, jumps)  # an input may jump between two outputs
    marks = [0, *np.searchsorted(grid, jumps).tolist(), grid.size - 1]
    if doubtful:
        marks += [1 << i for i in range(int(grid.size - 1).bit_length())]
    if scenario.bound is not None:  # looked at between pieces of the run
        marks += np.linspace(0, grid.size - 1, PIECES).astype(int).tolist()
    rate = _rate(form, scenario, drive, scales)
    # finding a scale is no reason to work long, and a law that chatters never ends
    hopeless = tolerance >= ROUGH or bool(culprits(form.machine.model))
    most = most or steps_of_output(grid.size, hopeless)
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
        x[first : last + 1], reason = within(scenario.bound, span, x[first : last + 1])
        if reason:
            break
    return x[np.searchsorted(grid, t)], reason


def _rate(form: StateForm, scenario: Scenario, drive: Array, scales: Array) -> dict[str, Any]:
    """The equations for states divided by their scales."""
    x, d, t, p, w = form.symbols()
    f, full = len(form.free), x * scales
    slopes = form.rates()(full, d, t, p, 0 * w)
    ode = ca.densify(ca.vertcat(full[f : 2 * f, 0], slopes) / scales)
    return driven(ca.Function("ode", [x, d, t, p], [ode], SLOPES_BY_STATES), scenario.t_u, drive)
