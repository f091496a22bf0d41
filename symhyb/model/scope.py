"""What names mean in a model, which of them may stand where, and the units that follow."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import did_you_mean
from symhyb.model.curves import Curve
from symhyb.model.expression import (
    Expression,
    ExpressionError,
    Name,
    Node,
    Operation,
    Reading,
    evaluate,
    names,
    quantities,
    readings,
    show,
    tables_in,
    unit_of,
)
from symhyb.model.maps import Map
from symhyb.model.quantities import factors_of
from symhyb.model.source import Path
from symhyb.model.states import State
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import Coordinate, Element, Input, Model, Parameter, Vector
from symhyb.units import Unit, parse_unit


@dataclass(frozen=True, slots=True)
class Use:
    """What an expression may contain: derivatives up to ``order`` (−1: no coordinates at all),
    ``inputs``, the time (``time``), declared ``states``, what instruments show (``readings``), and
    functions with a kink (``rough``: min, max, sign, abs of what moves; ``steady``: the time alone
    moves nothing). ``words`` name the place in sentences."""

    words: str
    order: int
    inputs: bool
    time: bool
    states: bool = False
    readings: bool = False
    rough: bool = True
    steady: bool = False


MASS = Use("a mass or inertia", 0, False, True, rough=False, steady=True)
GRAVITY = Use("gravity", -1, False, True)
POSITION = Use("a position", 0, False, True, rough=False)
PLACE = Use("a place", 0, False, True, rough=False)
KINETIC = Use("a kinetic energy", 1, False, True)
POTENTIAL = Use("a potential energy", 0, False, True)
COEFFICIENT = Use("a coefficient", -1, True, True, states=True)
FORCE = Use("a force", 1, True, True, states=True)
SEEN = Use("what a network sees", 1, True, True)
RATE = Use("the rate of a state", 1, True, True, states=True)
NEXT = Use("the next value of a state", 1, True, True, states=True)
ADDED = Use("an added mass", -1, False, False)
MEASURED = Use("a sensor", 2, True, True, states=True, readings=True)
_ROUGH = ("min", "max", "sign", "abs")


@dataclass(frozen=True, slots=True)
class Scope:
    """What the names mean: units by name (None: unreadable), and which are what; ``shown`` gives
    the unit of a reading (LookupError: unknown), ``tables`` are curves and maps by the word that
    calls them and their name (None: unreadable)."""

    units: Mapping[str, Unit | None]
    coordinates: frozenset[str]
    inputs: frozenset[str]
    states: frozenset[str] = frozenset()
    shown: Callable[[Reading], Unit] | None = None
    tables: Mapping[tuple[str, str], Curve | Map | None] = field(default_factory=dict)


def scope_of(model: Model, unreadable: frozenset[str] = frozenset()) -> Scope:
    """Collect the shared namespace of a model; ``unreadable`` holds dotted names."""
    units: dict[str, Unit | None] = {"t": parse_unit("s")}
    sections = ("coordinates", "states", "parameters", "inputs")
    kinds: dict[str, set[str]] = {section: set() for section in sections}
    tables: dict[tuple[str, str], Curve | Map | None] = {
        **{("curve", curve.name): curve for curve in model.curves},
        **{("map", item.name): item for item in model.maps},
    }
    named: list[tuple[str, str, Unit | None]] = [
        (section, value.name, value.unit)
        for section, values in shared_names(model)
        for value in values
    ]
    for dotted in sorted(unreadable):
        section, name = dotted.split(".", 1)
        if section in kinds:
            named.append((section, name, None))
        elif section in ("curves", "maps"):
            tables[section.removesuffix("s"), name] = None
    for section, name, unit in named:
        if name not in units:  # a name declared twice is a fault of its own; the first one counts
            kinds[section].add(name)
            units[name] = unit
    coordinates, states, _, inputs = (frozenset(kinds[section]) for section in sections)
    return Scope(units, coordinates, inputs, states, tables=tables)


def numbers_of(model: Model, element: Element) -> dict[tuple[str, int] | str, float]:
    """The parameters that the expressions of an ``element`` see, by name, SI: its own before those
    of the model."""
    return {one.name: one.si for one in (*model.parameters, *element.parameters)}


def constant_of(
    expression: Expression, model: Model, own: Iterable[Parameter] = ()
) -> float | None:
    """Evaluate an expression of parameters of the model and of ``own``, SI; None if it has other
    names, or calls a curve or a map that is not there."""
    values: dict[tuple[str, int] | str, NDArray[np.float64] | float]
    values = {one.name: one.si for one in (*model.parameters, *own)}
    if any(name.order or name.name not in values for name in names(expression)):
        return None
    tables = model.characteristics()
    known = all(one in tables for one in tables_in(expression))
    return float(evaluate(expression, values, tables)) if known else None


def shared_names(
    model: Model,
) -> tuple[tuple[str, tuple[Coordinate | State | Parameter | Input, ...]], ...]:
    """Return the sections whose names are one namespace, with what they declare."""
    return (
        ("coordinates", model.coordinates),
        ("states", model.states),
        ("parameters", model.parameters),
        ("inputs", model.inputs),
    )


def vector_faults(path: Path, vector: Vector, scope: Scope, use: Use) -> Iterator[Fault]:
    """Yield what is wrong with a vector: each component, then whether their units agree."""
    faults = [fault for part in vector for fault in expression_faults(path, part, scope, use, None)]
    yield from faults
    units = [unit for part in vector if (unit := unit_in(part, scope)) is not None]
    other = next((unit for unit in units[1:] if not unit.same_dimension(units[0])), None)
    if other is not None:
        count = {2: "two", 3: "three"}[len(vector)]
        yield path, f"its {count} components differ: {units[0]} and {other}"


def vector_unit(vector: Vector, scope: Scope) -> Unit | None:
    """Return the unit of a vector; a component of literal 0 takes that of the others."""
    return next((unit for part in vector if (unit := unit_in(part, scope)) is not None), None)


def unit_in(expression: Expression, scope: Scope) -> Unit | None:
    """Return the unit of an expression, None if it has none or cannot be known."""
    try:
        return _unit_of(expression, scope)
    except (ExpressionError, LookupError):
        return None


def _unit_of(expression: Expression, scope: Scope) -> Unit | None:
    def table(word: str, name: str) -> tuple[Unit, ...]:
        found = scope.tables[word, name]
        if found is None:
            raise LookupError(name)
        return found.units

    return unit_of(expression, lambda name: _unit_of_name(name, scope), scope.shown, table)


def _unit_of_name(name: Name, scope: Scope) -> Unit:
    unit = scope.units[name.name]
    if unit is None:
        raise LookupError(name.name)
    return unit / parse_unit("s") ** name.order


def expression_faults(
    path: Path, expression: Expression, scope: Scope, use: Use, needed: Unit | None
) -> Iterator[Fault]:
    """Yield what is wrong with the names; only if they are all good, units against ``needed``."""
    faults = list(_use_faults(path, expression, scope, use))
    yield from faults
    if faults:
        return
    try:
        unit = _unit_of(expression, scope)
    except LookupError:
        return
    except ExpressionError as error:
        yield path, str(error)
        return
    if unit is not None and needed is not None and not unit.same_dimension(needed):
        yield path, f"'{shorten(expression.text)}' is {unit}, needs {needed}"


def _use_faults(path: Path, expression: Expression, scope: Scope, use: Use) -> Iterator[Fault]:
    """Names that are unknown, or may not stand here; readings; functions with a kink."""
    if not use.readings:
        for reading in readings(expression):
            yield path, f"only sensors may use {reading.what}(...), not {use.words}"
    yield from _misleading(path, expression, scope)
    at_speed = scope.coordinates if use.steady else scope.coordinates | {"t"}
    rough = None if use.rough else _rough(expression.tree, scope, at_speed)
    if rough is not None:
        text = shorten(show(rough))
        cure = {
            "curve": "let the curve be monotone, and a line beyond its points",
            "map": "a map has a kink at each place of its grid; use curves, which may be smooth",
        }.get(rough.operator, "use tanh or sqrt")
        yield path, f"'{text}' has no smooth speed, which {use.words} needs; {cure}"
    for word, table in tables_in(expression):
        if (word, table) not in scope.tables:
            known = [name for kind, name in scope.tables if kind == word]
            cure = did_you_mean(table, known) or f"; state it under [{word}s]"
            yield path, f"'{shorten(table)}' is not a known {word}{cure}"
    for name in sorted(names(expression), key=str):
        moving = name.name in scope.coordinates
        if name.name not in scope.units:
            cure = did_you_mean(name.name, [known for known in scope.units if known != "t"])
            yield path, f"'{shorten(name.name)}' is not a known name{cure}"
        elif name.order and name.name in scope.states:
            yield path, f"{name} is the rate of a state, which nothing can use; write it out"
        elif name.order and not moving:
            yield path, f"{name}: only coordinates have derivatives here"
        elif moving and use.order < 0:
            yield path, f"{use.words} cannot depend on the coordinate {name}"
        elif moving and name.order > use.order:
            what = ("a position", "a speed", "an acceleration")[name.order]
            yield path, f"{name} is {what}, on which {use.words} cannot depend"
        elif name.name in scope.states and not use.states:
            yield path, f"{name} is a state, on which {use.words} cannot depend"
        elif name.name in scope.inputs and not use.inputs:
            cure = "; write its course as a curve over the time t" if use is MASS else ""
            yield path, f"{name} is an input, on which {use.words} cannot depend{cure}"
        elif name.name == "t" and not use.time:
            yield path, f"{use.words} cannot depend on the time"


def _misleading(path: Path, expression: Expression, scope: Scope) -> Iterator[Fault]:
    """Units in place one of whose factors is a declared name of the same dimension, too: no check
    of units would find which of them is meant."""
    for quantity in quantities(expression):
        for factor in sorted(factors_of(quantity) & scope.units.keys()):
            unit = scope.units[factor]
            if unit is not None and unit.same_dimension(parse_unit(factor)):
                cure = "write a product with blanks around its sign, or choose another name"
                text = f"'{quantity}' can be read in two ways, as {factor} is a declared name"
                yield path, f"{text}; {cure}"


def _rough(tree: Node, scope: Scope, moving: frozenset[str]) -> Operation | None:
    """Find a function with a kink in what is ``moving``: its speed would jump."""
    if not isinstance(tree, Operation):
        return None
    used = {name.name for name in names(tree)} & moving
    table = scope.tables.get((tree.operator, tree.table))
    if used and (tree.operator in _ROUGH or (table is not None and not table.smooth)):
        return tree
    return next((found for part in tree.arguments if (found := _rough(part, scope, moving))), None)
