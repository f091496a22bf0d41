"""How a simulated run depends on its start and its parameters: the variational equations by CVODES.

    S' = (∂f/∂x) S + ∂f/∂p        integrated beside x' = f(x, u, t, p), under the same error control

Source: Hindmarsh & Serban, CVODES user documentation, forward sensitivity analysis (the staggered
form is not used: state and sensitivities are one system).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import StateForm, state_form
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.integrate import Trajectory, simulate, solve_system
from symhyb.numeric.runs.scenario import Scenario


@dataclass(frozen=True, slots=True)
class Sensitivities:
    """A run with its slopes, SI, for states x = (q_free, v_free, z) of length X and F parameters:
    ``by_start`` (N, X, X) and ``by_free`` (N, X, F); NaN behind a failure, whose reason the
    ``run`` states."""

    run: Trajectory
    by_start: Array
    by_free: Array


def sensitivities(
    machine: Machine, scenario: Scenario, free: Sequence[int], p: Array | None = None
) -> Sensitivities:
    """Simulate with the slopes of the states by their start and by the parameters ``free``
    (F indices into ``p`` (P,), SI), at the output times of the scenario.

    Raises:
        ValueError: as :func:`symhyb.numeric.runs.integrate.simulate`.
    """
    values = machine.values if p is None else np.asarray(p, dtype=float)
    run = simulate(machine, scenario, values)
    form = state_form(machine)
    x = form.state(run.q, run.v, run.z)
    size, count = form.size, len(free)
    reach = np.nanmax(np.abs(x), axis=0, initial=0.0)
    scales = np.where(reach > 0, reach, 1.0)
    steps = np.array([abs(values[i]) or 1.0 for i in free])
    weight = np.concatenate([scales, steps])
    start = np.concatenate([x[0] / scales, np.eye(size, size + count).ravel(order="F")])
    rows, _ = solve_system(
        form,
        replace(scenario, scales=scales),
        _variational(form, scales, free, steps),
        start,
        values,
    )
    slopes = rows[:, size:].reshape(len(rows), size + count, size).swapaxes(1, 2)
    slopes = slopes * scales[:, None] / weight
    return Sensitivities(run, slopes[:, :, :size], slopes[:, :, size:])


def _variational(form: StateForm, scales: Array, free: Sequence[int], steps: Array) -> ca.Function:
    """(y, d, t, p) -> y' for y = (x, S) with states over their scales and S over those too."""
    x, d, t, p, w = form.symbols()
    f, count = len(form.free), len(free)
    slope = ca.SX.sym("S", form.size, form.size + count)
    full = x * scales
    rates = form.rates()(full, d, t, p, ca.SX.zeros(w.numel()))
    rate = ca.vertcat(full[f : 2 * f, 0], rates) / scales
    forced = ca.horzcat(
        ca.SX(form.size, form.size), ca.jacobian(rate, p)[:, list(free)] @ ca.diag(steps)
    )
    moved = ca.mtimes(ca.jacobian(rate, x), slope) + forced
    both = ca.densify(ca.vertcat(rate, ca.vec(moved)))
    return ca.Function(
        "variational", [ca.vertcat(x, ca.vec(slope)), d, t, p], [both], {"cse": True}
    )
