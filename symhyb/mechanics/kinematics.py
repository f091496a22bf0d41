"""Where things are and how they move: points, stretches and their rates."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.symbols import Symbols, to_sympy
from symhyb.model.expression import Expression
from symhyb.model.types import At, Between, Model, On, Place


@dataclass(frozen=True, slots=True)
class Pathway:
    """How a place is reached from the coordinates: ``stretch`` s, ``rate`` s' and ``direction``
    ∂s/∂q (n entries)."""

    stretch: sp.Expr
    rate: sp.Expr
    direction: tuple[sp.Expr, ...]


def position(model: Model, name: str, symbols: Symbols) -> tuple[sp.Expr, sp.Expr]:
    """The two components of a named point, m."""
    point = next(point for point in model.points if point.name == name)
    return located(point.at, symbols)


def located(at: tuple[Expression, Expression], symbols: Symbols) -> tuple[sp.Expr, sp.Expr]:
    """Two expressions as a position, m."""
    return to_sympy(at[0], symbols.scope), to_sympy(at[1], symbols.scope)


def rate_of(expression: sp.Expr, symbols: Symbols) -> sp.Expr:
    """Time derivative by the chain rule: ẋ = (∂x/∂q) q' + ∂x/∂t."""
    total = sp.diff(expression, symbols.t)
    for q, v in zip(symbols.q, symbols.v, strict=True):
        total += sp.diff(expression, q) * v
    return total


def gradient(expression: sp.Expr, symbols: Symbols) -> tuple[sp.Expr, ...]:
    """∂x/∂q, n entries."""
    return tuple(sp.diff(expression, q) for q in symbols.q)


def pathway(model: Model, place: Place, length: sp.Expr, symbols: Symbols) -> Pathway:
    """Stretch, rate and direction of a place with one stretch.

    On a coordinate s = q; between two points s = |b − a| − length:

        a o----/\\/\\/----o b        s > 0: pulled apart; a tension pulls them together

    Raises:
        TypeError: a place at a point, which has no stretch.
    """
    match place:
        case On(coordinate):
            index = [c.name for c in model.coordinates].index(coordinate)
            direction = tuple(sp.Integer(int(i == index)) for i in range(len(symbols.q)))
            return Pathway(symbols.q[index], symbols.v[index], direction)
        case Between(first, second):
            ax, ay = position(model, first, symbols)
            bx, by = position(model, second, symbols)
            distance = sp.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
            stretch = distance - length
            return Pathway(stretch, rate_of(distance, symbols), gradient(distance, symbols))
        case At():
            raise TypeError("a place at a point has no stretch")


def generalized(
    force: Sequence[sp.Expr], at: Sequence[sp.Expr], symbols: Symbols
) -> tuple[sp.Expr, ...]:
    """Generalized forces Q = (∂r/∂q)ᵀ F of a force vector F (N) acting at r (m), n entries."""
    return tuple(
        sum((f * sp.diff(r, q) for f, r in zip(force, at, strict=True)), sp.Integer(0))
        for q in symbols.q
    )
