"""Check what sensors measure: expressions, and readings of instruments at named places."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from symhyb.errors import did_you_mean
from symhyb.model.check_constraints import held_unit
from symhyb.model.expression import READINGS, Name, Reading, names, readings
from symhyb.model.frames import point_faults
from symhyb.model.scope import MEASURED, Scope, expression_faults, scope_of
from symhyb.model.source import Path
from symhyb.model.space import dimension
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import At, Model, On, Pair, Sensor
from symhyb.model.vocabulary import force_unit
from symhyb.units import Unit, parse_unit

_UNITS = {
    "position_x": "m",
    "position_y": "m",
    "position_z": "m",
    "distance": "m",
    "direction": "rad",
    "orientation": "rad",
    "gyroscope": "rad/s",
    "gyroscope_x": "rad/s",
    "gyroscope_y": "rad/s",
    "gyroscope_z": "rad/s",
    "accelerometer_x": "m/s^2",
    "accelerometer_y": "m/s^2",
    "accelerometer_z": "m/s^2",
}
_IN_PLANE: Mapping[str, str] = {
    "direction": "in space a direction is no angle; measure positions of the points",
    "orientation": "in space no single angle tells it; measure a coordinate, or positions",
    "gyroscope": "in space it has three axes: gyroscope_x, gyroscope_y, gyroscope_z",
}
_IN_SPACE: Mapping[str, str] = {
    "position_z": "in the plane a point has x and y",
    "accelerometer_z": "in the plane it has the axes x and y",
    "gyroscope_x": "in the plane write gyroscope(body)",
    "gyroscope_y": "in the plane write gyroscope(body)",
    "gyroscope_z": "in the plane write gyroscope(body)",
}


def reading_unit(model: Model, reading: Reading) -> Unit:
    """Return the unit of what an instrument shows; the force of an element has the unit of force
    at its place, a reaction that of its coordinate or constraint.

    Raises:
        LookupError: an element or a coordinate that the model does not have.
    """
    if reading.what in _UNITS:
        return parse_unit(_UNITS[reading.what])
    (name,) = reading.names
    if reading.what == "reaction":
        held = next((item for item in model.constraints if item.name == name), None)
        if held is not None and name not in _coordinates(model):
            return held_unit(held, model, scope_of(model))
        if name not in [coordinate.name for coordinate in model.coordinates]:
            raise LookupError(name)
        return force_unit(model, On(name))
    place = next((element.place for element in model.elements if element.name == name), None)
    if place is None or isinstance(place, Pair):
        raise LookupError(name)
    return force_unit(model, place)


def sensor_faults(
    sensor: Sensor, model: Model, scope: Scope, energy: Unit | None, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """Yield what is wrong with one sensor; units that need the unit of ``energy`` are not checked
    where that is None."""
    path = ("sensors", sensor.name, "measures")
    known = replace(model, energy_unit=energy) if energy is not None else None

    def shown(reading: Reading) -> Unit:
        if known is None and reading.what not in _UNITS:
            raise LookupError(reading.what)
        return reading_unit(known or model, reading)

    local = replace(scope, shown=shown)
    used = readings(sensor.measures)
    faults = [
        fault
        for reading in used
        for fault in _reading_faults(path, reading, model, scope, unreadable)
    ]
    faults = faults or list(expression_faults(path, sensor.measures, local, MEASURED, sensor.unit))
    yield from faults
    moving = {name.name for name in names(sensor.measures)}
    shows = scope.coordinates | scope.states | scope.inputs | {"t"}
    if not faults and not used and not moving & shows:
        yield path, f"'{shorten(sensor.measures.text)}' measures no coordinate and no input"
    imposed = {coordinate.name for coordinate in model.coordinates if coordinate.imposed}
    if sensor.name in imposed and sensor.measures.tree != Name(sensor.name):
        text = f"has the name of an imposed coordinate, so it must measure '{sensor.name}' itself"
        yield path, f"{text}, not '{shorten(sensor.measures.text)}'; choose another name"


def _reading_faults(
    path: Path, reading: Reading, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """The names of a reading must be declared, and the instrument must fit what they are."""
    faults = 0
    for section, name in zip(READINGS[reading.what], reading.names, strict=True):
        if section == "point":
            found = list(point_faults(path, name, model, scope, unreadable))
        else:
            found = list(_name_faults(path, section, name, model, unreadable))
        yield from found
        faults += len(found)
    unread = {dotted.partition(".")[2] for dotted in unreadable}
    if not faults and not unread & set(reading.names):
        yield from _fit_faults(path, reading, model)


def _name_faults(
    path: Path, section: str, name: str, model: Model, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """A body, an element or a coordinate that a reading names must be declared."""
    plural = {"body": "bodies", "element": "elements", "coordinate": "coordinates"}[section]
    declared = {
        "body": [body.name for body in model.bodies],
        "element": [element.name for element in model.elements],
        "coordinate": [*_coordinates(model), *(item.name for item in model.constraints)],
    }[section]
    read = f"{plural}.{name}" not in unreadable and f"constraints.{name}" not in unreadable
    if name not in declared and read:
        yield path, f"'{shorten(name)}' is not a known {section}{did_you_mean(name, declared)}"


def _fit_faults(path: Path, reading: Reading, model: Model) -> Iterator[Fault]:
    """Instruments that show nothing where they are: the names are known."""
    name = reading.names[0]
    elsewhere = _IN_SPACE if dimension(model) == 2 else _IN_PLANE
    if reading.what in elsewhere:
        yield path, f"{reading}: {elsewhere[reading.what]}"
        return
    match reading.what:
        case "distance" | "direction" if name == reading.names[1]:
            yield path, f"{reading} goes from the point '{name}' to itself"
        case "orientation" | "gyroscope" | "gyroscope_x" | "gyroscope_y" | "gyroscope_z":
            body = next((body for body in model.bodies if body.name == name), None)
            if body is not None and body.angle is None and body.turned is None and not body.parent:
                cure = "an 'angle'" if reading.what[-2] != "_" else "'rotations' or a 'quaternion'"
                yield path, f"the body '{name}' does not turn; give it {cure}"
        case "force":
            element = next((item for item in model.elements if item.name == name), None)
            if element is not None and isinstance(element.place, Pair):
                text = f"'{name}' pushes two coordinates, each with a force of its own"
                yield path, f"{text}; a force cell measures an element 'on' or 'between'"
            if element is not None and isinstance(element.place, At):
                text = f"the force of '{name}' at a point is a vector"
                yield path, f"{text}; a force cell measures an element 'on' or 'between'"
        case "reaction":
            if any(item.name == name and not item.imposed for item in model.coordinates):
                text = f"the coordinate '{name}' is free; only an imposed motion has a reaction"
                yield path, f"{text}: write imposed = true in coordinates.{name}"
            elif name not in _coordinates(model):
                kind = next((c.kind for c in model.constraints if c.name == name), "")
                if kind in ("pin", "wheel", "ball"):
                    text = f"the reaction of the {kind} '{name}' is a vector"
                    yield path, f"{text}; put a sensor of one force there, as a distance has it"


def _coordinates(model: Model) -> list[str]:
    return [coordinate.name for coordinate in model.coordinates]
