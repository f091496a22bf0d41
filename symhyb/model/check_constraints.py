"""Check the constraints of a model: what they name, and the unit of every expression."""

from collections.abc import Iterator

from symhyb.errors import did_you_mean
from symhyb.model.constraints import CONSTRAINTS, Constraint
from symhyb.model.expression import Name, Number, Quantity, names
from symhyb.model.frames import point_faults
from symhyb.model.scope import Scope, Use, expression_faults, unit_in
from symhyb.model.source import Path
from symhyb.model.space import dimension
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import force_unit
from symhyb.units import Unit, parse_unit

TOUCHING = ("wheel", "ball")
CONDITION = Use("a constraint", 0, False, True, rough=False)
SPEED = Use("a nonholonomic constraint", 1, False, True, rough=False)


def constraint_faults(
    constraint: Constraint, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """Yield what is wrong with one constraint."""
    path: Path = ("constraints", constraint.name)
    kind = CONSTRAINTS[constraint.kind]
    keys = [key for key, count in kind.places for _ in range(count)]
    faults: list[Fault] = []
    for key, name in zip(keys, constraint.names, strict=True):
        if kind.section == "points":
            faults += point_faults((*path, key), name, model, scope, unreadable)
        elif name not in scope.coordinates:
            cure = did_you_mean(name, sorted(scope.coordinates))
            faults.append(((*path, key), f"'{shorten(name)}' is not a known coordinate{cure}"))
    if constraint.kind == "rolling" and not faults:
        unit = scope.units.get(constraint.names[0])
        if unit is not None and not unit.same_dimension(parse_unit("m")):
            text = f"'{constraint.names[0]}' is in {unit}; what rolls goes a length"
            faults.append(((*path, "on"), f"{text}: name the length first, then the angle"))
    if constraint.kind in TOUCHING and not faults:
        faults += _touching_faults(constraint, model, path)
    yield from faults
    for key, value in constraint.values:
        needed = None if faults else _needed(constraint, key, scope)
        use = SPEED if key == "rate" else CONDITION
        yield from expression_faults((*path, key), value, scope, use, needed)
    yield from _strength_faults(constraint, model, path)
    rate = constraint.value("rate")
    if rate is not None and not any(name.order for name in names(rate)):
        cure = "a condition on places is an equation, with 'zero'"
        yield (*path, "rate"), f"'{shorten(rate.text)}' contains no rate; {cure}"
    zero = constraint.value("zero")
    if zero is not None and not {name.name for name in names(zero)} & scope.coordinates:
        yield (*path, "zero"), f"'{shorten(zero.text)}' contains no coordinate; it holds nothing"


def held_unit(constraint: Constraint, model: Model, scope: Scope) -> Unit:
    """The unit of the force by which one constraint holds; that of energy must be known.

    Raises:
        LookupError: a name without a readable unit.
    """
    if constraint.kind in ("gear", "rolling"):
        return force_unit(model, On(constraint.names[0]))
    if CONSTRAINTS[constraint.kind].section == "points":
        return parse_unit("N")
    rate, zero = constraint.value("rate"), constraint.value("zero")
    condition = rate if zero is None else zero
    unit = None if condition is None else unit_in(condition, scope)
    if unit is None:
        raise LookupError(constraint.name)
    return model.energy_unit / (unit if rate is None else unit * parse_unit("s"))


def _needed(constraint: Constraint, key: str, scope: Scope) -> Unit | None:
    """The unit that a key must have; None where any will do, or where it cannot be known."""
    if key in ("length", "height") or constraint.kind in TOUCHING:
        return parse_unit("m")
    if key in ("zero", "rate"):
        return None
    first, second = (scope.units.get(name) for name in constraint.names)
    if first is None or second is None:
        return None
    return first if key == "offset" else first / second


def _strength_faults(constraint: Constraint, model: Model, path: Path) -> Iterator[Fault]:
    """A length that is one plain number or parameter is positive; a ratio or radius is not 0."""
    for key in ("length", "ratio", "radius"):
        value = constraint.value(key)
        if value is None:
            continue
        plain = _plain(value.tree, model)
        if key == "length" and plain is not None and plain <= 0:
            cure = "; two points in one place are a pin" if plain == 0 else ""
            yield (*path, key), f"is {plain:g}; a length must be positive{cure}"
        elif constraint.kind in TOUCHING:
            if plain is not None and plain <= 0:
                yield (*path, key), f"is {plain:g}; the radius of what rolls must be positive"
        elif plain == 0:
            yield (*path, key), f"is 0; then '{constraint.names[1]}' moves nothing"


def _touching_faults(constraint: Constraint, model: Model, path: Path) -> Iterator[Fault]:
    """What rolls on the ground is fixed to a body in space, with an axle across the ground."""
    if dimension(model) != 3:
        cure = "in the plane a wheel is 'rolling', on a length and an angle"
        yield (*path, "kind"), f"a {constraint.kind} rolls in space; {cure}"
    (name,) = constraint.names
    point = next((point for point in model.points if point.name == name), None)
    if point is not None and not point.body:  # one that could not be read has its own fault
        text = f"the point '{name}' is fixed to no body; a {constraint.kind} turns with one"
        yield (*path, "point"), f"{text}: give the point a body"


def _plain(tree: object, model: Model) -> float | None:
    if isinstance(tree, Number | Quantity):
        return tree.value
    if isinstance(tree, Name):
        return next((p.value for p in model.parameters if p.name == tree.name), None)
    return None
