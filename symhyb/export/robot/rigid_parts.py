"""What is rigid with bodies of a model: their own masses, what points carry, bodies fixed there."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from symhyb.imports.draft import AXES
from symhyb.imports.rigid import Pose, about, here, pseudo_inertia
from symhyb.imports.robot import Array, Inertial
from symhyb.model.expression import Expression
from symhyb.model.scope import constant_of
from symhyb.model.turned import Rotations
from symhyb.model.types import At, Body, Element, Model, Point

CARRIED = {"payload": "mass", "added_inertia": "inertia"}
"""The kinds that add to the mass of the body of a point, with the key of each."""
_MIXED = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The ``total`` P (4, 4) of what is rigid with a body, SI, in its axes, None where that is no
    constant; ``carried`` are the elements in it."""

    total: Array | None
    carried: frozenset[str] = frozenset()

    def more(self, added: Array | None, element: str = "") -> "Part":
        """With another part, of an element if it has a name."""
        total = None if self.total is None or added is None else self.total + added
        return Part(total, self.carried | ({element} if element else set()))


def rigid_with(model: Model, imported: Model) -> tuple[dict[str, Part], list[str]]:
    """What is rigid with each body of an ``imported`` model, in a model that was made of that; and
    notes on bodies that are rigid with none."""
    bodies = {body.name: body for body in model.bodies}
    roots = frozenset(body.name for body in imported.bodies)
    found = {name: Part(np.zeros((4, 4))) for name in roots}
    notes = []
    for body in model.bodies:
        place = _place(body.name, bodies, roots, model)
        if place is None:
            notes.append(f"{body.name}: a body that is rigid with no link; not written")
        elif place[0]:
            mine, at = own(body, model), place[1].matrix
            added = None if mine is None else at @ mine @ at.T
            found[place[0]] = found[place[0]].more(added)
    points = {point.name: point for point in model.points}
    for element in model.elements:
        if element.kind not in CARRIED or not isinstance(element.place, At):
            continue
        point = points[element.place.point]
        place = _place(point.body, bodies, roots, model) if point.body else None
        added = _carried(element, point, model)
        if place is not None and place[0] and added is not None:
            at = place[1].matrix
            found[place[0]] = found[place[0]].more(at @ added @ at.T, element.name)
    return found, notes


def _carried(element: Element, point: Point, model: Model) -> Array | None:
    """P (4, 4), SI, of an element at a point, in the axes of its body; None if no constant."""
    key = CARRIED[element.kind]
    size, at = element.value(key), _constants(point.at, model)
    amount = 0.0 if size is None else constant_of(size, model, element.parameters)
    if at is None or amount is None:
        return None
    mass, inertia = (amount, 0.0) if key == "mass" else (0.0, amount)
    return pseudo_inertia(Inertial(mass, np.array(at), inertia * np.eye(3)))


def own(body: Body, model: Model) -> Array | None:
    """P (4, 4), SI, of the numbers of a body in space itself; None if they are no constants."""
    inertia = () if body.inertia is None else (body.inertia,) * 3
    numbers = _constants([body.mass, *body.at, *(body.tensor or inertia)], model)
    if numbers is None or len(body.at) != 3:
        return None
    tensor = np.zeros((3, 3))
    for entry, value in zip(((0, 0), (1, 1), (2, 2), *_MIXED), numbers[4:], strict=False):
        tensor[entry] = tensor[entry[::-1]] = value
    return pseudo_inertia(Inertial(numbers[0], np.array(numbers[1:4]), tensor))


def _place(
    name: str, bodies: Mapping[str, Body], roots: frozenset[str], model: Model
) -> tuple[str, Pose] | None:
    """Which of the ``roots`` a body is rigid with, and its pose in that; "" for the ground, None
    for one that moves on its own."""
    pose = here()
    while name and name not in roots:
        body = bodies[name]
        at = None if body.joint is None else _constants(body.joint, model)
        turned = _turned(body, model)
        if at is None or len(at) != 3 or turned is None:
            return None
        pose = Pose(turned, np.array(at)).then(pose)
        name = body.parent
    return name, pose


def _turned(body: Body, model: Model) -> Array | None:
    """R (3, 3) of a body that is turned by constant angles, None of others."""
    if body.turned is None:
        return np.eye(3)
    if not isinstance(body.turned, Rotations):
        return None
    angles = _constants([angle for _, angle in body.turned.steps], model)
    if angles is None:
        return None
    axes = [AXES.index(axis) for axis, _ in body.turned.steps]
    return reduce(np.matmul, map(about, axes, angles), np.eye(3))


def _constants(expressions: Sequence[Expression], model: Model) -> list[float] | None:
    """The values of expressions, SI; None if one depends on more than parameters."""
    values = [constant_of(expression, model) for expression in expressions]
    known = [value for value in values if value is not None]
    return known if len(known) == len(values) else None
