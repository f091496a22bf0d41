"""Check what a model says: names, places, signs, and the unit of every expression."""

from collections.abc import Iterator
from dataclasses import replace

from symhyb.errors import did_you_mean
from symhyb.model.expression import RESERVED, Expression, Name, Number, names
from symhyb.model.scope import (
    COEFFICIENT,
    FORCE,
    GRAVITY,
    KINETIC,
    MASS,
    MEASURED,
    POSITION,
    POTENTIAL,
    Scope,
    expression_faults,
    scope_of,
    shared_names,
    unit_in,
    vector_faults,
    vector_unit,
)
from symhyb.model.source import Path
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import At, Between, Body, Element, Model, On
from symhyb.model.vocabulary import KINDS, key_unit
from symhyb.units import ONE, Unit, parse_unit


def energy_unit(model: Model, unreadable: frozenset[str]) -> tuple[Unit | None, list[Fault]]:
    """Return the unit of T and V, None where it cannot be told.

    J as soon as a coordinate is a length or an angle or a body has its place in lengths. Else it
    follows from the first mass · place² / s², or from the kinetic energy that is stated.
    """
    scope = scope_of(model, unreadable)
    metre, second = parse_unit("m"), parse_unit("s")
    unread = any(name.startswith(("bodies.", "energy.")) for name in unreadable)
    if not model.bodies and model.energy.kinetic is None and not unread:
        return None, [(("bodies",), "nothing has a mass; add a body or a kinetic energy")]
    places = [vector_unit(body.at, scope) for body in model.bodies]
    units = [coordinate.unit for coordinate in model.coordinates]
    if any(unit.is_angle or unit.same_dimension(metre) for unit in units) or any(
        unit is not None and unit.same_dimension(metre) for unit in places
    ):
        return parse_unit("J"), []
    for body, place in zip(model.bodies, places, strict=True):
        mass = unit_in(body.mass, scope)
        if mass is not None and place is not None:
            return mass * place**2 / second**2, []
    kinetic = model.energy.kinetic
    return (None if kinetic is None else unit_in(kinetic, scope)), []


def faults_of(model: Model, energy: Unit | None, unreadable: frozenset[str]) -> Iterator[Fault]:
    """Yield everything that is wrong in a model whose tables could be read.

    ``energy`` is the unit of energies, None where it cannot be told: what depends on it is then
    not checked. An expression with an unreadable name is not checked for units.
    """
    scope = scope_of(model, unreadable)
    yield from _name_faults(model)
    yield from _geometry_faults(model, scope, energy)
    for body in model.bodies:
        yield from _body_faults(body, model, scope, energy)
    for element in model.elements:
        yield from _element_faults(element, model, scope, energy, unreadable)
    for sensor in model.sensors:
        path = ("sensors", sensor.name, "measures")
        faults = list(expression_faults(path, sensor.measures, scope, MEASURED, sensor.unit))
        yield from faults
        used = {name.name for name in names(sensor.measures)}
        if not faults and not used & (scope.coordinates | scope.inputs | {"t"}):
            yield path, f"'{shorten(sensor.measures.text)}' measures no coordinate and no input"


def _name_faults(model: Model) -> Iterator[Fault]:
    """Names that are reserved, used twice, or lead to the same path of a parameter."""
    seen: dict[str, str] = {}
    for section, values in shared_names(model):
        for value in values:
            name = value.name
            if name in RESERVED:
                yield (section, name), f"'{name}' is a reserved name; choose another"
            elif name in seen:
                yield (section, name), f"'{name}' is already declared in [{seen[name]}]"
            seen.setdefault(name, section)
    for sensor in model.sensors:
        if sensor.name == "t":
            yield ("sensors", "t"), "'t' is the time column of a recording; choose another name"
    for element in model.elements:
        for own in element.parameters:
            path = ("elements", element.name, "parameters", own.name)
            if own.name in RESERVED:
                yield path, f"'{own.name}' is a reserved name; choose another"
            elif seen.get(own.name) in ("coordinates", "inputs"):
                yield path, f"'{own.name}' is already declared in [{seen[own.name]}]"
    paths = [parameter.path for parameter in model.all_parameters()]
    for channel in model.sensors:
        for fault in (channel.gain, channel.offset, channel.delay):
            if fault is not None and paths.count(fault.path) > 1:
                place = ("sensors", channel.name, fault.name)
                yield place, f"another '{fault.path}' is stated elsewhere; rename the sensor"


def _geometry_faults(model: Model, scope: Scope, energy: Unit | None) -> Iterator[Fault]:
    """Points, gravity and the energies that bodies cannot say."""
    for point in model.points:
        yield from vector_faults(("points", point.name), point.at, scope, POSITION)
    if model.gravity is not None:
        yield from vector_faults(("gravity",), model.gravity, scope, GRAVITY)
        place = next((vector_unit(body.at, scope) for body in model.bodies), None)
        needed = place and place / parse_unit("s^2")
        unit = vector_unit(model.gravity, scope)
        if unit is not None and needed is not None and not unit.same_dimension(needed):
            yield ("gravity",), f"is {unit}, needs {needed}"
    if model.energy.kinetic is not None:
        path = ("energy", "kinetic")
        yield from expression_faults(path, model.energy.kinetic, scope, KINETIC, energy)
    if model.energy.potential is not None:
        path = ("energy", "potential")
        yield from expression_faults(path, model.energy.potential, scope, POTENTIAL, energy)


def _body_faults(body: Body, model: Model, scope: Scope, energy: Unit | None) -> Iterator[Fault]:
    place = ("bodies", body.name)
    if body.at not in [point.at for point in model.points]:
        yield from vector_faults((*place, "at"), body.at, scope, POSITION)
    at = vector_unit(body.at, scope)
    needed = _mass_unit(energy, at)
    yield from expression_faults((*place, "mass"), body.mass, scope, MASS, needed)
    yield from _sign_faults((*place, "mass"), body.mass, model)
    if body.angle is not None:
        yield from expression_faults((*place, "angle"), body.angle, scope, POSITION, ONE)
    if body.inertia is not None:
        needed = _mass_unit(energy, ONE)
        yield from expression_faults((*place, "inertia"), body.inertia, scope, MASS, needed)
        yield from _sign_faults((*place, "inertia"), body.inertia, model)


def _mass_unit(energy: Unit | None, place: Unit | None) -> Unit | None:
    """Return what makes mass · place² / s² an energy: kg at a length, kg*m^2 on an angle."""
    if energy is None or place is None:
        return None
    base = parse_unit("kg*m^2/s^2") if energy.same_dimension(parse_unit("J")) else energy
    if place.same_dimension(parse_unit("m")):
        place = parse_unit("m")
    return base * parse_unit("s^2") / place**2


def _sign_faults(path: Path, mass: Expression, model: Model) -> Iterator[Fault]:
    """A mass that is one plain number or parameter must be positive."""
    if isinstance(mass.tree, Number) and mass.tree.value == 0:
        yield path, "is 0; it must be positive"
    if isinstance(mass.tree, Name):
        for parameter in model.parameters:
            if parameter.name == mass.tree.name and parameter.value <= 0:
                value = f"'{parameter.name}' is {parameter.value:g} {parameter.unit}"
                yield path, f"{value}; it must be positive"


def _element_faults(
    element: Element, model: Model, scope: Scope, energy: Unit | None, unreadable: frozenset[str]
) -> Iterator[Fault]:
    path = ("elements", element.name)
    faults = list(_place_faults(element, model, scope, unreadable))
    yield from faults
    own = {parameter.name: parameter.unit for parameter in element.parameters}
    local = replace(scope, units={**scope.units, **own})
    on = element.place.coordinate if isinstance(element.place, On) else None
    placed = not faults and (on is None or scope.units.get(on) is not None)
    known = replace(model, energy_unit=energy) if energy is not None else None
    for key, value in element.values:
        declared = KINDS[element.kind].key(key.split(".")[0])
        use = FORCE if declared is not None and declared.signal else COEFFICIENT
        needed = key_unit(known, element.kind, key, element.place) if placed and known else None
        yield from expression_faults((*path, key), value, local, use, needed)


def _place_faults(
    element: Element, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """An element must stand on a known coordinate or at known points."""
    path = ("elements", element.name)
    match element.place:
        case On(coordinate):
            if coordinate not in scope.coordinates:
                cure = did_you_mean(coordinate, sorted(scope.coordinates))
                yield (*path, "on"), f"'{shorten(coordinate)}' is not a known coordinate{cure}"
        case Between(first, second):
            for name in (first, second):
                yield from _point_faults((*path, "between"), name, model, scope, unreadable)
        case At(point):
            yield from _point_faults((*path, "at"), point, model, scope, unreadable)


def _point_faults(
    path: Path, name: str, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """A point must be declared, and lie in a plane of lengths."""
    if f"points.{name}" in unreadable:
        return
    point = next((point for point in model.points if point.name == name), None)
    if point is None:
        known = [point.name for point in model.points]
        yield path, f"'{shorten(name)}' is not a known point{did_you_mean(name, known)}"
        return
    unit = vector_unit(point.at, scope)
    if unit is not None and not unit.same_dimension(parse_unit("m")):
        yield path, f"the point '{name}' is in {unit}; a force at a point needs lengths"
