"""Where things are: frames of bodies, points, and the stretch of a place.

Only positions are formed here. Speeds and directions follow by differentiation, which is CasADi's
work (:mod:`symhyb.numeric.lowered.translate`); :func:`rate_of` and :func:`gradient` serve people
who read.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.attitude import Attitude, Vector, across, along, turned, turns_of
from symhyb.mechanics.symbols import Symbols, to_sympy
from symhyb.model.expression import Expression
from symhyb.model.space import dimension
from symhyb.model.types import Between, Body, Model, On, Place, Point


@dataclass(frozen=True, slots=True)
class Frame:
    """The axes of a body: ``origin`` (m) and ``angle`` (rad) against the inertial axes; in space
    the ``attitude`` instead of the angle."""

    origin: Vector
    angle: sp.Expr
    attitude: Attitude | None = None

    def place(self, local: Vector) -> Vector:
        r"""A position given in these axes, in the inertial ones:

        y ^   x' cos a − y' sin a        r = origin + R(a) r'
          |  /  angle a
          o--------> x
        """
        if self.attitude is not None:
            shifted = zip(self.origin, along(self.attitude.axes, local), strict=True)
            return tuple(a + b for a, b in shifted)
        if self.angle == 0:
            return self.origin[0] + local[0], self.origin[1] + local[1]
        c, s = sp.cos(self.angle), sp.sin(self.angle)
        return (
            self.origin[0] + c * local[0] - s * local[1],
            self.origin[1] + s * local[0] + c * local[1],
        )


GROUND = Frame((sp.Integer(0), sp.Integer(0)), sp.Integer(0))
GROUND_IN_SPACE = Frame((sp.Integer(0),) * 3, sp.Integer(0), Attitude())


@dataclass(frozen=True, slots=True)
class Geometry:
    """Frames of the bodies, centres of mass and named points, m, by name."""

    frames: Mapping[str, Frame]
    centres: Mapping[str, Vector]
    points: Mapping[str, Vector]

    def attitude(self, body: str) -> Attitude:
        """How a body in space is turned."""
        found = self.frames[body].attitude
        return Attitude() if found is None else found


def geometry(model: Model, symbols: Symbols) -> Geometry:
    """Place everything of a checked model; a chain of bodies is followed from the ground."""
    bodies = {body.name: body for body in model.bodies}
    declared = {point.name: point for point in model.points}
    frames: dict[str, Frame] = {}
    points: dict[str, Vector] = {}
    ground = GROUND_IN_SPACE if dimension(model) == 3 else GROUND

    def frame(name: str) -> Frame:
        if name not in frames:
            frames[name] = _frame(bodies[name], symbols, frame, ground)
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


def _frame(
    body: Body, symbols: Symbols, frame: Callable[[str], Frame], ground: Frame = GROUND
) -> Frame:
    angle = sp.Integer(0) if body.angle is None else to_sympy(body.angle, symbols.scope)
    parent = frame(body.parent) if body.parent else ground
    attitude = None
    if parent.attitude is not None:
        attitude = turned(body, parent.attitude, symbols)
    if body.joint is None:
        return Frame(located(body.at, symbols), angle, attitude)
    origin = parent.place(located(body.joint, symbols))
    return Frame(origin, parent.angle + angle, attitude)


def located(at: tuple[Expression, ...], symbols: Symbols) -> Vector:
    """Expressions as a position, m."""
    return tuple(to_sympy(part, symbols.scope) for part in at)


def seen_from(model: Model, body: str, point: Point, symbols: Symbols) -> Vector:
    """A point of a machine in space in the axes of a ``body`` (the ground, if empty), counted from
    its origin, m. What carries both does not occur in it."""
    bodies = {item.name: item for item in model.bodies}
    up, down = _carriers(bodies, point.body), _carriers(bodies, body)
    while up and down and up[-1] is down[-1]:
        up, down = up[:-1], down[:-1]
    at = located(point.at, symbols)
    for item in up:
        for turn in reversed(turns_of(item, symbols)):
            at = along(turn.axes, at)
        at = tuple(a + b for a, b in zip(_origin(item, symbols), at, strict=True))
    for item in reversed(down):
        at = tuple(a - b for a, b in zip(at, _origin(item, symbols), strict=True))
        for turn in turns_of(item, symbols):
            at = across(turn.axes, at)
    return at


def _carriers(bodies: Mapping[str, Body], name: str) -> list[Body]:
    """A body and what it hangs on, up to the ground."""
    found = []
    while name:
        found.append(bodies[name])
        name = bodies[name].parent
    return found


def _origin(body: Body, symbols: Symbols) -> Vector:
    """Where a body hangs, in the axes of its carrier, m."""
    return located(body.at if body.joint is None else body.joint, symbols)


def stretch_of(model: Model, place: Place, places: Geometry, symbols: Symbols) -> sp.Expr:
    """What a place with one stretch measures, before its length is taken off.

    On a coordinate it is q, on an expression its value; between two points their distance |b − a|:

        a o----/\\/\\/----o b        a tension pulls them together

    Raises:
        TypeError: a place at a point, which has no stretch.
    """
    match place:
        case On() as on:
            return to_sympy(on.expression, symbols.scope)
        case Between(first, second):
            return distance(places.points[first], places.points[second])
    raise TypeError("a place at a point has no stretch")


def distance(a: Vector, b: Vector) -> sp.Expr:
    """|b − a|, m."""
    return sp.sqrt(sp.Add(*((end - start) ** 2 for start, end in zip(a, b, strict=True))))


def rate_of(expression: sp.Expr, symbols: Symbols) -> sp.Expr:
    """Time derivative by the chain rule: ẋ = (∂x/∂q) q' + ∂x/∂t."""
    total = sp.diff(expression, symbols.t)
    for q, v in zip(symbols.q, symbols.v, strict=True):
        total += sp.diff(expression, q) * v
    return total


def gradient(expression: sp.Expr, symbols: Symbols) -> tuple[sp.Expr, ...]:
    """∂x/∂q, n entries."""
    return tuple(sp.diff(expression, q) for q in symbols.q)
