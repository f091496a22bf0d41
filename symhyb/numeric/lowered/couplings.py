"""Which coordinates a machine couples, and how the coupling changes along them.

A force F(s, s') on the stretch s = q_i − r·q_j couples both coordinates:

    ∂k_e/∂q = −(∂F/∂s) d dᵀ,   ∂k_e/∂v = −(∂F/∂s') d dᵀ,   d = e_i − r·e_j

and where these entries change at all, they change along s alone: ∂/∂q_j = −r·∂/∂q_i.
"""

from dataclasses import dataclass

import casadi as ca

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, structure_of

STIFFNESS, DAMPING = 0, 1


@dataclass(frozen=True, slots=True, eq=False)
class Couplings:
    """At N states, SI: ``entries`` (2, N, n, n) of ∂k_e/∂q and of the symmetric part of ∂k_e/∂v
    (the other is gyroscopic); ``slopes`` (2, N, n, n, n) by q, those of the damping by v, in the
    last axis."""

    entries: Array
    slopes: Array


def couplings_of(machine: Machine, q: Array, v: Array, u: Array, t: Array) -> Couplings | None:
    """The couplings at places and speeds (N, n), inputs (N, k) and times (N,), SI, with inner
    states 0; None for a machine whose forces are not written out (a network)."""
    if not machine.k_e.is_a("SXFunction"):
        return None
    function = kept(("couplings", structure_of(machine.model)), lambda: _function(machine))
    given = q, v, u, t, machine.values
    entries, slopes = along(function, given, (4,), t.size)
    n = machine.n
    return Couplings(  # columns come first
        entries.reshape(t.size, 2, n, n).transpose(1, 0, 3, 2),
        slopes.reshape(t.size, n, 2, n, n).transpose(2, 0, 4, 3, 1),
    )


def _function(machine: Machine) -> ca.Function:
    n, k = machine.n, len(machine.model.inputs)
    q, v, u = ca.SX.sym("q", n), ca.SX.sym("v", n), ca.SX.sym("u", k)
    t, p = ca.SX.sym("t"), ca.SX.sym("p", machine.values.size)
    z = ca.SX.zeros(machine.inner_states)
    force = machine.k_e(q, v, z, u, t, p)
    damping = ca.jacobian(force, v)
    entries = [ca.vec(x) for x in (ca.jacobian(force, q), (damping + damping.T) / 2)]
    slopes = [ca.jacobian(x, by) for x, by in zip(entries, (q, v), strict=True)]
    results = [ca.densify(ca.vertcat(*entries)), ca.densify(ca.vertcat(*slopes))]
    return ca.Function("couplings", [q, v, u, t, p], results, {"cse": True})
