"""Where things are: frames of bodies, points, and the stretch of a place.

Only positions are formed here. Speeds and directions follow by differentiation, which is CasADi's
work (:mod:`symhyb.numeric.translate`); :func:`rate_of` and :func:`gradient` serve people who read.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.symbols import Symbols, to_sympy
from symhyb.model.expression import Expression
from symhyb.model.types import Between, Body, Model, On, Place, Point

Vector = tuple[sp.Expr, sp.Expr]


@dataclass(frozen=True, slots=True)
class Frame:
    """The axes of a body: ``origin`` (m) and ``angle`` (rad) against the inertial axes."""

    origin: Vector
    angle: sp.Expr

    def place(self, local: Vector) -> Vector:
        r"""A position given in these axes, in the inertial ones:

        y ^   x' cos a − y' sin a        r = origin + R(a) r'
          |  /  angle a
          o--------> x
        """
        if self.angle == 0:
            return self.origin[0] + local[0], self.origin[1] + local[1]
        c, s = sp.cos(self.angle), sp.sin(self.angle)
        return (
            self.origin[0] + c * local[0] - s * local[1],
            self.origin[1] + s * local[0] + c * local[1],
        )


GROUND = Frame((sp.Integer(0), sp.Integer(0)), sp.Integer(0))


@dataclass(frozen=True, slots=True)
class Geometry:
    """Frames of the bodies, centres of mass and named points, m, by name."""

    frames: Mapping[str, Frame]
    centres: Mapping[str, Vector]
    points: Mapping[str, Vector]


def geometry(model: Model, symbols: Symbols) -> Geometry:
    """Place everything of a checked model; a chain of bodies is followed from the ground."""
    bodies = {body.name: body for body in model.bodies}
    declared = {point.name: point for point in model.points}
    frames: dict[str, Frame] = {}
    points: dict[str, Vector] = {}

    def frame(name: str) -> Frame:
        if name not in frames:
            frames[name] = _frame(bodies[name], symbols, frame)
        return frames[name]

    def point(item: Point) -> Vector:
        local = located(item.at, symbols)
        return frame(item.body).place(local) if item.body else local

    for name in bodies:
        frame(name)
    for name, item in declared.items():
        points[name] = point(item)
    centres = {
        name: frames[name].origin
        if body.joint is None
        else frames[name].place(located(body.at, symbols))
        for name, body in bodies.items()
    }
    return Geometry(frames, centres, points)


def _frame(body: Body, symbols: Symbols, frame: Callable[[str], Frame]) -> Frame:
    angle = sp.Integer(0) if body.angle is None else to_sympy(body.angle, symbols.scope)
    if body.joint is None:
        return Frame(located(body.at, symbols), angle)
    parent = frame(body.parent) if body.parent else GROUND
    return Frame(parent.place(located(body.joint, symbols)), parent.angle + angle)


def located(at: tuple[Expression, Expression], symbols: Symbols) -> Vector:
    """Two expressions as a position, m."""
    return to_sympy(at[0], symbols.scope), to_sympy(at[1], symbols.scope)


def stretch_of(model: Model, place: Place, places: Geometry, symbols: Symbols) -> sp.Expr:
    """What a place with one stretch measures, before its length is taken off.

    On a coordinate it is q; between two points their distance |b − a|:

        a o----/\\/\\/----o b        a tension pulls them together

    Raises:
        TypeError: a place at a point, which has no stretch.
    """
    match place:
        case On(coordinate):
            return symbols.q[[c.name for c in model.coordinates].index(coordinate)]
        case Between(first, second):
            return distance(places.points[first], places.points[second])
    raise TypeError("a place at a point has no stretch")


def distance(a: Vector, b: Vector) -> sp.Expr:
    """|b − a|, m."""
    return sp.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2)


def rate_of(expression: sp.Expr, symbols: Symbols) -> sp.Expr:
    """Time derivative by the chain rule: ẋ = (∂x/∂q) q' + ∂x/∂t."""
    total = sp.diff(expression, symbols.t)
    for q, v in zip(symbols.q, symbols.v, strict=True):
        total += sp.diff(expression, q) * v
    return total


def gradient(expression: sp.Expr, symbols: Symbols) -> tuple[sp.Expr, ...]:
    """∂x/∂q, n entries."""
    return tuple(sp.diff(expression, q) for q in symbols.q)
