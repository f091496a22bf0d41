"""What a model says of the joints of a robot: damping, dry friction, rotor inertia, and the rest.

The sums over all elements on the coordinate of a joint, whether found or there before, in SI: a
URDF or an MJCF states one number of each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from symhyb.discrepancy.words.amounts import number_text
from symhyb.imports.names import identifier
from symhyb.imports.robot import STRAIGHT, Joint, Robot
from symhyb.model.expression import Expression, evaluate
from symhyb.model.scope import numbers_of
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


def losses_of(model: Model, robot: Robot) -> tuple[tuple[Losses, ...], tuple[str, ...]]:
    """The losses of every joint that is a coordinate of the model, and what was found elsewhere."""
    names = [coordinate.name for coordinate in model.coordinates]
    joints = {identifier(joint.name, "joint"): joint for joint in robot.joints}
    mine = {name: joints[name] for name in names if _moves(joints.get(name))}
    found = []
    for name, joint in mine.items():
        on = [one for one in model.elements if one.place == On(name)]
        sizes = dict.fromkeys(PLAIN, 0.0)
        more = []
        for element in on:
            if _is_plain(element):
                sizes[element.kind] += _size(model, element, element.value(PLAIN[element.kind]))
            elif element.found or element.kind not in PUSHED:
                more.append(_said(model, element))
        found.append(
            Losses(joint.name, sizes["damper"], sizes["friction"], sizes["added_mass"], tuple(more))
        )
    elsewhere = [
        f"{_said(model, one)}: it acts at no single joint"
        for one in model.elements
        if one.found and not (isinstance(one.place, On) and one.place.coordinate in mine)
    ]
    return tuple(found), tuple(elsewhere)


def _moves(joint: Joint | None) -> bool:
    return joint is not None and joint.kind in STRAIGHT


def _is_plain(element: Element) -> bool:
    """Whether an element is no more than the one number that a file of a robot knows."""
    if element.kind not in PLAIN:
        return False
    keys = {key for key, _ in element.values}
    return keys <= {PLAIN[element.kind], *BESIDE.get(element.kind, ())}


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
