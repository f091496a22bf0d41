"""What constraints ask for, in SymPy: rows c(q, t) that are zero, SI.

    pin        b − a, a row for each component
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

Sizes: m rows.
"""

from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.kinematics import Geometry, distance
from symhyb.mechanics.symbols import Symbols, to_sympy
from symhyb.model.constraints import Constraint
from symhyb.model.types import Model

AXES = "xyz"


@dataclass(frozen=True, slots=True)
class Closure:
    """One row: its ``label`` (the name of the constraint, with the axis of a vector), and ``gap``,
    what is zero where the loop closes. λ acts towards a larger gap; ``pulls`` says that its
    reaction is shown with the other sign, as the tension of a rod."""

    label: str
    gap: sp.Expr
    pulls: bool = False


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
            a, b = (places.points[name] for name in item.names)
            gaps = [end - begin for begin, end in zip(a, b, strict=True)]
            return _components(item.name, gaps)
        case "distance":
            a, b = (places.points[name] for name in item.names)
            return (Closure(item.name, distance(a, b) - values["length"], pulls=True),)
        case "slider":
            point, a, b = (places.points[name] for name in item.names)
            return _components(item.name, _beside(point, a, b))
        case "gear" | "rolling":
            first, second = (scope[name, 0] for name in item.names)
            factor = values["ratio" if item.kind == "gear" else "radius"]
            offset = values.get("offset", _offset(item, model, factor, symbols))
            return (Closure(item.name, first - factor * second - offset),)
    return (Closure(item.name, values["zero"]),)


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
