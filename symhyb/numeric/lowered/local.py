"""Equations beside a measured motion (:class:`symhyb.model.local.Local`) as CasADi expressions.

    M(t) q'' = c(t) + K(t) q + D(t) q' + B(t) u + forces of elements

What varies with time comes in as inputs. Sizes: n coordinates.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca

from symhyb.model.local import Local, LocalTerm
from symhyb.model.types import Model

if TYPE_CHECKING:
    from symhyb.numeric.lowered.translate import Lowered


@dataclass(frozen=True, slots=True)
class Beside:
    """What they add to a machine, SI: the ``kinetic`` energy ½ q'ᵀM q', the generalized
    ``force`` (n, 1), and ``swelling`` (n, 1), the part (∂M/∂t) q' of the change of momentum."""

    kinetic: ca.SX
    force: ca.SX
    swelling: ca.SX


def beside(low: "Lowered", model: Model, local: Local) -> Beside:
    """Local equations in the symbols of a machine."""
    n = low.q.numel()
    mass, swelling, force = ca.SX.zeros(n, n), ca.SX.zeros(n, n), ca.SX.zeros(n, 1)
    columns = {item.name: low.u[i] for i, item in enumerate(model.inputs)}
    paths = {item.path: low.p[i] for i, item in enumerate(model.all_parameters())}
    nominal = dict(local.nominal)

    def size(term: LocalTerm) -> ca.SX:
        value = ca.SX(term.value) + (columns[term.column] if term.column else 0)
        return value * (paths[term.path] - nominal[term.path]) if term.path else value

    signals = low.inputs()
    for term in local.terms:
        match term.kind:
            case "mass":
                mass[term.row, term.by] += size(term)
            case "mass rate":
                swelling[term.row, term.by] += size(term)
            case "force":
                force[term.row] += size(term)
            case "place":
                force[term.row] += size(term) * low.q[term.by]
            case "rate":
                force[term.row] += size(term) * low.v[term.by]
            case "input":
                force[term.row] += size(term) * signals[term.by]
    kinetic = ca.dot(low.v, ca.mtimes(mass, low.v)) / 2
    return Beside(kinetic, force, ca.mtimes(swelling, low.v))


def nominal(expressions: list[ca.SX], u: ca.SX) -> list[ca.SX]:
    """Expressions where no column of local equations adds to the values about which it counts."""
    return ca.substitute(expressions, [u], [ca.SX.zeros(u.numel())])
