"""The rows of elements: the generalized force of each, and the rates of inner states.

Distances of points and speeds of points have names, as forces use them several times.
"""

from collections.abc import Iterator

import sympy as sp

from symhyb.mechanics.equations import Acting, Couple, Equations, Mutual, Term, Turning, Vectorial
from symhyb.mechanics.kinematics import stretch_of
from symhyb.mechanics.rows import Named, Row, Short, Slopes, product
from symhyb.mechanics.spinning import couple_force
from symhyb.mechanics.tidy import tidied
from symhyb.model.types import At, Between, Element, Model, On

LARGEST_TIDIED = 40  # operations of an expression in space
_POWERS = (1, 2, -1, -2, -3, -4)  # SymPy holds a distance d = √x in any power of x


def named_pathways(model: Model, equations: Equations, slopes: Slopes) -> tuple[Named, ...]:
    """The distances |b − a| between which elements sit, their rates, and the speeds of points that
    forces act against, each once. Along one line they need no name."""
    found: dict[str, Named] = {}
    for element, term in zip(model.elements, equations.terms, strict=True):
        for item in _names_of(model, element, term, equations, slopes):
            found.setdefault(item.symbol.name, item)
    return tuple(found.values())


def _names_of(
    model: Model,
    element: Element,
    term: Acting,
    equations: Equations,
    slopes: Slopes,
) -> Iterator[Named]:
    match element.place, term:
        case Between(first, second), Term():
            value = stretch_of(model, element.place, equations.places, equations.symbols)
            if value.has(sp.Pow) and slopes.rate(value) != 0:
                distance = sp.Symbol(f"|{second} - {first}|", positive=True)
                ends = (first, second)
                named = Named(distance, value, "distance", ends)
                yield named
                lapse = sp.Symbol(f"|{second} - {first}|'", real=True)
                lapsing = slopes.rate(value).xreplace(short_of((named,)))
                rate = _tidy(lapsing, len(equations.gravity))
                yield Named(lapse, rate, "lapse", ends)
        case At(point), Vectorial(law=law) if law is not None:
            velocity = _velocity(term, slopes)
            speed = _size(velocity)
            if isinstance(speed, sp.Pow):
                yield Named(sp.Symbol(f"|{point}'|", positive=True), speed, "speed", (point,))


def short_of(names: tuple[Named, ...]) -> Short:
    """What to replace in expressions: the distances, in every power, by their symbols."""
    return {
        item.value**power: item.symbol**power
        for item in names
        if item.kind == "distance"
        for power in _POWERS
    }


def force_rows(
    model: Model, equations: Equations, slopes: Slopes, names: tuple[Named, ...]
) -> Iterator[Row]:
    """Q = ±(∂s/∂q) F of every element on every coordinate; of a pair the sum of both."""
    short = short_of(names)
    for element, term in zip(model.elements, equations.terms, strict=True):
        source = f"elements.{element.name}"
        if isinstance(term, Couple):
            rates = equations.places.attitude(_turned_body(model, element)).rates
            turning = {symbol: slopes.rate(angle) for symbol, angle in rates}
            omega = tuple(part.xreplace(turning) for part in term.omega)
            for i, force in enumerate(couple_force(term.torque, omega, slopes)):
                yield Row("k_e", (i,), source, _tidy(force))
            continue
        if isinstance(term, Mutual):
            yield from _mutual_rows(source, term, equations, slopes)
            continue
        if isinstance(term, Turning):  # its inertia stands among those of bodies
            continue
        known = known_of(element, term, equations, slopes, names)
        if isinstance(term, Vectorial):
            force = [part.xreplace(known) for part in term.force]
            for i, by in enumerate(slopes.by):
                leans = [_tidy(by(part), len(term.position)) for part in term.position]
                yield Row("k_e", (i,), source, product(force, leans))
            continue
        push = term.sign * term.law.force.xreplace(known)
        for i, by in enumerate(slopes.by):
            lean = by(term.path).xreplace(short)
            plain = isinstance(element.place, On) and element.place.plain
            lean = lean if plain else _tidy(lean, len(equations.gravity))
            yield Row("k_e", (i,), source, push * lean)


def _mutual_rows(source: str, term: Mutual, equations: Equations, slopes: Slopes) -> Iterator[Row]:
    """What a law of a pair does on every coordinate that moves one of its stretches."""
    known = dict(zip(term.s, term.paths, strict=True))
    known |= {r: slopes.rate(path) for r, path in zip(term.r, term.paths, strict=True)}
    pushes = [push.xreplace(known) for push in term.law.push]
    for i, by in enumerate(slopes.by):
        leans = [_tidy(by(path), len(equations.gravity)) for path in term.paths]
        yield Row("k_e", (i,), source, product(pushes, leans))


def inner_rates(
    model: Model, equations: Equations, slopes: Slopes, names: tuple[Named, ...]
) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
    """The rate of every inner state, by its symbol."""
    for element, term in zip(model.elements, equations.terms, strict=True):
        if isinstance(term, Term) and term.law.inner:
            known, states = known_of(element, term, equations, slopes, names), equations.symbols.z
            for state, rate in zip(states[element.name], term.law.inner, strict=True):
                yield state, rate.xreplace(known)


def known_of(
    element: Element,
    term: Term | Vectorial,
    equations: Equations,
    slopes: Slopes,
    names: tuple[Named, ...],
) -> Short:
    """What the symbols in the law of an element stand for: s, s', a direction, a network."""
    found = {(item.kind, item.owners): item for item in names}
    if isinstance(term, Vectorial):
        assert isinstance(element.place, At)
        if term.law is None:  # a force as given, whatever the velocity
            return {}
        return _direction(term, slopes, found.get(("speed", (element.place.point,))))
    stretch, rate = term.path, slopes.rate(term.path)
    if isinstance(element.place, Between):
        ends = (element.place.first, element.place.second)
        distance = found.get(("distance", ends))
        if distance is not None:
            stretch = stretch.xreplace(short_of((distance,)))
            lapse = found["lapse", ends].symbol
            rate = lapse - slopes.rate(distance.value - term.path)  # a length may change with time
    known: Short = {term.s: stretch, term.r: rate}
    if term.hole is not None:
        several = len(equations.networks) > 1
        network = sp.Function(f"network.{element.name}" if several else "network", real=True)
        known[term.hole] = network(*equations.networks[element.name])
    return known


def _direction(term: Vectorial, slopes: Slopes, speed: Named | None) -> Short:
    """The direction and the speed of a point; a fixed point has neither."""
    velocity = _velocity(term, slopes)
    size = _size(velocity) if speed is None else speed.symbol
    if size == 0:
        return dict.fromkeys((term.r, *term.along), sp.Integer(0))
    ways = (part / size for part in velocity)
    return {term.r: size, **dict(zip(term.along, ways, strict=True))}


def _velocity(term: Vectorial, slopes: Slopes) -> tuple[sp.Expr, ...]:
    return tuple(_tidy(slopes.rate(part), len(term.position)) for part in term.position)


def _tidy(expression: sp.Expr, dimension: int = 3) -> sp.Expr:
    """A shorter form, in space of small expressions only: those of three rotations or a quaternion
    take minutes and become no shorter."""
    large = dimension == 3 and sp.count_ops(expression) > LARGEST_TIDIED
    return expression if large else tidied(expression)


def _size(vector: tuple[sp.Expr, ...]) -> sp.Expr:
    return sp.sqrt(sp.Add(*(part**2 for part in vector)))


def _turned_body(model: Model, element: Element) -> str:
    """The body on which a torque at a point acts."""
    assert isinstance(element.place, At)
    name = element.place.point
    return next(point.body for point in model.points if point.name == name)
