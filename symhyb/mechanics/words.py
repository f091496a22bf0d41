"""Sensors, curves and maps in words: what an instrument shows, how a channel differs from the
truth."""

from collections.abc import Collection

from symhyb.model.curves import Curve
from symhyb.model.expression import Reading
from symhyb.model.maps import Map
from symhyb.model.types import Model, Sensor


def reading_in_words(reading: Reading, constraints: Collection[str] = ()) -> str:
    """Say what an instrument of a model file with these constraints shows."""
    first, second = (*reading.names, "")[:2]
    match reading.what:
        case "position_x" | "position_y" | "position_z":
            return f"the {reading.what[-1]} component of where the point {first} is"
        case "distance":
            return f"the distance from the point {first} to the point {second}"
        case "direction":
            return f"the angle of the line from {first} to {second}, counted from the x axis"
        case "orientation":
            return f"the angle of the body {first} against the inertial axes"
        case "gyroscope":
            return f"the angular speed of the body {first}"
        case "gyroscope_x" | "gyroscope_y" | "gyroscope_z":
            return f"the angular speed of the body {first} about its {reading.what[-1]} axis"
        case "accelerometer_x" | "accelerometer_y" | "accelerometer_z":
            axis = reading.what[-1]
            felt = f"acceleration minus gravity of the point {first}"
            return f"{felt}, along the {axis} axis of the body {second}"
        case "force":
            return f"the force in elements.{first}, in the sign of its law"
        case "reaction":
            if first in constraints:
                return f"the force by which the constraint {first} holds"
            return f"the force that gives {first} its imposed motion, M q'' + k_c - k_e"
    return str(reading)


def rates_title(model: Model) -> str:
    """Above the rates of declared states and of what laws remember."""
    return "rates of the states" if model.states else "rates of the inner states"


_BEYOND = {"line": "the line of the end slope", "hold": "the last value"}


def curves_in_words(model: Model) -> list[tuple[str, str]]:
    """The curves of the file and those of its elements, each with what it runs through, and how."""
    curves = model.all_curves()
    return [(f"curve({curve.name}, .)", _curve_in_words(curve)) for curve in curves]


def _curve_in_words(curve: Curve) -> str:
    (first, _), (last, _) = curve.points[0], curve.points[-1]
    along, up = curve.units
    between = {"monotone": "monotone cubics", "linear": "straight lines"}[curve.interpolation]
    beyond = _BEYOND[curve.extrapolation]
    source = f" of {curve.file}" if curve.file else ""
    said = f"{len(curve.points)} points{source} from {first:g} to {last:g} {along}, in {up};"
    return f"{said} {between} between them, {beyond} beyond"


def maps_in_words(model: Model) -> list[tuple[str, str]]:
    """The maps of the file and those of its elements, each with its grid, and how it runs beyond.
    A map that is differentiated has a letter of each of its variables: map_x, map_y, map_xy."""
    return [(f"map({item.name}, x, y)", _map_in_words(item)) for item in model.all_maps()]


def _map_in_words(item: Map) -> str:
    over_x, over_y, up = item.units
    source = f" of {item.file}" if item.file else ""
    spans = [
        f"{len(places)} places from {places[0]:g} to {places[-1]:g} {unit}"
        for places, unit in ((item.x, over_x), (item.y, over_y))
    ]
    return f"{' by '.join(spans)}{source}, in {up}; bilinear, {_BEYOND[item.extrapolation]} beyond"


def sensor_notes(sensor: Sensor) -> tuple[str]:
    """What the file says about a sensor, and its delay, in one cell."""
    notes = [sensor.about] if sensor.about else []
    if sensor.delay is not None:
        notes.append(f"recorded {sensor.delay.path} later")
    return ("; ".join(notes),)
