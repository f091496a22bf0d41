"""A machine linearised about a state: x' = A x + B d + …, y = C x + D d + …, in SI.

The state x = (q_free, v_free, z) and the drive d = (u, q_given, v_given, a_given) are those of
:mod:`symhyb.numeric.lowered.dynamics`. Sizes: X states, D drives, m sensors.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.memory import kept
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import tangent

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Linearised:
    """Slopes at one state, SI: ``A`` (X, X), ``B`` (X, D), ``C`` (m, X), ``D`` (m, D)."""

    A: Array
    B: Array
    C: Array
    D: Array

    def response(self, frequency: Array) -> Array:
        """The frequency response C (jω − A)⁻¹ B + D, (F, m, D), at ``frequency`` (F,) in Hz."""
        s = 2j * np.pi * frequency[:, None, None]
        inside = np.linalg.solve(s * np.eye(len(self.A)) - self.A, self.B.astype(complex))
        return np.asarray(self.C @ inside + self.D)


def linearised(form: StateForm, x: Array, d: Array, t: float, p: Array) -> Linearised:
    """The slopes of a machine at a state ``x`` (X,) under a drive ``d`` (D,), SI."""
    still = np.zeros(form.machine.n)
    parts = call(kept(("linearised", form.key), lambda: _slopes(form)), (x, d, t, p, still))
    return Linearised(*(part.T for part in parts))


def state_slope(form: StateForm, x: Array, d: Array, t: float, p: Array) -> Array:
    """∂x'/∂x (X, X) alone, SI."""
    function = kept(("state_slope", form.key), lambda: _slope(form))
    (matrix,) = call(function, (x, d, t, p, np.zeros(form.machine.n)))
    return matrix.T


def free_slope(form: StateForm, x: Array, d: Array, t: float, p: Array) -> Array:
    """∂x'/∂x in the directions that constraints leave free, SI; (X, X) without constraints."""
    matrix = state_slope(form, x, d, t, p)
    basis = free_basis(form, x, d, t, p)
    return matrix if basis is None else np.asarray(np.linalg.pinv(basis) @ matrix @ basis)


def free_basis(form: StateForm, x: Array, d: Array, t: float, p: Array) -> Array | None:
    """The directions (X, R), SI, in which a state may move; None where it may in all."""
    if not form.machine.constraints:
        return None
    q, v = form.motion(x[None], d[None])
    held = tangent(form.machine, q, v, np.array([t]), p, form.given).basis[0]
    inner = x.size - len(held)
    return np.block(
        [
            [held, np.zeros((len(held), inner))],
            [np.zeros((inner, held.shape[1])), np.eye(inner)],
        ]
    )


def linear(form: StateForm) -> bool:
    """Whether rates and outputs of a machine are linear in its state and its drive, and do not
    depend on time itself."""
    symbols = form.symbols()
    rates, both = form.rates()(*symbols), ca.vertcat(*symbols[:2])
    shown = ca.vertcat(rates, form.outputs()(*symbols)[0])
    bent = any(ca.which_depends(shown, both, 2, False))
    return not (bent or depends_on_time(form.machine))


def reached(form: StateForm) -> Mask:
    """Which sensor follows which drive (m, D), through the states or at once."""
    symbols, rates = _rates(form)
    x, d = symbols[:2]
    shown = form.outputs()(*symbols)[0]
    inner, pushed = _depends(rates, x), _depends(rates, d)
    for _ in range(x.numel()):
        pushed = pushed | (inner @ pushed)
    return np.asarray((_depends(shown, x) @ pushed) | _depends(shown, d))


def _depends(values: ca.SX, by: ca.SX) -> Mask:
    return np.asarray(ca.DM(ca.jacobian_sparsity(values, by), 1).full() != 0)


def energy_depends_on_time(machine: Machine) -> bool:
    """Whether masses or energies depend on time itself, and not through the motion alone."""
    return _on_time((machine.M, 1), (machine.k_c, 2), (machine.energy, 3))


def depends_on_time(machine: Machine) -> bool:
    """Whether masses, energies, forces or inner states depend on time itself."""
    return energy_depends_on_time(machine) or _on_time((machine.k_e, 4), (machine.inner, 4))


def _on_time(*functions: tuple[ca.Function, int]) -> bool:
    """Whether any output of these functions depends on the argument of this index, the time."""
    return any(
        function.jac_sparsity(out, time).nnz() > 0
        for function, time in functions
        for out in range(function.n_out())
        if function.nnz_out(out)
    )


def _rates(form: StateForm) -> tuple[list[ca.SX], ca.SX]:
    symbols = form.symbols()
    f, x = len(form.free), symbols[0]
    return list(symbols), ca.vertcat(x[f : 2 * f, 0], form.rates()(*symbols))


def _slope(form: StateForm) -> ca.Function:
    symbols, rates = _rates(form)
    return ca.Function("slope", symbols, [ca.densify(ca.jacobian(rates, symbols[0]))])


def _slopes(form: StateForm) -> ca.Function:
    symbols, rates = _rates(form)
    x, d = symbols[:2]
    y = form.outputs()(*symbols)[0]
    parts = [ca.densify(ca.jacobian(of, by)) for of in (rates, y) for by in (x, d)]
    return ca.Function("linearised", symbols, parts)
