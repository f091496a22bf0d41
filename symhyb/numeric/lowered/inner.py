"""Inner states of elements (hysteresis, pre-sliding, relaxation) along a motion that is given."""

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.dynamics import StateForm, inner_form
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.steps import rosenbrock_step

SUBSTEPS = 2  # between two samples
CHUNK = 50_000  # samples at once


def inner_along(
    machine: Machine, t: Array, motion: tuple[Array, Array, Array], u: Array, p: Array
) -> Array:
    """Inner states (N, z) at times ``t`` (N,), begun at rest, SI; for several sets of parameters
    (C, N, z).

    ``motion`` are q, v and a (N, n), ``u`` (N, k) the inputs, ``p`` (P,) or (C, P) the parameters;
    between two samples they run linearly.
    """
    sets, inner = np.atleast_2d(p), machine.inner_states
    if inner == 0 or t.size == 0:
        return np.zeros((*p.shape[:-1], t.size, inner))
    form = inner_form(machine)
    drive = form.driven(u, *motion)
    first = [call(machine.inner_rest, (motion[0][0], float(t[0]), row))[0][0] for row in sets]
    state = np.concatenate([np.array(first), sets], axis=1)
    parts = [state[:, None, :inner]]
    for begin in range(0, t.size - 1, CHUNK):
        rows = slice(begin, begin + CHUNK + 1)
        states = _stepped(form, t[rows], drive[rows], state)
        state = states[:, -1]
        parts.append(states[:, SUBSTEPS - 1 :: SUBSTEPS, :inner].copy())
    z = np.concatenate(parts, axis=1)
    return z if p.ndim == 2 else z[0]


def _stepped(form: StateForm, t: Array, drive: Array, start: Array) -> Array:
    """Inner states with their parameters (C, steps, z + P) from ``start`` (C, z + P) along times
    (N,) and what drives them (N, d), SI."""
    parts = np.linspace(0, 1, SUBSTEPS, endpoint=False)
    begin = (t[:-1, None] + parts * np.diff(t)[:, None]).reshape(-1)
    rise = np.diff(drive, axis=0)[:, None] / SUBSTEPS
    d0 = (drive[:-1, None] + np.arange(SUBSTEPS)[:, None] * rise).reshape(begin.size, -1)
    d1 = d0 + np.repeat(rise[:, 0], SUBSTEPS, axis=0)
    h = np.repeat(np.diff(t) / SUBSTEPS, SUBSTEPS)
    run = kept(("inner", form.key), lambda: Chains(_step(form)))
    varying = [
        np.broadcast_to(row, (len(start), *row.shape))
        for row in (d0, d1, begin[:, None], h[:, None])
    ]
    (states,) = run(start, varying, np.zeros(0))
    return np.asarray(states)


def _step(form: StateForm) -> ca.Function:
    """((z, p), d0, d1, t, h, nothing) -> (z, p) after h seconds: every chain has parameters of its
    own."""
    x, d0, t, p, _ = form.symbols()
    d1, h, nothing = ca.SX.sym("d1", form.drive), ca.SX.sym("h"), ca.SX.sym("nothing", 0)
    after = rosenbrock_step(form)(x, d0, d1, t, h, p)
    both = ca.densify(ca.vertcat(after, p))
    return ca.Function(
        "inner_step", [ca.vertcat(x, p), d0, d1, t, h, nothing], [both], {"cse": True}
    )
