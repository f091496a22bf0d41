"""What a model says of the joints of a robot: damping, dry friction, rotor inertia, and the rest.

The sums over all elements on the coordinate of a joint, whether found or there before, in SI: a
URDF or an MJCF states one number of each. Elements of a model whose machine MuJoCo has act beside
it: what the file of the robot states is part of these sums.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from symhyb.discrepancy.words.amounts import number_text
from symhyb.imports.names import identifier
from symhyb.imports.robot import STRAIGHT, Joint, Robot
from symhyb.model.expression import Expression, evaluate
from symhyb.model.scope import constant_of, numbers_of
from symhyb.model.switching import gradual
from symhyb.model.types import Element, Model, On

PLAIN = {"damper": "damping", "friction": "coulomb", "added_mass": "mass"}
"""The kinds that the files know, with the key of each."""
BESIDE = {"friction": frozenset({"transition"})}  # keys that say nothing of the size
PUSHED = ("force", "torque", "law")  # what drives a joint; only of what was found it is said


@dataclass(frozen=True, slots=True)
class Losses:
    """``damping`` (N·m·s/rad or N·s/m), ``friction`` (N·m or N) and ``armature`` (kg·m² or kg) of a
    ``joint``, by its name in the file of the robot; ``more`` says what has no place there."""

    joint: str
    damping: float
    friction: float
    armature: float
    more: tuple[str, ...] = ()


def losses_of(
    model: Model, robot: Robot, imported: Model | None = None, taken: frozenset[str] = frozenset()
) -> tuple[tuple[Losses, ...], tuple[str, ...]]:
    """The losses of every joint that is a coordinate of the model, and what was found elsewhere but
    for the elements that are ``taken`` as masses; ``imported`` is what an import of the robot's
    file finds there."""
    mine = {name: joint for name, joint in _joints(model, robot) if _moves(joint)}
    found = []
    for name, joint in mine.items():
        on = [one for one in model.elements if one.place == On(name)]
        sizes = _before(model, joint, name, imported)
        more = []
        for element in on:
            if _is_plain(element):
                sizes[element.kind] += _size(model, element, element.value(PLAIN[element.kind]))
                if gradual(model, element):
                    more.append(f"{_said(model, element)}: that it turns over gradually")
            elif not _stands_there(model, element, imported) and (
                element.found or element.kind not in PUSHED
            ):
                more.append(_said(model, element))
        found.append(
            Losses(joint.name, sizes["damper"], sizes["friction"], sizes["added_mass"], tuple(more))
        )
    elsewhere = [
        f"{_said(model, one)}: it acts at no single joint"
        for one in model.elements
        if one.found
        and one.name not in taken
        and not (isinstance(one.place, On) and one.place.coordinate in mine)
    ]
    return tuple(found), tuple(elsewhere)


def _joints(model: Model, robot: Robot) -> Iterator[tuple[str, Joint]]:
    """The joints that are coordinates of the model, by the names of these."""
    if model.mujoco is None:
        joints = {identifier(joint.name, "joint"): joint for joint in robot.joints}
        pairs = [(coordinate.name, coordinate.name) for coordinate in model.coordinates]
    else:
        joints = {joint.name: joint for joint in robot.joints}
        pairs = list(model.mujoco.joints)
    yield from ((name, joints[joint]) for name, joint in pairs if joint in joints)


def _before(
    model: Model, joint: Joint, coordinate: str, imported: Model | None
) -> dict[str, float]:
    """What a joint has before elements of the model add to it, SI: without those that an import
    makes, of itself and of joints that follow it by a ratio of 1."""
    if model.mujoco is None:
        if imported is None:
            return dict.fromkeys(PLAIN, 0.0)
        sizes = {"damper": joint.damping, "friction": joint.friction, "added_mass": joint.armature}
        for one in imported.elements:
            if one.place == On(coordinate) and one.kind in PLAIN:
                sizes[one.kind] -= _size(imported, one, one.value(PLAIN[one.kind]))
        return sizes
    values = {one.path: one.si for one in model.parameters}
    stated = {
        one.field: values[one.parameter]
        for one in model.mujoco.parameters
        if (one.kind, one.part) == ("joint", joint.name)
    }
    damping, armature = joint.motors
    return {
        "damper": stated["damping"] + damping if "damping" in stated else joint.damping,
        "friction": stated.get("frictionloss", joint.friction),
        "added_mass": stated["armature"] + armature if "armature" in stated else joint.armature,
    }


def _moves(joint: Joint) -> bool:
    return joint.kind in STRAIGHT


def _is_plain(element: Element) -> bool:
    """Whether an element is no more than the one number that a file of a robot knows."""
    if element.kind not in PLAIN:
        return False
    keys = {key for key, _ in element.values}
    return keys <= {PLAIN[element.kind], *BESIDE.get(element.kind, ())}


def _stands_there(model: Model, element: Element, imported: Model | None) -> bool:
    """Whether an element is one that the robot's file states, with the same numbers."""
    if imported is None:
        return False
    theirs = {one.name: one for one in imported.elements}.get(element.name)
    return theirs == element and all(
        constant_of(value, model) == constant_of(value, imported) for _, value in element.values
    )


def _size(model: Model, element: Element, expression: Expression | None) -> float:
    """The value of a key, SI; 0 where it is not set."""
    if expression is None:
        return 0.0
    return float(evaluate(expression, numbers_of(model, element)))


def _said(model: Model, element: Element) -> str:
    """An element with its values, as a comment says it."""
    own: Sequence[str] = [
        f"{one.name} = {number_text(one.value)} {one.unit.text}" for one in element.parameters
    ]
    return f"{element.name}, {element.kind}" + (f" ({', '.join(own)})" if own else "")
