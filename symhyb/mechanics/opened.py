"""The equations of a model whose dry friction and stops are opened: their forces are inputs.

Behind the inputs u of the model come the *switches*, one after the other:

    sigma (F)   direction of each friction: +1, −1, or 0 where it holds
    hold  (F)   its force where it holds, N
    on    (S)   whether a stop presses: 0 or 1
    side  (J)   on which side of a jump that is written: +1, −1, or between where it stays on it

    friction    F = hold + sigma·g(s, s')·(1 + sigma·asymmetry)          no tanh: exact
    stop        F = ±on·(stiffness·depth + damping·depth')            no max: one branch
    sign(g)     side

Behind the sensors come the *watches*: the levels at which a friction breaks away forwards and
backwards (F pairs), the depth of each stop and the force it would press with (S pairs), and the
argument g of each jump (J).

*Banded* equations are for solvers of other programs, which know neither forces that hold nor jumps:
a friction turns within its ``transition`` w along a straight line, and what is an input is the
*mode*. Behind the sensors comes, for each mode, the argument that decides it:

    friction      F = sigma·g(s, s')·(1 + sigma·asymmetry), sigma = mode + (1 − mode²)·s'/w
                  mode −1, 0, +1 by s'/w: below −1, between, above +1
    stop          F = ±touches·presses·(stiffness·depth + damping·depth'), modes 0 and 1
                  touches by depth, presses (with damping) by its force, in m
"""

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from symhyb.mechanics.equations import Acting, Couple, Equations, Mutual, Term, Turning, Vectorial
from symhyb.mechanics.laws import ZERO, Values, acting, friction_level, transition
from symhyb.mechanics.symbols import to_sympy
from symhyb.model.expression import Operation
from symhyb.model.jumps import jumps, written_jumps
from symhyb.model.switching import Stop, frictions, rubbing, stops
from symhyb.model.types import Model

TINY = sp.Float(1e-30)  # SI: keeps a stop without stiffness from a division by 0


def opened(model: Model, equations: Equations) -> Equations:
    """The same with the switches as further inputs and the watches as further outputs."""
    holding, touching = frictions(model), stops(model)
    sigma = [sp.Symbol(f"sigma({model.elements[i].name})", real=True) for i in holding]
    hold = [sp.Symbol(f"hold({model.elements[i].name})", real=True) for i in holding]
    on = [sp.Symbol(f"on({model.elements[s.element].name}.{s.side})", real=True) for s in touching]
    terms, watches = list(equations.terms), list[sp.Expr]()
    for i, way, force in zip(holding, sigma, hold, strict=True):
        term, values = _term(equations, i), _values(model, equations, i)
        lean = values.get("asymmetry", ZERO)
        slides = way * friction_level(term.s, term.r, values) * (1 + way * lean)
        terms[i] = replace(term, law=acting(force + slides))
        rest = friction_level(term.s, ZERO, values)
        watches += [rest * (1 + lean), rest * (1 - lean)]
    for i in dict.fromkeys(stop.element for stop in touching):
        sides = [(stop, mark) for stop, mark in zip(touching, on, strict=True) if stop.element == i]
        term, values = _term(equations, i), _values(model, equations, i)
        parts = [(stop, mark, *_press(term, values, stop)) for stop, mark in sides]
        force = sum((stop.sign * mark * press for stop, mark, _, press in parts), ZERO)
        terms[i] = replace(term, law=acting(force, term.law.stored))
        watches += [value for _, _, depth, press in parts for value in (depth, press)]
    whole = _with(equations, [*sigma, *hold, *on], terms, watches)
    return _on_sides(model, whole)


def levels(model: Model, equations: Equations) -> tuple[sp.Expr, ...]:
    """What each dry friction holds at most against a motion forwards and backwards, N, where its
    place moves as it does, and the rate within which its law turns over, m/s: three for each, in
    the order of :func:`symhyb.model.switching.frictions`."""
    found = list[sp.Expr]()
    for i in frictions(model):
        term, values = _term(equations, i), _values(model, equations, i)
        level, lean = friction_level(term.s, term.r, values), values.get("asymmetry", ZERO)
        found += [level * (1 + lean), level * (1 - lean), transition(values)]
    return tuple(found)


def banded(model: Model, equations: Equations) -> Equations:
    """The same with modes as further inputs and their arguments as further outputs, in the order
    of :func:`symhyb.model.switching.modes`."""
    terms, marks, arguments = list(equations.terms), list[sp.Symbol](), list[sp.Expr]()

    def mode(of: sp.Expr) -> sp.Symbol:
        marks.append(sp.Symbol(f"mode({len(marks)})", real=True))
        arguments.append(of)
        return marks[-1]

    for i in rubbing(model):
        term, values = _term(equations, i), _values(model, equations, i)
        share = term.r / transition(values)
        held = mode(share)
        sigma = held + (1 - held**2) * share
        sides = 1 + sigma * values.get("asymmetry", ZERO)
        terms[i] = replace(term, law=acting(friction_level(term.s, term.r, values) * sigma * sides))
    pressed: dict[int, sp.Expr] = {}
    for stop in stops(model):
        i = stop.element
        term, values = _term(equations, i), _values(model, equations, i)
        depth, press = _press(term, values, stop)
        on = mode(depth)
        if stop.damped:
            stiff = sum((values.get(key, ZERO) for key in ("stiffness", "damping")), ZERO)
            on *= mode(on * press / sp.Max(stiff, TINY) + 1 - on)
        pressed[i] = pressed.get(i, ZERO) + stop.sign * on * press
        terms[i] = replace(term, law=acting(pressed[i], term.law.stored))
    return _with(equations, marks, terms, arguments)


def _on_sides(model: Model, equations: Equations) -> Equations:
    """The same with every jump that is written on the side that an input says."""
    found, symbols = jumps(model), equations.symbols
    side = [sp.Symbol(f"side({i})", real=True) for i in range(len(found))]
    instead: dict[sp.Basic, sp.Expr] = {}
    for one in written_jumps(model):
        tree = Operation("sign", (one.argument,))
        for atom in to_sympy(tree, symbols.within(one.element)).atoms(sp.sign):
            way = one.way * to_sympy(tree, symbols.within(one.element)).coeff(atom)
            instead.setdefault(atom, way * side[one.jump])
    watches = [to_sympy(one.argument, symbols.within(one.element)) for one in found]

    def inside(parts: tuple[sp.Expr, ...]) -> tuple[sp.Expr, ...]:
        return tuple((ZERO + part).xreplace(instead) for part in parts)

    def on_side(term: Acting) -> Acting:
        if isinstance(term, Couple):
            return replace(term, torque=inside(term.torque))
        if isinstance(term, Mutual):
            first, second = inside(term.law.push)
            return replace(term, law=replace(term.law, push=(first, second)))
        if isinstance(term, Vectorial):
            return replace(term, force=inside(term.force))
        if isinstance(term, Turning):
            return term
        law = term.law
        (force, stored), inner = inside((law.force, law.stored)), inside(law.inner)
        return replace(term, law=replace(law, force=force, stored=stored, inner=inner))

    networks = {name: inside(seen) for name, seen in equations.networks.items()}
    rates, gravity = inside(equations.rates), inside(equations.gravity)
    whole = replace(equations, rates=rates, gravity=gravity, networks=networks)
    return _with(whole, side, [on_side(term) for term in equations.terms], inside(tuple(watches)))


def _with(
    equations: Equations,
    inputs: Sequence[sp.Symbol],
    terms: Sequence[Acting],
    outputs: Sequence[sp.Expr],
) -> Equations:
    symbols = replace(equations.symbols, u=(*equations.symbols.u, *inputs))
    shown = (*equations.outputs, *outputs)
    return replace(equations, symbols=symbols, terms=tuple(terms), outputs=shown)


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
