"""From a model to its energies and generalized forces in SymPy.

Only T, V and the forces of the elements are built here. M, k_c and k_e follow by differentiation:
numerically in CasADi (:mod:`symhyb.numeric.machine`), readably in :mod:`symhyb.mechanics.show`.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t) + ΔF,   p = ∂T/∂v,  M = ∂p/∂v,
    k_c = (∂p/∂q) v + ∂p/∂t − ∂T/∂q,   k_e = Σ Q − ∂V/∂q
"""

from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.kinematics import Pathway, generalized, located, pathway, position, rate_of
from symhyb.mechanics.laws import law_of
from symhyb.mechanics.symbols import Symbols, symbols_of, to_sympy
from symhyb.model.types import At, Element, Model, On
from symhyb.model.vocabulary import KINDS


@dataclass(frozen=True, slots=True)
class Term:
    """What one element adds: generalized forces Q (n), stored energy, and its pathway
    (None for a force at a point)."""

    element: str
    forces: tuple[sp.Expr, ...]
    stored: sp.Expr
    pathway: Pathway | None


@dataclass(frozen=True, slots=True)
class Equations:
    """A model in SymPy: kinetic energy T, potential V (gravity and declared), one term an
    element, and one output a sensor (m), all in coherent SI."""

    symbols: Symbols
    kinetic: sp.Expr
    potential: sp.Expr
    terms: tuple[Term, ...]
    outputs: tuple[sp.Expr, ...]


def derive(model: Model) -> Equations:
    """Build energies, generalized forces and outputs of a checked model."""
    symbols = symbols_of(model)
    kinetic, potential = sp.Integer(0), sp.Integer(0)
    for body in model.bodies:
        x, y = located(body.at, symbols)
        mass = to_sympy(body.mass, symbols.scope)
        kinetic += mass * (rate_of(x, symbols) ** 2 + rate_of(y, symbols) ** 2) / 2
        if body.inertia is not None and body.angle is not None:
            spin = rate_of(to_sympy(body.angle, symbols.scope), symbols)
            kinetic += to_sympy(body.inertia, symbols.scope) * spin**2 / 2
        if model.gravity is not None:
            gx, gy = located(model.gravity, symbols)
            potential -= mass * (gx * x + gy * y)
    if model.energy.kinetic is not None:
        kinetic += to_sympy(model.energy.kinetic, symbols.scope)
    if model.energy.potential is not None:
        potential += to_sympy(model.energy.potential, symbols.scope)
    terms = tuple(_term(model, element, symbols) for element in model.elements)
    return Equations(symbols, kinetic, potential, terms, _outputs(model, symbols))


def _term(model: Model, element: Element, symbols: Symbols) -> Term:
    scope = symbols.within(element.name)
    values = {key: to_sympy(expression, scope) for key, expression in element.values}
    if isinstance(element.place, At):
        force = (values.get("force.x", sp.Integer(0)), values.get("force.y", sp.Integer(0)))
        where = position(model, element.place.point, symbols)
        return Term(element.name, generalized(force, where, symbols), sp.Integer(0), None)
    length = values.pop("length", sp.Integer(0))
    path = pathway(model, element.place, length, symbols)
    law = law_of(element, path.stretch, path.rate, values)
    pushes = KINDS[element.kind].energy == "active" and isinstance(element.place, On)
    sign = 1 if pushes else -1
    forces = tuple(sign * direction * law.force for direction in path.direction)
    return Term(element.name, forces, law.stored, path)


def _outputs(model: Model, symbols: Symbols) -> tuple[sp.Expr, ...]:
    """recorded = gain·true + offset; a delay is applied in time, not here."""
    p = dict(zip((item.path for item in model.all_parameters()), symbols.p, strict=True))
    outputs = []
    for sensor in model.sensors:
        value = to_sympy(sensor.measures, symbols.scope)
        if sensor.gain is not None:
            value = p[sensor.gain.path] * value
        if sensor.offset is not None:
            value = value + p[sensor.offset.path]
        outputs.append(value)
    return tuple(outputs)
