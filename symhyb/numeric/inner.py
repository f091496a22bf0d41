"""Inner states of elements (hysteresis, pre-sliding, relaxation) along a motion that is given."""

import casadi as ca
import numpy as np

from symhyb.numeric.buffers import Array, call
from symhyb.numeric.chains import Chains
from symhyb.numeric.dynamics import StateForm, inner_form
from symhyb.numeric.machine import Machine
from symhyb.numeric.memory import kept
from symhyb.numeric.steps import rosenbrock_step

SUBSTEPS = 4  # between two samples


def inner_along(
    machine: Machine, t: Array, motion: tuple[Array, Array, Array], u: Array, p: Array
) -> Array:
    """Inner states (N, z) at times ``t`` (N,), begun at rest, SI.

    ``motion`` are q, v and a (N, n), ``u`` (N, k) the inputs, ``p`` (P,) the parameters; between
    two samples they run linearly.
    """
    if machine.inner_states == 0 or t.size == 0:
        return np.zeros((t.size, machine.inner_states))
    form = inner_form(machine)
    drive = form.driven(u, *motion)
    (first,) = call(machine.inner_rest, (motion[0][0], float(t[0]), p))
    parts = np.linspace(0, 1, SUBSTEPS, endpoint=False)
    begin = (t[:-1, None] + parts * np.diff(t)[:, None]).reshape(-1)
    rise = np.diff(drive, axis=0)[:, None] / SUBSTEPS
    d0 = drive[:-1, None] + np.arange(SUBSTEPS)[:, None] * rise
    d1 = (d0 + rise).reshape(begin.size, -1)
    h = np.repeat(np.diff(t) / SUBSTEPS, SUBSTEPS)
    run = kept(("inner", form.key), lambda: Chains(_step(form)))
    varying = (d0.reshape(1, begin.size, -1), d1[None], begin[None, :, None], h[None, :, None])
    (z,) = run(first.reshape(1, -1), varying, p)
    return np.concatenate([first.reshape(1, -1), z[0, SUBSTEPS - 1 :: SUBSTEPS]])


def _step(form: StateForm) -> ca.Function:
    """(z, d0, d1, t, h, p) -> z after h seconds."""
    x, d0, t, p, w = form.symbols()
    d1, h = ca.SX.sym("d1", form.drive), ca.SX.sym("h")
    after = rosenbrock_step(form)(x, d0, d1, t, h, p, 0 * w)
    return ca.Function("inner_step", [x, d0, d1, t, h, p], [ca.densify(after)], {"cse": True})
