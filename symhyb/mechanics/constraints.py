r"""What constraints ask for, in SymPy: rows c(q, t), or speeds s(q, q', t), that are zero, SI.

    pin        b − a, a row for each component; in space along the axes of the body of a
    distance   |b − a| − length
    slider     how far p is beside the line from a to b:   a o───────────o b
                                                                  | c      the line may move
                                                                  o p
    gear       phi − ratio·psi − offset
    rolling    x − radius·phi − offset        x along the track, positive where phi turns it:

                  _
               phi( )───▶ x
              ─────────────── track

    equation   the expression itself
    wheel      its lowest point touches the ground, and has no speed:

          ^ n   / e axle          b = (n − (n·e) e) / |n − (n·e) e|     from the lowest point to
          |    /                                                        the hub, across the axle
        ( o )  hub, R = radius    0 = n·hub − height − R n·b            a disc with a sharp edge
    ______v______ ground          0 = v_hub − R ω × b                   along the ground

    ball       the same with b = n
    nonholonomic   the speed itself, linear in the rates

Source of the last three: Neimark and Fufaev, Dynamics of Nonholonomic Systems, 1972, ch. I.
Sizes: m rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.attitude import ONE, ZERO, Vector, along, crossed
from symhyb.mechanics.kinematics import Geometry, distance, rate_of, seen_from
from symhyb.mechanics.symbols import Symbols, to_sympy
from symhyb.model.constraints import Constraint
from symhyb.model.space import dimension
from symhyb.model.types import Model

AXES = "xyz"


@dataclass(frozen=True, slots=True)
class Closure:
    """One row: its ``label`` (the name of the constraint, with the axis of a vector), and ``gap``,
    what is zero where the loop closes. λ acts towards a larger gap; ``pulls`` says that its
    reaction is shown with the other sign, as the tension of a rod. A nonholonomic row has no gap
    but a speed that is zero: ``slip`` and the rate of ``path`` together."""

    label: str
    gap: sp.Expr
    pulls: bool = False
    slip: sp.Expr | None = None
    path: sp.Expr = ZERO

    def speed(self, symbols: Symbols) -> sp.Expr | None:
        """What a nonholonomic row holds at zero; None of another."""
        return None if self.slip is None else rate_of(self.path, symbols) + self.slip


def closures(model: Model, places: Geometry, symbols: Symbols) -> tuple[Closure, ...]:
    """The rows of all constraints, those of ``model.assembly.left_out`` too."""
    return tuple(row for item in model.constraints for row in _rows(item, model, places, symbols))


def _rows(
    item: Constraint, model: Model, places: Geometry, symbols: Symbols
) -> tuple[Closure, ...]:
    scope = symbols.scope
    values = {key: to_sympy(expression, scope) for key, expression in item.values}
    match item.kind:
        case "pin":
            a, b = _placed(item.names, item.names[0], model, places, symbols)
            return _components(item.name, [end - begin for begin, end in zip(a, b, strict=True)])
        case "distance":
            a, b = (places.points[name] for name in item.names)
            return (Closure(item.name, distance(a, b) - values["length"], pulls=True),)
        case "slider":
            point, a, b = _placed(item.names, item.names[1], model, places, symbols)
            return _components(item.name, _beside(point, a, b))
        case "gear" | "rolling":
            first, second = (scope[name, 0] for name in item.names)
            factor = values["ratio" if item.kind == "gear" else "radius"]
            offset = values.get("offset", _offset(item, model, factor, symbols))
            return (Closure(item.name, first - factor * second - offset),)
        case "wheel" | "ball":
            return _touching(item, model, places, values)
        case "nonholonomic":
            return (Closure(item.name, ZERO, slip=values["rate"]),)
    return (Closure(item.name, values["zero"]),)


def _touching(
    item: Constraint, model: Model, places: Geometry, values: dict[str, sp.Expr]
) -> tuple[Closure, ...]:
    """It touches the ground (one row) and does not slip there (two)."""
    axes, (hub,) = dict(item.axes), item.names
    up = AXES.index(axes["up"])
    body = next(point.body for point in model.points if point.name == hub)
    attitude = places.attitude(body)
    normal = tuple(ONE if i == up else ZERO for i in range(3))
    across = normal
    if item.kind == "wheel":
        axle = tuple(row[AXES.index(axes["axle"])] for row in attitude.axes)
        upright = tuple(n - axle[up] * e for n, e in zip(normal, axle, strict=True))
        across = tuple(part / sp.sqrt(1 - axle[up] ** 2) for part in upright)
    radius, at = values["radius"], places.points[hub]
    turned = crossed(along(attitude.axes, attitude.omega), across)
    touch = at[up] - values.get("height", ZERO) - radius * across[up]
    return (
        Closure(f"{item.name}.touch", touch),
        *(
            Closure(f"{item.name}.{AXES[i]}", ZERO, slip=-radius * turned[i], path=at[i])
            for i in range(3)
            if i != up
        ),
    )


def _placed(
    names: Sequence[str], carrier: str, model: Model, places: Geometry, symbols: Symbols
) -> list[Vector]:
    """Points by name; in space in the axes of the body that the point ``carrier`` is fixed to: a
    direction there along which nothing moves stays the same however the whole is turned."""
    if dimension(model) == 2:
        return [places.points[name] for name in names]
    points = {point.name: point for point in model.points}
    body = points[carrier].body
    return [seen_from(model, body, points[name], symbols) for name in names]


def _components(name: str, gaps: list[sp.Expr]) -> tuple[Closure, ...]:
    if len(gaps) == 1:
        return (Closure(name, gaps[0]),)
    return tuple(Closure(f"{name}.{axis}", gap) for axis, gap in zip(AXES, gaps, strict=False))


def _beside(
    point: tuple[sp.Expr, ...], a: tuple[sp.Expr, ...], b: tuple[sp.Expr, ...]
) -> list[sp.Expr]:
    """(b − a) × (p − a) / |b − a|: one number in the plane, three in space (two of them
    independent; the third is left out with the rows that repeat others)."""
    along = [end - begin for begin, end in zip(a, b, strict=True)]
    off = [part - begin for begin, part in zip(a, point, strict=True)]
    length = sp.sqrt(sum((part**2 for part in along), sp.Integer(0)))
    pairs = [(0, 1)] if len(along) == 2 else [(1, 2), (2, 0), (0, 1)]
    return [(along[i] * off[j] - along[j] * off[i]) / length for i, j in pairs]


def _offset(item: Constraint, model: Model, factor: sp.Expr, symbols: Symbols) -> sp.Expr:
    """What makes a gear or a wheel fit at the start that the file states."""
    first, second = (
        c.start * c.unit.factor for name in item.names for c in model.coordinates if c.name == name
    )
    return sp.Float(first) - factor * sp.Float(second)
