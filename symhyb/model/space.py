"""Check what only a model in space says, and where a sequence of rotations locks.

Two rotations that turn about one axis are one rotation: with three about named axes that happens
where the cosine of the second angle is 0 (or its sine, if first and third axis have one name).

          first axis                     gimbal lock: the second angle has turned the third axis
             ^                           on the first; nothing turns about the third direction
             |  second angle
        third \\__o______ second axis
"""

from collections.abc import Iterator, Mapping
from math import cos, degrees, hypot, inf, isfinite, sin

import numpy as np
from numpy.typing import NDArray

from symhyb.limits import HANGING_DEEP
from symhyb.model.expression import Expression, ExpressionError, Name, evaluate, names
from symhyb.model.scope import MASS, POSITION, Scope, constant_of, expression_faults
from symhyb.model.source import Path
from symhyb.model.tables import Fault, shorten
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import At, Body, Element, Model, Vector
from symhyb.model.vocabulary import KINDS
from symhyb.units import ONE, Unit

Values = dict[tuple[str, int] | str, NDArray[np.float64] | float]

UNIT_LENGTH = 1e-3  # how far a quaternion may begin from length 1: four digits by hand are enough
SLIGHT = 1e-9  # relative: rounding of moments of inertia that are equal
LOCKED = 1e-3  # |cos| (or |sin|) of the second angle: within 0.06 degrees of gimbal lock


def dimension(model: Model) -> int:
    """Return 3 if the model is in space, else 2."""
    return next((len(vector) for _, vector in vectors(model)), 2)


def vectors(model: Model) -> Iterator[tuple[Path, Vector]]:
    """Yield every vector of a model with its place in the file, those that decide first."""
    if model.gravity is not None:
        yield ("gravity",), model.gravity
    for point in model.points:
        yield ("points", point.name), point.at
    named = [point.at for point in model.points]
    for body in model.bodies:
        for key, vector in (("joint", body.joint), ("at", body.at)):
            if vector is not None and vector not in named:
                yield ("bodies", body.name, key), vector


def space_faults(model: Model, scope: Scope, inertia: Unit | None) -> Iterator[Fault]:
    """Yield mixtures of plane and space, and what is wrong with how bodies in space are turned;
    ``inertia`` is the unit of a moment of inertia, None where it cannot be known."""
    size = dimension(model)
    yield from _mixture_faults(model, size)
    if size == 3:
        yield from _depth_faults(model)
    taken: dict[str, str] = {}
    for body in model.bodies:
        path: Path = ("bodies", body.name)
        if size == 2 and (body.turned is not None or body.tensor):
            key = "inertia" if body.turned is None else _key(body.turned)
            yield (*path, key), "is for a body in space, whose vectors have three components"
            continue
        if size == 3 and body.angle is not None:
            cure = f'rotations = [["z", "{shorten(body.angle.text)}"]] turns it about its z axis'
            yield (*path, "angle"), f"turns a body in the plane; {cure}"
        if isinstance(body.turned, Rotations):
            for _, angle in body.turned.steps:
                yield from expression_faults((*path, "rotations"), angle, scope, POSITION, ONE)
        if isinstance(body.turned, Quaternion):
            yield from _quaternion_faults(body, body.turned, model, taken)
        faults = [
            fault
            for part in body.tensor
            for fault in expression_faults((*path, "inertia"), part, scope, MASS, inertia)
        ]
        yield from faults or _inertia_faults(body, model)
    for element in model.elements:
        yield from _element_faults(element, model, size)


def _key(turned: Rotations | Quaternion) -> str:
    return "rotations" if isinstance(turned, Rotations) else "quaternion"


def _mixture_faults(model: Model, size: int) -> Iterator[Fault]:
    """All vectors have as many components as the first one."""
    words = {1: "one", 2: "two", 3: "three"}
    first: Path | None = None
    for path, vector in vectors(model):
        first = first or path
        if len(vector) != size:
            text = f"has {words[len(vector)]} components, but {'.'.join(first)} has {words[size]}"
            yield path, f"{text}; a model is in the plane (two) or in space (three)"
    for element in model.elements:
        counts = _counts(element)
        for key, count in counts.items():
            if count != size:
                text = f"has {words[count]} components; the vectors of this model have"
                yield ("elements", element.name, key), f"{text} {words[size]}"


def _depth_faults(model: Model) -> Iterator[Fault]:
    """The first body below so many others that its attitude is an expression without end."""
    parents = {body.name: body.parent for body in model.bodies if body.joint is not None}
    depths: dict[str, int] = {}
    for name in parents:
        way, at = [name], parents[name]
        while at in parents and at not in depths and len(way) <= len(parents):
            way.append(at)
            at = parents[at]
        for one in reversed(way):
            depths[one] = depths.get(parents[one], 0) + 1
        if depths[name] > HANGING_DEEP:
            text = f"hangs below {depths[name] - 1} others; at most {HANGING_DEEP - 1} are computed"
            yield ("bodies", name, "parent"), text
            return


def _counts(element: Element) -> dict[str, int]:
    found: dict[str, int] = {}
    for key, _ in element.values:
        name, dot, _axis = key.partition(".")
        if dot:
            found[name] = found.get(name, 0) + 1
    return found


def _quaternion_faults(
    body: Body, turned: Quaternion, model: Model, taken: dict[str, str]
) -> Iterator[Fault]:
    """Four free coordinates of unit 1, of one body alone, that begin at length 1."""
    path = ("bodies", body.name, "quaternion")
    declared = {c.name: c for c in model.coordinates}
    parts = [declared.get(name) for name in turned.parts]
    for name, part in zip(turned.parts, parts, strict=True):
        if part is None:
            yield path, f"'{shorten(name)}' is not a coordinate; its four parts are coordinates"
        elif part.imposed:
            yield path, f"'{name}' is imposed; the parts of a quaternion are free coordinates"
        elif not part.unit.is_number or part.unit.factor != 1.0:
            yield path, f"the coordinate '{name}' is in {part.unit}, needs 1"
        elif name in taken:
            where = "twice" if taken[name] == body.name else f"by the body '{taken[name]}' too"
            yield path, f"'{name}' is used {where}; each part is a coordinate of its own"
        taken.setdefault(name, body.name)
    if body.inertia is None and not body.tensor and body.joint is not None:
        yield ("bodies", body.name), "has 'quaternion' but no 'inertia'; its turning needs one"
    found = [part.start for part in parts if part is not None]
    length = hypot(*found)  # infinite where the sum of squares would raise
    if len(found) == 4 and abs(length - 1) > UNIT_LENGTH:
        starts = ", ".join(f"{start:g}" for start in found)
        cure = "start = 1.0 of the first part means: not turned"
        if 0 < length < inf:
            cure = f"divide each start by {length:.6g}"
        yield path, f"begins at ({starts}), whose length is {length:.6g}; it must be 1: {cure}"


def _inertia_faults(body: Body, model: Model) -> Iterator[Fault]:
    """Moments of inertia that no body has, where their values are known from parameters."""
    values = [constant_of(part, model) for part in body.tensor]
    known = [value for value in values if value is not None and isfinite(value)]
    if len(known) < 3 or len(known) != len(values):
        return
    path = ("bodies", body.name, "inertia")
    xx, yy, zz, xy, xz, yz = (*known, 0.0, 0.0, 0.0)[:6]
    principal = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    low, middle, high = (float(value) for value in principal)
    listed = f"the principal values are {low:.4g}, {middle:.4g} and {high:.4g} kg*m^2"
    if low < -SLIGHT * high or high <= 0:
        yield path, f"is not positive definite: {listed}; a moment of inertia is not negative"
    elif low + middle < high * (1 - SLIGHT):
        text = "the largest is at most the sum of the other two"
        yield path, f"is that of no body: {listed}, but {text} (triangle inequality)"


def _element_faults(element: Element, model: Model, size: int) -> Iterator[Fault]:
    """A torque in space, and an inertia, belong to the body to which their point is fixed."""
    if not isinstance(element.place, At):
        return
    name = element.place.point
    point = next((item for item in model.points if item.name == name), None)
    turned = "a torque" if element.kind == "torque" and size == 3 else ""
    turned = "an inertia" if KINDS[element.kind].turns else turned
    if turned and point is not None and not point.body:
        text = f"the point '{name}' is fixed to no body, so {turned} there turns nothing"
        yield ("elements", element.name, "at"), f"{text}; declare the point with its body"


def quaternion_parts(model: Model) -> frozenset[str]:
    """Return the coordinates that are parts of quaternions: none of them has a force of its own."""
    turned = (body.turned for body in model.bodies)
    return frozenset(name for item in turned if isinstance(item, Quaternion) for name in item.parts)


def second_angles(model: Model) -> Iterator[tuple[Body, Expression, bool]]:
    """Yield the second angle of every body that is turned by three rotations, and whether it
    locks where its sine is 0 (first and third axis of one name) instead of its cosine."""
    for body in model.bodies:
        steps = body.turned.steps if isinstance(body.turned, Rotations) else ()
        if len(steps) == 3 and steps[1][0] not in (steps[0][0], steps[2][0]):
            yield body, steps[1][1], steps[0][0] == steps[2][0]


def gimbal_lock(model: Model, places: Mapping[str, float], near: float = LOCKED) -> str:
    """Say which body is at gimbal lock (|cos| below ``near``) and at which angle; empty if none is.
    ``places`` are the coordinates by name, SI; a sequence of which an angle does not move locks
    nothing."""
    values: Values = {parameter.name: parameter.si for parameter in model.parameters}
    for name, value in {"t": 0.0, **places}.items():
        values[name] = value
    coordinates = {coordinate.name for coordinate in model.coordinates}
    for body, angle, by_sine in second_angles(model):
        steps = body.turned.steps if isinstance(body.turned, Rotations) else ()
        moving = [{name.name for name in names(a)} & coordinates for _, a in (steps[0], steps[2])]
        if not all(moving):
            continue
        try:
            value = float(evaluate(angle, values, model.characteristics()))
        except (KeyError, ExpressionError):
            continue
        if not abs(sin(value) if by_sine else cos(value)) < near:
            continue
        called = angle.tree.name if isinstance(angle.tree, Name) else f"'{shorten(angle.text)}'"
        first, third = steps[0][1].text, steps[2][1].text
        how = "at" if near == LOCKED else "close to"
        return (
            f"the body '{body.name}' is {how} gimbal lock: at {called} = {degrees(value):.4g} deg "
            f"the rotations by {shorten(first)} and {shorten(third)} have one axis; turn it by a "
            "sequence of other axes that does not come there, or by a quaternion"
        )
    return ""
