"""A model as named CasADi functions: M, k_c, k_e, the acceleration, outputs and energies.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t) + ΔF        (ΔF is a force that acts)

CasADi differentiates T and V; SymPy never does. Source of the form: Lagrange's equations with
p = ∂T/∂v, see docs/design.md.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.mechanics.equations import derive
from symhyb.model.types import Model
from symhyb.numeric.buffers import Array
from symhyb.numeric.translate import Lowered


@dataclass(frozen=True, slots=True)
class Machine:
    """A model lowered to CasADi; every number in coherent SI.

    Sizes: n coordinates, k inputs, m sensors, P parameters, E elements, N samples.

    Attributes:
        M: (q, t, p) -> (n, n) mass matrix.
        k_c: (q, v, t, p) -> (n,) Coriolis and gyroscopic forces.
        k_e: (q, v, u, t, p) -> (n,) applied forces, those of potentials included.
        input_matrix: (q, v, t, p) -> (n, k) with k_e = k_e(u=0) + input_matrix·u; None where an
            input acts nonlinearly.
        acceleration: (q, v, u, t, p, w) -> (n,) q'' under an extra generalized force w.
        outputs: (q, v, a, u, t, p) -> (m,) what the sensors record, without noise and delay.
        output_slopes: the same arguments -> (m, n) ∂y/∂q, ∂y/∂v and ∂y/∂a.
        discrepancy: (q, v, a, u, t, p) -> (n,) ΔF = M a + k_c − k_e.
        weak: (q, v, u, t, p) -> (n,) momentum p and (n,) ∂T/∂q + k_e, so that ΔF = p' − the latter.
        energy: (q, v, t, p) -> T, V, (E,) stored in the elements.
        elements: (q, v, u, t, p) -> (n, E) generalized force of each element.
        pathways: (q, v, t, p) -> (E,) stretch, (E,) rate, (n, E) direction ∂s/∂q; NaN at points.
        values: (P,) parameter values in the order of ``model.all_parameters()``.
    """

    model: Model
    M: ca.Function
    k_c: ca.Function
    k_e: ca.Function
    input_matrix: ca.Function | None
    acceleration: ca.Function
    outputs: ca.Function
    output_slopes: ca.Function
    discrepancy: ca.Function
    weak: ca.Function
    energy: ca.Function
    elements: ca.Function
    pathways: ca.Function
    values: Array

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.model.coordinates)

    def column(self, path: str) -> int:
        """Index of the parameter with this path in the vector p."""
        return [item.path for item in self.model.all_parameters()].index(path)


def build(model: Model) -> Machine:
    """Lower a checked model to a :class:`Machine`.

    Raises:
        InputError: the mass matrix is singular at the start; names the coordinates without mass.
    """
    low = _lowered(model)
    q, v, a, u, t, p = low.q, low.v, low.a, low.u, low.t, low.p
    n = q.numel()
    momentum = ca.gradient(low.kinetic, v)
    mass = ca.jacobian(momentum, v)
    k_c = ca.jtimes(momentum, q, v) + ca.jacobian(momentum, t) - ca.gradient(low.kinetic, q)
    forces = ca.horzcat(*low.forces) if low.forces else ca.SX(n, 0)
    k_e = -ca.gradient(low.potential, q) + ca.sum2(forces)
    w = ca.SX.sym("w", n)
    acceleration = solve_symmetric(mass, k_e + w - k_c)
    slope = ca.jacobian(k_e, u)
    linear = not ca.depends_on(slope, u)
    values = np.array([item.si for item in model.all_parameters()])
    machine = Machine(
        model=model,
        M=ca.Function("M", [q, t, p], [mass], ["q", "t", "p"], ["M"]),
        k_c=ca.Function("k_c", [q, v, t, p], [k_c], ["q", "v", "t", "p"], ["k_c"]),
        k_e=ca.Function("k_e", [q, v, u, t, p], [k_e], ["q", "v", "u", "t", "p"], ["k_e"]),
        input_matrix=ca.Function("input_matrix", [q, v, t, p], [slope]) if linear else None,
        acceleration=ca.Function(
            "acceleration", [q, v, u, t, p, w], [acceleration],
            ["q", "v", "u", "t", "p", "w"], ["a"],
        ),
        outputs=ca.Function("outputs", [q, v, a, u, t, p], [low.outputs]),
        output_slopes=ca.Function(
            "output_slopes", [q, v, a, u, t, p],
            [ca.densify(ca.jacobian(low.outputs, by)) for by in (q, v, a)],
        ),
        discrepancy=ca.Function(
            "discrepancy", [q, v, a, u, t, p], [ca.densify(ca.mtimes(mass, a) + k_c - k_e)]
        ),
        weak=ca.Function(
            "weak", [q, v, u, t, p],
            [ca.densify(momentum), ca.densify(ca.gradient(low.kinetic, q) + k_e)],
        ),
        energy=ca.Function(
            "energy", [q, v, t, p], [low.kinetic, low.potential, ca.vertcat(*low.stored)]
        ),
        elements=ca.Function("elements", [q, v, u, t, p], [forces]),
        pathways=ca.Function("pathways", [q, v, t, p], _pathways(low, n)),
        values=values,
    )  # fmt: skip
    _require_mass(machine)
    return machine


def solve_symmetric(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """Solve a symmetric positive definite system by LDLᵀ without pivoting (symbolically; about
    half of the instructions of CasADi's QR for eight coordinates)."""
    n = matrix.shape[0]
    lower = ca.SX.eye(n)
    pivots: list[ca.SX] = []
    for j in range(n):
        pivot = matrix[j, j] - sum((lower[j, k] ** 2 * pivots[k] for k in range(j)), ca.SX(0))
        pivots.append(pivot)
        for i in range(j + 1, n):
            cross = sum((lower[i, k] * lower[j, k] * pivots[k] for k in range(j)), ca.SX(0))
            lower[i, j] = (matrix[i, j] - cross) / pivot
    x = ca.SX(right)
    for i in range(n):
        for k in range(i):
            x[i, :] -= lower[i, k] * x[k, :]
    for i in range(n):
        x[i, :] = x[i, :] / pivots[i]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            x[i, :] -= lower[k, i] * x[k, :]
    return x


def _pathways(low: Lowered, n: int) -> list[ca.SX]:
    missing = (ca.SX(float("nan")), ca.SX(float("nan")), ca.SX.nan(n, 1))
    rows = [path or missing for path in low.pathways]
    if not rows:
        return [ca.SX(0, 1), ca.SX(0, 1), ca.SX(n, 0)]
    stretch, rate, direction = zip(*rows, strict=True)
    return [ca.vertcat(*stretch), ca.vertcat(*rate), ca.horzcat(*direction)]


def _lowered(model: Model) -> Lowered:
    try:
        return Lowered(derive(model))
    except TypeError as error:
        text = f"{error}: a place or an energy with min, max or sign has no smooth speed; use tanh"
        raise InputError(Problem(text, file=model.file)) from error


def _require_mass(machine: Machine) -> None:
    """Refuse a mass matrix that is singular or not positive definite at the start."""
    start = np.array([c.start * c.unit.factor for c in machine.model.coordinates])
    mass = np.atleast_2d(np.array(machine.M(start, 0.0, machine.values)))
    scale = np.sqrt(np.abs(np.diag(mass)))
    if not np.all(np.isfinite(mass)):
        text = "the mass matrix is not finite at the start; look for a division by zero"
        raise InputError(Problem(text, "bodies", machine.model.file))
    bare = [c.name for c, s in zip(machine.model.coordinates, scale, strict=True) if s == 0]
    if bare:
        text = (
            f"the mass matrix is singular: nothing that moves with {', '.join(bare)} has mass; "
            "give a body there a mass or an inertia"
        )
        raise InputError(Problem(text, "bodies", machine.model.file))
    balanced = mass / np.outer(scale, scale)
    values, vectors = np.linalg.eigh((balanced + balanced.T) / 2)
    if values[0] < 1e-10:
        worst = np.argsort(-np.abs(vectors[:, 0]))
        named = [machine.model.coordinates[i].name for i in worst if abs(vectors[i, 0]) > 0.3]
        text = (
            f"the mass matrix is singular or not positive definite in {', '.join(named)} "
            f"(smallest scaled eigenvalue {values[0]:.3g}); two coordinates may move one mass"
        )
        raise InputError(Problem(text, "bodies", machine.model.file))
