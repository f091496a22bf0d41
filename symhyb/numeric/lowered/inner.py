"""Declared states and inner states of elements (hysteresis, pre-sliding, relaxation) along a motion
that is given."""

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from symhyb.model.unsampled import require_unsampled
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.dynamics import StateForm, inner_form
from symhyb.numeric.lowered.machine import Machine, structure_of
from symhyb.numeric.lowered.steps import rosenbrock_step

SUBSTEPS = 2  # between two samples
CHUNK = 50_000  # samples at once
SETTLING = 50  # Newton steps
SETTLED = 1e-6  # of the largest step: one that no longer matters


def inner_along(
    machine: Machine,
    t: Array,
    motion: tuple[Array, Array, Array],
    u: Array,
    p: Array,
    off: Array | float = 0.0,
) -> Array:
    """Inner states (N, z) at times ``t`` (N,), settled at first, SI; for several sets of parameters
    (C, N, z). Declared states begin at what they settle to (:func:`settled`).

    ``motion`` are q, v and a (N, n), ``u`` (N, k) the inputs, ``p`` (P,) or (C, P) the parameters;
    between two samples they run linearly. ``off`` (z,) or (C, z) is added to where they begin.
    """
    require_unsampled(machine.model, "an estimation from recordings")
    sets, inner = np.atleast_2d(p), machine.inner_states
    if inner == 0 or t.size == 0:
        return np.zeros((*p.shape[:-1], t.size, inner))
    form = inner_form(machine)
    drive = form.driven(u, *motion)
    here = motion[0][0], motion[1][0], u[0], float(t[0])
    run, acting = kept(("inner", form.key), lambda: _chains(form))
    first = np.array([settled(machine, *here, row)[0] for row in sets]) + off
    state = np.concatenate([first, sets[:, acting]], axis=1)
    parts = [state[:, None, :inner]]
    for begin in range(0, t.size - 1, CHUNK):
        rows = slice(begin, begin + CHUNK + 1)
        states = _stepped(run, t[rows], drive[rows], state)
        state = states[:, -1]
        parts.append(states[:, SUBSTEPS - 1 :: SUBSTEPS, :inner].copy())
    z = np.concatenate(parts, axis=1)
    return z if p.ndim == 2 else z[0]


def settled(
    machine: Machine, q: Array, v: Array, u: Array, t: float, p: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Where states (z,) begin in a recording, SI, and which of them settled there.

    Inner states of elements begin at rest. Declared states begin at what they settle to under a
    motion and inputs that stay as they are. States that act on each other settle together, if they
    decay, their eigenvalues left of the imaginary axis; the others, integrators for one, have no
    such value and begin at their start.
    """
    z = call(machine.inner_rest, (q, v, t, p))[0].reshape(-1).copy()
    count, found = len(machine.model.states), np.zeros(z.size, dtype=bool)
    if not count:
        return z, found
    slope = kept(("slope of states", structure_of(machine.model)), lambda: _slope(machine))
    begin, largest = z.copy(), 0.0
    for _ in range(SETTLING):
        rate, by_z = call(slope, (q, v, z, u, t, p))
        matrix, rate = by_z.T[:count, :count], rate.reshape(-1)[:count]
        if not (np.isfinite(matrix).all() and np.isfinite(rate).all()):
            return begin, np.zeros_like(found)
        decays = _decaying(matrix)
        found[:count] = decays
        step = np.zeros(count)
        step[decays] = np.linalg.solve(matrix[np.ix_(decays, decays)], rate[decays])
        z[:count] -= step
        largest = max(largest, float(np.abs(step).max()))
        if np.abs(step).max() <= SETTLED * largest:
            return z, found
    return begin, np.zeros_like(found)


def _decaying(matrix: Array) -> NDArray[np.bool_]:
    """Which states decay (S,), by the slopes of their rates (S, S): all of a group that acts on
    itself, or none of it."""
    decays = np.zeros(len(matrix), dtype=bool)
    groups = connected_components(matrix != 0, connection="strong")[1]
    for group in range(groups.max() + 1):
        rows = groups == group
        decays[rows] = np.linalg.eigvals(matrix[np.ix_(rows, rows)]).real.max() < 0
    return decays


def _slope(machine: Machine) -> ca.Function:
    """(q, v, z, u, t, p) -> the rates of z (z,) and their slopes by z (z, z)."""
    function = machine.inner
    given = [function.sx_in(i) for i in range(function.n_in())]
    rates = function(*given)
    slopes = ca.densify(ca.jacobian(rates, given[2]))
    return ca.Function("slope_of_states", given, [ca.densify(rates), slopes])


def _stepped(run: Chains, t: Array, drive: Array, start: Array) -> Array:
    """Inner states with their parameters (C, steps, z + A) from ``start`` (C, z + A) along times
    (N,) and what drives them (N, d), SI."""
    parts = np.linspace(0, 1, SUBSTEPS, endpoint=False)
    begin = (t[:-1, None] + parts * np.diff(t)[:, None]).reshape(-1)
    rise = np.diff(drive, axis=0)[:, None] / SUBSTEPS
    d0 = (drive[:-1, None] + np.arange(SUBSTEPS)[:, None] * rise).reshape(begin.size, -1)
    d1 = d0 + np.repeat(rise[:, 0], SUBSTEPS, axis=0)
    h = np.repeat(np.diff(t) / SUBSTEPS, SUBSTEPS)
    varying = [
        np.broadcast_to(row, (len(start), *row.shape))
        for row in (d0, d1, begin[:, None], h[:, None])
    ]
    (states,) = run(start, varying, np.zeros(0))
    return np.asarray(states)


def _chains(form: StateForm) -> tuple[Chains, list[int]]:
    """((z, p), d0, d1, t, h, nothing) -> (z, p) after h seconds along chains, each of which has
    parameters of its own: those that act on inner states, by their columns (A,)."""
    x, d0, t, p, _ = form.symbols()
    d1, h, nothing = ca.SX.sym("d1", form.drive), ca.SX.sym("h"), ca.SX.sym("nothing", 0)
    after = rosenbrock_step(form)(x, d0, d1, t, h, p)
    met = {symbol.element_hash() for symbol in ca.symvar(after)}
    acting = [i for i in range(form.machine.values.size) if p[i].element_hash() in met]
    own = p[acting]
    both = ca.densify(ca.vertcat(after, own))
    given = [ca.vertcat(x, own), d0, d1, t, h, nothing]
    return Chains(ca.Function("inner_step", given, [both], {"cse": True})), acting
