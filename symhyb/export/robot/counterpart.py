"""The model that an import would make of a robot's file as it is, with the joints of a model."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from symhyb.discrepancy.words.amounts import number_text
from symhyb.errors import InputError
from symhyb.imports.declare import Declared, declare
from symhyb.imports.names import identifier
from symhyb.imports.reduction import Moved, Reduced, Wish, freed, reduced
from symhyb.imports.robot import MOVING, STRAIGHT, Joint, Robot
from symhyb.model.expression import Expression, names
from symhyb.model.types import Body, Model, On


@dataclass(frozen=True, slots=True)
class Counterpart:
    """What the import makes: the ``reduced`` robot and what is ``declared`` of it."""

    reduced: Reduced
    declared: Declared

    def body(self, moved: Moved) -> Body | None:
        """The body of the imported model, None if it moves no mass."""
        name = self.declared.names.links[moved.name]
        return next((body for body in self.declared.model.bodies if body.name == name), None)


def counterpart(model: Model, robot: Robot) -> Counterpart | None:
    """The import of the robot in which those joints move that are coordinates of the model; None
    if it has none of them, or nothing with mass would move."""
    known = frozenset(coordinate.name for coordinate in model.coordinates)
    chosen = tuple(joint.name for joint in robot.joints if _is_in(joint, known))
    free = _is_in(freed(robot)[0], known)
    if not (chosen or free):
        return None
    try:
        found = reduced(robot, Wish(chosen, free=free))
    except InputError:
        return None
    return Counterpart(found, declare(robot, found))


def _is_in(joint: Joint, coordinates: frozenset[str]) -> bool:
    """Whether a joint with a position of its own is among the coordinates."""
    if joint.kind not in MOVING or joint.mimic is not None:
        return False
    stem = identifier(joint.name, "joint")
    last = "" if joint.kind in STRAIGHT else "_angle" if joint.kind == "planar" else "_qw"
    return stem + last in coordinates


def adrift(found: Reduced, robot: Robot) -> frozenset[str]:
    """The links whose place in their body hangs on the position of a joint that is locked, which a
    model file does not state."""
    moving = {body.joint.name for body in found.bodies}
    links: set[str] = set()
    for joint in robot.joints:
        if joint.name in found.locked or (joint.parent in links and joint.name not in moving):
            links.add(joint.child)
    return frozenset(links)


def before_estimation(model: Model) -> Model:
    """The model with the values that its parameters had before a diagnosis changed them."""
    values = tuple(
        one if one.was is None else replace(one, value=one.was) for one in model.parameters
    )
    return replace(model, parameters=values)


def unwritten(model: Model) -> tuple[str, ...]:
    """What a diagnosis changed that is neither a mass nor at a joint: lengths, angles, gravity."""
    masses = (part for body in model.bodies for part in _numbers(body))
    sizes = (
        value
        for element in model.elements
        if isinstance(element.place, On) and element.place.plain
        for _, value in element.values
    )
    written = {name.name for expression in (*masses, *sizes) for name in names(expression)}
    return tuple(
        f"{one.name} = {number_text(one.value)} {one.unit.text}: not written, the file keeps "
        f"{number_text(one.was)}"
        for one in model.parameters
        if one.was is not None and one.name not in written
    )


def _numbers(body: Body) -> Iterator[Expression]:
    yield from (body.mass, *body.at, *body.tensor)
    if body.inertia is not None:
        yield body.inertia
