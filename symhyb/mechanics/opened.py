"""The equations of a model whose dry friction and stops are opened: their forces are inputs.

Behind the inputs u of the model come the *switches*, one after the other:

    sigma (F)   direction of each friction: +1, −1, or 0 where it holds
    hold  (F)   its force where it holds, N
    on    (S)   whether a stop presses: 0 or 1

    friction    F = hold + sigma·g(s')·(1 + sigma·asymmetry)          no tanh: exact
    stop        F = ±on·(stiffness·depth + damping·depth')            no max: one branch

Behind the sensors come the *watches*: the levels at which a friction breaks away forwards and
backwards (F pairs), and the depth of each stop and the force it would press with (S pairs).
"""

from dataclasses import replace

import sympy as sp

from symhyb.mechanics.equations import Equations, Term
from symhyb.mechanics.laws import ZERO, Law, Values, friction_level
from symhyb.mechanics.symbols import to_sympy
from symhyb.model.switching import Stop, frictions, stops
from symhyb.model.types import Model


def opened(model: Model, equations: Equations) -> Equations:
    """The same with the switches as further inputs and the watches as further outputs."""
    rubbing, touching = frictions(model), stops(model)
    sigma = [sp.Symbol(f"sigma({model.elements[i].name})", real=True) for i in rubbing]
    hold = [sp.Symbol(f"hold({model.elements[i].name})", real=True) for i in rubbing]
    on = [sp.Symbol(f"on({model.elements[s.element].name}.{s.side})", real=True) for s in touching]
    terms, watches = list(equations.terms), list[sp.Expr]()
    for i, way, force in zip(rubbing, sigma, hold, strict=True):
        term, values = _term(equations, i), _values(model, equations, i)
        lean = values.get("asymmetry", ZERO)
        slides = way * friction_level(term.r, values) * (1 + way * lean)
        terms[i] = replace(term, law=Law(force + slides))
        rest = friction_level(ZERO, values)
        watches += [rest * (1 + lean), rest * (1 - lean)]
    for i in dict.fromkeys(stop.element for stop in touching):
        sides = [(stop, mark) for stop, mark in zip(touching, on, strict=True) if stop.element == i]
        term, values = _term(equations, i), _values(model, equations, i)
        parts = [(stop, mark, *_press(term, values, stop)) for stop, mark in sides]
        force = sum((stop.sign * mark * press for stop, mark, _, press in parts), ZERO)
        terms[i] = replace(term, law=Law(force, term.law.stored))
        watches += [value for _, _, depth, press in parts for value in (depth, press)]
    symbols = replace(equations.symbols, u=(*equations.symbols.u, *sigma, *hold, *on))
    return replace(
        equations,
        symbols=symbols,
        terms=tuple(terms),
        outputs=(*equations.outputs, *watches),
    )


def _term(equations: Equations, i: int) -> Term:
    term = equations.terms[i]
    assert isinstance(term, Term)  # forces at points are not opened
    return term


def _values(model: Model, equations: Equations, i: int) -> Values:
    element = model.elements[i]
    scope = equations.symbols.within(element.name)
    return {key: to_sympy(expression, scope) for key, expression in element.values}


def _press(term: Term, values: Values, stop: Stop) -> tuple[sp.Expr, sp.Expr]:
    """Depth (m) of a contact and the force (N) that it presses with, while it does."""
    k, d, c = (values.get(key, ZERO) for key in ("stiffness", "damping", "clearance"))
    depth = stop.sign * term.s - c
    return depth, k * depth + d * stop.sign * term.r
