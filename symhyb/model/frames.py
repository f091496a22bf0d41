"""Check what hangs on what: bodies on bodies, points on bodies, and that all are in lengths."""

from collections.abc import Iterator

from symhyb.errors import did_you_mean
from symhyb.model.scope import POSITION, Scope, vector_faults, vector_unit
from symhyb.model.source import Path
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import Body, Model, Vector
from symhyb.units import Unit, parse_unit


def frame_faults(model: Model, scope: Scope, unreadable: frozenset[str]) -> Iterator[Fault]:
    """Yield what is wrong with points, and with what bodies hang on; ``unreadable`` holds the
    dotted names of what could not be read."""
    for point in model.points:
        path = ("points", point.name)
        if not point.body:
            yield from vector_faults(path, point.at, scope, POSITION)
            continue
        yield from _fixed_faults((*path, "at"), point.at, scope)
        yield from carrier_faults((*path, "body"), point.body, model, scope, unreadable)
    for body in model.bodies:
        if body.joint is not None:
            yield from _hanging_faults(body, model, scope, unreadable)
    yield from _circle_faults(model)


def place_unit(body: Body, scope: Scope) -> Unit | None:
    """Return the unit in which a body has its place: m as soon as it hangs on something."""
    return parse_unit("m") if body.joint is not None else vector_unit(body.at, scope)


def point_faults(
    path: Path, name: str, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """A point that is used must be declared, and lie in a plane or space of lengths."""
    if f"points.{name}" in unreadable:
        return
    point = next((point for point in model.points if point.name == name), None)
    if point is None:
        known = [point.name for point in model.points]
        yield path, f"'{shorten(name)}' is not a known point{did_you_mean(name, known)}"
        return
    unit = vector_unit(point.at, scope)
    if unit is not None and not unit.same_dimension(parse_unit("m")):
        yield path, f"the point '{name}' is in {unit}; forces and readings need lengths"


def carrier_faults(
    path: Path, name: str, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """A body that carries something must be declared, and have its own place in lengths."""
    if f"bodies.{name}" in unreadable:
        return
    body = next((body for body in model.bodies if body.name == name), None)
    if body is None:
        known = [body.name for body in model.bodies]
        yield path, f"'{shorten(name)}' is not a known body{did_you_mean(name, known)}"
        return
    unit = place_unit(body, scope)
    if unit is not None and not unit.same_dimension(parse_unit("m")):
        yield path, f"the body '{name}' is in {unit}; what it carries needs lengths"


def _hanging_faults(
    body: Body, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """The parent, the joint and the centre of mass of a body that hangs."""
    place = ("bodies", body.name)
    if body.parent and body.parent != body.name and not _known_by_a_point(body, model):
        yield from carrier_faults((*place, "parent"), body.parent, model, scope, unreadable)
    named = [point.at for point in model.points]
    for key, vector in (("joint", body.joint), ("at", body.at)):
        if vector is None or vector in named:
            continue
        yield from _fixed_faults((*place, key), vector, scope)


def _known_by_a_point(body: Body, model: Model) -> bool:
    """Whether a point where the body hangs already reports that its carrier is unknown."""
    return any(point.body == body.parent and point.at == body.joint for point in model.points)


def _fixed_faults(path: Path, vector: Vector, scope: Scope) -> Iterator[Fault]:
    """A place in the axes of a body, which mix its components: both are lengths."""
    faults = list(vector_faults(path, vector, scope, POSITION))
    yield from faults
    unit = vector_unit(vector, scope)
    if not faults and unit is not None and not unit.same_dimension(parse_unit("m")):
        yield path, f"is in {unit}; what is fixed to a body needs lengths"


def _circle_faults(model: Model) -> Iterator[Fault]:
    """Bodies that hang on themselves, through others or directly: each circle once."""
    parents = {body.name: body.parent for body in model.bodies if body.joint is not None}
    known: set[str] = set()
    for name in parents:
        chain = [name]
        while (parent := parents.get(chain[-1], "")) and parent not in chain:
            chain.append(parent)
        if parent != name or name in known:
            continue
        known.update(chain)
        text = "hangs on itself"
        if len(chain) > 1:
            text += ": " + " -> ".join((*chain, name))
        yield ("bodies", name, "parent"), f"{text}; a chain of bodies must begin at the ground"
