"""What SymPy's methods derived, reduced to kinetic and potential energy and generalized forces.

    d/dt ∂T/∂q' − ∂T/∂q = Q − ∂V/∂q

Of Lagrange's method L splits into T and V. Kane's equations M(q) u' = f with u = Y(q) q' + y₀ are,
projected by Y (virtual power), (YᵀMY) q'' = Yᵀ(f − M(Y' q' + y₀')), so that T = ½ q'ᵀ(YᵀMY) q';
Q is then what these equations hold beyond T.
Sizes: n coordinates.

Source: Kane & Levinson, Dynamics: Theory and Applications, 1985.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.physics.mechanics import KanesMethod, LagrangesMethod, dynamicsymbols
from sympy.physics.mechanics.system import System

from symhyb.errors import InputError, Problem

EXPANDED_MOST = 4000  # operations of an expression that is multiplied out, so that terms cancel


@dataclass(frozen=True, slots=True)
class Derived:
    """Coordinates ``q`` (n,) as functions of time, energies T and V, and ``forces`` (n,), in the
    units that the symbols are meant in."""

    q: tuple[sp.Expr, ...]
    kinetic: sp.Expr
    potential: sp.Expr
    forces: tuple[sp.Expr, ...]


def derived(method: object) -> Derived:
    """The energies and forces of a method whose equations are formed.

    Raises:
        InputError: another kind of object, equations that are not formed, or constraints.
    """
    if isinstance(method, System):
        if method.eom_method is None:
            raise _wrong("the equations of the System are not formed: call its form_eoms() first")
        method = method.eom_method
    if isinstance(method, LagrangesMethod):
        return _of_lagrange(method)
    if isinstance(method, KanesMethod):
        return _of_kane(method)
    kinds = "KanesMethod, LagrangesMethod or System of sympy.physics.mechanics"
    raise _wrong(f"a {type(method).__name__} is no {kinds}")


def _of_lagrange(method: Any) -> Derived:
    try:
        mass, forcing = method.mass_matrix, method.forcing
    except (ValueError, AttributeError):
        text = "the equations are not formed: call form_lagranges_equations() first"
        raise _wrong(text) from None
    q = tuple(method.q)
    _unconstrained(mass, len(q), "constraints of LagrangesMethod")
    t = dynamicsymbols._t
    rates = [coordinate.diff(t) for coordinate in q]
    # the Lagrangian is no public attribute; its part of second degree in q' is ½ q'ᵀ M q'
    lagrangian = sp.Matrix([method._L])[0]
    potential = -lagrangian.xreplace(dict.fromkeys(rates, sp.Integer(0)))
    kinetic = _short(lagrangian + potential)
    return Derived(q, kinetic, _short(potential), _beyond(q, kinetic, potential, mass, forcing))


def _of_kane(method: Any) -> Derived:
    try:
        mass, forcing = method.mass_matrix, method.forcing
        rates = method.kindiffdict()
    except (ValueError, AttributeError):
        raise _wrong("the equations are not formed: call kanes_equations() first") from None
    q, u = tuple(method.q), tuple(method.u)
    if len(q) != len(u):
        text = f"{len(q)} coordinates and {len(u)} speeds: constraints are not supported"
        raise _wrong(f"{text}; write them under [constraints] of a model file")
    _unconstrained(mass, len(q), "constraints of KanesMethod")
    t = dynamicsymbols._t
    of_speeds = sp.Matrix([rates[coordinate.diff(t)] for coordinate in q])
    solved = of_speeds.jacobian(sp.Matrix(u))
    if not solved.free_symbols.isdisjoint(u) or solved.det() == 0:
        raise _wrong("the kinematic equations are not linear in the speeds, or not solvable")
    # q' = N u + n0, so that u = Y q' + y0
    Y = solved.inv()
    rest = of_speeds.xreplace(dict.fromkeys(u, sp.Integer(0)))
    of_rates = (Y * (sp.Matrix([c.diff(t) for c in q]) - rest)).applyfunc(_short)
    given = dict(zip(u, of_rates, strict=True))
    mass, forcing = mass.subs(given), forcing.subs(given)
    own = of_rates.diff(t)
    second = {coordinate.diff(t, 2): sp.Integer(0) for coordinate in q}
    projected = Y.T * (forcing - mass * own.subs(second))
    square = (Y.T * mass * Y).applyfunc(_short)
    v = sp.Matrix([c.diff(t) for c in q])
    kinetic = _short((v.T * square * v)[0] / 2)
    zero = sp.Integer(0)
    return Derived(q, kinetic, zero, _beyond(q, kinetic, zero, square, projected))


def _beyond(
    q: Sequence[sp.Expr], kinetic: sp.Expr, potential: sp.Expr, mass: sp.Matrix, forcing: sp.Matrix
) -> tuple[sp.Expr, ...]:
    """The generalized forces (n,) that the equations M q'' = f hold beyond T and V."""
    t = dynamicsymbols._t
    second = {coordinate.diff(t, 2): sp.Integer(0) for coordinate in q}
    found = []
    for i, coordinate in enumerate(q):
        rate = coordinate.diff(t)
        inertia = kinetic.diff(rate).diff(t).subs(second) - kinetic.diff(coordinate)
        found.append(_short(forcing[i] + inertia + potential.diff(coordinate)))
    if _short(sp.Matrix(mass - mass.T)) != sp.zeros(*mass.shape):
        raise _wrong("the mass matrix is not symmetric, so that no kinetic energy belongs to it")
    return tuple(found)


def _short(expression: Any) -> Any:
    """An expression or matrix, multiplied out so that terms cancel, where it is not too long."""
    if isinstance(expression, sp.MatrixBase):
        return expression.applyfunc(_short)
    if expression.count_ops() > EXPANDED_MOST:
        return expression
    full = sp.expand(expression)
    plain = sp.expand(sp.trigsimp(full)) if full.count_ops() < EXPANDED_MOST / 10 else full
    return min((expression, full, plain), key=lambda one: one.count_ops())


def _unconstrained(mass: sp.Matrix, size: int, what: str) -> None:
    if mass.shape != (size, size):
        text = f"{what} are not supported; write them under [constraints] of a model file"
        raise _wrong(text)


def _wrong(text: str) -> InputError:
    return InputError(Problem(text, "method"))
