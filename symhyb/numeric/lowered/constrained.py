"""Constraints in the equations of motion: closed loops by a stabilised formulation of index 1.

    M a + k_c = k_e + ΔF + Jᵀλ        J = ∂ċ/∂q', which is ∂c/∂q where there is a c
    J a + γ   = −2α ċ − α² c          c̈ = J a + γ;   nonholonomic: −α ċ

The reactions λ follow from the Schur complement J M⁻¹ Jᵀ by LDLᵀ, as M itself; the right-hand side
of the second line pulls what rounding and the integrator leave of c back to 0 (Baumgarte, Computer
Methods in Applied Mechanics and Engineering 1, 1972). Where a coordinate moves no mass of its own,
Jᵀ(J a + γ) = 0 is added to the first line, which changes no solution and makes the matrix regular
wherever the constraints do (augmented Lagrangian: Bayo and others, CMAME 71, 1988).
Sizes: n coordinates, f of them free, m rows of constraints.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca

if TYPE_CHECKING:  # they import SymPy, which takes half a second
    from symhyb.mechanics.constraints import Closure
    from symhyb.numeric.lowered.translate import Lowered

PULL = 20.0  # α, 1/s: what a step leaves of c is gone within a tenth of a second


@dataclass(frozen=True, slots=True)
class Loops:
    """The rows of constraints as SX: ``gap`` c, ``rate`` ċ and ``turn`` γ (m each), ``slope`` J
    (m, n), with their ``labels`` and the ``signs`` of their reactions as sensors show them. Of a
    nonholonomic row (``speeds``) ċ is the speed that it holds at zero, and c is 0."""

    gap: ca.SX
    rate: ca.SX
    slope: ca.SX
    turn: ca.SX
    labels: tuple[str, ...]
    signs: ca.DM
    speeds: tuple[int, ...] = ()

    def wanted(self, pulled: bool) -> ca.SX:
        """What J a has to be (m,)."""
        if not pulled:
            return -self.turn
        damped = [PULL if row in self.speeds else 2 * PULL for row in range(self.gap.numel())]
        return -self.turn - ca.DM(damped) * self.rate - PULL**2 * self.gap


def loops_of(
    low: "Lowered", rows: Sequence["Closure"], left_out: Sequence[str] = ()
) -> Loops | None:
    """Lower the rows that are not left out; None without any."""
    kept = [row for row in rows if row.label not in left_out]
    if not kept:
        return None
    gap = low.column([row.gap for row in kept])
    rate = low.rate(low.column([row.gap if row.slip is None else row.path for row in kept]))
    slips = [(i, row.slip) for i, row in enumerate(kept) if row.slip is not None]
    for (i, _), slip in zip(slips, ca.vertsplit(low.column([s for _, s in slips])), strict=True):
        rate[i] += slip
    signs = ca.DM([-1.0 if row.pulls else 1.0 for row in kept])
    labels = tuple(row.label for row in kept)
    slope, turn, speeds = ca.jacobian(rate, low.v), low.rate(rate), tuple(i for i, _ in slips)
    return Loops(gap, rate, slope, turn, labels, signs, speeds)


def lowered_closure(low: "Lowered", loops: Loops) -> dict[str, ca.Function]:
    """``closure``: (q, v, a, t, p) -> c, ċ, c̈ (m,), J and ∂ċ/∂q (m, n); ``closure_slopes``:
    (q, v, t, p) -> ∂c/∂p and ∂ċ/∂p (m, P)."""
    q, v, a, t, p = low.q, low.v, low.a, low.t, low.p
    bend = ca.mtimes(loops.slope, a) + loops.turn
    parts = [loops.gap, loops.rate, bend, loops.slope, ca.jacobian(loops.rate, q)]
    by_p = [ca.jacobian(loops.gap, p), ca.jacobian(loops.rate, p)]
    return {
        "closure": _function("closure", [q, v, a, t, p], parts),
        "closure_slopes": _function("closure_slopes", [q, v, t, p], by_p),
    }


def _function(name: str, arguments: list[ca.SX], results: list[ca.SX]) -> ca.Function:
    return ca.Function(name, arguments, [ca.densify(part) for part in results], {"cse": True})


@dataclass(frozen=True, slots=True)
class Solved:
    """Accelerations ``a`` (n,) and reactions ``load`` λ (m,) under them."""

    a: ca.SX
    load: ca.SX


def solve(
    mass: ca.SX,
    force: ca.SX,
    imposed: Sequence[int],
    given: ca.SX,
    loops: Loops | None,
    pulled: bool = True,
) -> Solved:
    """M a = f + Jᵀλ for the free coordinates, J a as the ``loops`` want it; those ``imposed`` have
    the accelerations ``given``."""
    n = mass.shape[0]
    free = [i for i in range(n) if i not in imposed]
    a = ca.SX(n, 1)
    for i, value in zip(imposed, ca.vertsplit(given), strict=True) if imposed else ():
        a[i] = value
    none = ca.SX(0, 1)
    if not free:
        return Solved(ca.densify(a), none)
    held = list(imposed)
    own, pull = mass[free, free], force[free]
    if held:
        pull = pull - ca.mtimes(mass[free, held], given)
    if loops is None:
        a[free] = solve_symmetric(own, pull)
        return Solved(ca.densify(a), none)
    slope, wanted = loops.slope[:, free], loops.wanted(pulled)
    if held:
        wanted = wanted - ca.mtimes(loops.slope[:, held], given)
    if ca.sprank(own) < len(free):  # a coordinate that moves no mass
        pull = pull + ca.mtimes(slope.T, wanted)
        own = own + ca.mtimes(slope.T, slope)
    both = solve_symmetric(own, ca.horzcat(pull, slope.T))
    alone, reply = both[:, 0], both[:, 1:]
    load = solve_symmetric(ca.mtimes(slope, reply), wanted - ca.mtimes(slope, alone))
    a[free] = alone + ca.mtimes(reply, load)
    return Solved(ca.densify(a), load)


def solve_symmetric(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """Solve a symmetric positive definite system by LDLᵀ without pivoting (symbolically; about
    half of the instructions of CasADi's QR for eight coordinates). What is zero by structure costs
    nothing: a machine falls into bodies that do not know each other."""
    n = matrix.shape[0]
    below: list[dict[int, ca.SX]] = []  # rows of L left of its diagonal, without zeros
    pivots: list[ca.SX] = []
    for i in range(n):
        row: dict[int, ca.SX] = {}
        for j in range(i):
            entry = matrix[i, j] - _product(row, below[j], pivots)
            if not entry.is_zero():
                row[j] = entry / pivots[j]
        below.append(row)
        pivots.append(matrix[i, i] - _product(row, row, pivots))
    x = ca.SX(right)
    for i in range(n):
        for k, factor in below[i].items():
            x[i, :] -= factor * x[k, :]
    for i in range(n):
        x[i, :] = x[i, :] / pivots[i]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            if i in below[k]:
                x[i, :] -= below[k][i] * x[k, :]
    return x


def _product(
    left: Mapping[int, ca.SX], right: Mapping[int, ca.SX], pivots: Sequence[ca.SX]
) -> ca.SX:
    common = (k for k in left if k in right)
    return sum((left[k] * right[k] * pivots[k] for k in common), ca.SX(0))
