"""A model of a robot: coordinates, parameters, points, bodies, losses, motors, sensors, limits.

Each number of the robot is a parameter of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from symhyb.imports.draft import AXES, Draft, Names, drafted, unit_of
from symhyb.imports.hanging import hung, position
from symhyb.imports.holding import declare_pin, declare_relation
from symhyb.imports.reduction import Moved, Reduced
from symhyb.imports.rigid import quaternion_of
from symhyb.imports.robot import TURNED, Robot
from symhyb.model.expression import parse_expression
from symhyb.model.limits import Limit
from symhyb.model.types import Body, Coordinate, Element, Input, Model, On, Point, Sensor, Vector
from symhyb.units import parse_unit

_ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_ROUNDING = 1e-15  # of the largest entry of a tensor: what turning it leaves of a zero


@dataclass(frozen=True, slots=True)
class Declared:
    """A model, the ``names`` in it, and for each body the parameters that are declared for it; for
    what holds bodies under an empty name."""

    model: Model
    names: Names
    groups: Mapping[str, tuple[str, ...]]


def declare(
    robot: Robot, reduced: Reduced, rates: bool = False, passive: Sequence[str] = ()
) -> Declared:
    """The model of a robot: with sensors of ``rates`` beside those of positions, and without motors
    in the ``passive`` joints."""
    holds = (*(pin.name for pin in reduced.pins), *(item.name for item in reduced.relations))
    draft = drafted(reduced.bodies, holds)
    gravity = _gravity(draft, robot)
    groups: dict[str, tuple[str, ...]] = {}
    heavy = _heavy(reduced.bodies)
    for body in reduced.bodies:
        before = len(draft.parameters)
        if body.name in heavy:
            _declare_body(draft, body)
            _declare_tips(draft, body)
        if body.drive is None:
            _free_coordinates(draft, body)
        else:
            _declare_losses(draft, body)
        if body.own and body.drive is not None:
            start = reduced.start[body.joint.name]
            _own_coordinate(draft, body, start, rates, body.joint.name not in reduced.open)
            driven = robot.driven is None or body.joint.name in robot.driven
            if driven and body.joint.name not in passive:
                _declare_motor(draft, body)
        groups[body.name] = tuple(item.name for item in draft.parameters[before:])
    before = len(draft.parameters)
    for pin in reduced.pins:
        declare_pin(draft, pin)
    for relation in reduced.relations:
        declare_relation(draft, relation, reduced)
    groups[""] = tuple(item.name for item in draft.parameters[before:])
    model = Model(
        title=robot.name,
        coordinates=tuple(draft.coordinates),
        parameters=tuple(draft.parameters),
        inputs=tuple(draft.inputs),
        points=tuple(draft.points),
        bodies=tuple(draft.bodies),
        elements=tuple(draft.elements),
        sensors=tuple(draft.sensors),
        limits=tuple(draft.limits),
        gravity=_vector(gravity),
        constraints=tuple(draft.constraints),
    )
    return Declared(model, draft.names, groups)


def _vector(parts: Sequence[str]) -> Vector:
    return tuple(parse_expression(part) for part in parts)


def _gravity(draft: Draft, robot: Robot) -> list[str]:
    """The field of gravity, along an axis or by components."""
    parts = robot.gravity
    if parts[0] == parts[1] == 0 and parts[2] < 0:
        return ["0", "0", f"-{draft.number('g', -parts[2], 'm/s^2', 'gravity')}"]
    return [
        draft.number(f"g_{axis}", part, "m/s^2", f"gravity along {axis}")
        for axis, part in zip(AXES, parts, strict=True)
    ]


def _heavy(bodies: Sequence[Moved]) -> frozenset[str]:
    """The bodies that move any mass or inertia: their own, or that of others that hang on them."""
    found: set[str] = set()
    for body in reversed(bodies):
        if body.inertial is not None or body.name in found:
            found |= {body.name, body.carrier}
    return frozenset(found)


def _declare_body(draft: Draft, body: Moved) -> None:
    """Declare a body: how it hangs on its carrier, and its mass."""
    links, place = draft.names.links, hung(draft, body)
    turns = bool(body.carrier) or place.turned is not None
    mass, centre, inertia, tensor = _mass(draft, body, turns)
    draft.bodies.append(
        Body(
            links[body.name],
            parse_expression(mass),
            _vector(centre),
            inertia=parse_expression(inertia) if inertia else None,
            parent=links[body.carrier] if body.carrier else "",
            joint=_vector(place.at),
            turned=place.turned,
            tensor=_vector(tensor),
        )
    )


def _declare_tips(draft: Draft, body: Moved) -> None:
    """Declare points where a body may carry something."""
    for tip in body.tips:
        stem = draft.names.points[tip.name]
        at = [
            draft.number(f"{stem}_{axis}", value, "m", f"{axis} of {tip.name} in {body.name}")
            for axis, value in zip(AXES, tip.at, strict=True)
        ]
        draft.points.append(Point(stem, _vector(at), draft.names.links[body.name]))


def _mass(draft: Draft, body: Moved, turns: bool) -> tuple[str, list[str], str, list[str]]:
    """Mass, centre, and inertia as one value or as a tensor, of what is welded together; what never
    ``turns`` has no use for inertia."""
    stem, inertial = draft.names.links[body.name], body.inertial
    if inertial is None:
        return "0", ["0"] * 3, "", []
    mass = draft.number(f"{stem}_m", inertial.mass, "kg", f"mass of {body.name}")
    centre = [
        draft.number(f"{stem}_c{axis}", value, "m", f"{axis} of the centre of mass")
        for axis, value in zip(AXES, inertial.centre, strict=True)
    ]
    if not turns:
        return mass, centre, "", []
    values = [float(inertial.tensor[entry]) for entry in _ENTRIES]
    largest, unit = max(map(abs, values)), "kg*m^2"
    values = [0.0 if abs(value) < _ROUNDING * largest else value for value in values]
    if not any(values[3:]) and len(set(values[:3])) == 1:
        about = "about every axis through the centre of mass"
        return mass, centre, draft.number(f"{stem}_J", values[0], unit, about), []
    tensor = []
    for (i, j), value in zip(_ENTRIES, values, strict=True):
        axes = AXES[i] + AXES[j]
        tensor.append(
            draft.number(f"{stem}_J{axes}", value, unit, f"{axes}, about the centre of mass")
        )
    return mass, centre, "", tensor if any(values[3:]) else tensor[:3]


def _own_coordinate(draft: Draft, body: Moved, start: float, rates: bool, stated: bool) -> None:
    """Declare the coordinate of a joint, whose start may be ``stated``, its sensors and limits."""
    joint, stem, unit = body.joint, draft.names.joints[body.joint.name], parse_unit(unit_of(body))
    about = f"{body.name} against {joint.parent or 'the ground'}"
    said = ("start",) if stated else ()
    draft.coordinates.append(Coordinate(stem, unit, start, about=about, stated=said))
    draft.sensors.append(Sensor(stem, parse_expression(stem), unit, about="position"))
    if rates:
        rate = parse_unit(f"{unit_of(body)}/s")
        draft.sensors.append(
            Sensor(f"{stem}_rate", parse_expression(f"{stem}'"), rate, about="rate")
        )
    if joint.range.travel or joint.range.speed:
        draft.limits.append(Limit(stem, unit, joint.range.travel, joint.range.speed))


def _free_coordinates(draft: Draft, body: Moved) -> None:
    """Declare the coordinates of a joint that has several, and a sensor of each."""
    stem, kind = draft.names.joints[body.joint.name], body.joint.kind
    lengths = {"floating": AXES, "planar": AXES[:2]}.get(kind, "")
    declared = [(f"{stem}_{axis}", "m", 0.0) for axis in lengths]
    if kind in TURNED:
        parts = zip("wxyz", quaternion_of(body.pose.turned), strict=True)
        declared += [(f"{stem}_q{part}", "1", float(value)) for part, value in parts]
    else:
        declared.append((f"{stem}_angle", "rad", 0.0))
    for name, text, start in declared:
        unit = parse_unit(text)
        about = f"{'place' if text == 'm' else 'turn'} of {body.name}"
        draft.coordinates.append(Coordinate(name, unit, start, about=about))
        draft.sensors.append(Sensor(name, parse_expression(name), unit))


def _declare_losses(draft: Draft, body: Moved) -> None:
    """Declare damping, dry friction, rotor and spring of a joint with one coordinate."""
    joint, stem = body.joint, draft.names.joints[body.joint.name]
    turns = unit_of(body) == "rad"
    losses = (
        ("damper", "damping", "damping", joint.damping, "N*m*s/rad" if turns else "N*s/m"),
        ("friction", "coulomb", "friction", joint.friction, "N*m" if turns else "N"),
        ("added_mass", "mass", "rotor", joint.armature, "kg*m^2" if turns else "kg"),
    )
    place = On(position(Draft(draft.names, draft.units), body))  # its parameters are declared
    for kind, key, suffix, value, unit in losses:
        if value:
            name = draft.number(f"{stem}_{suffix}", value, unit, f"{suffix} in {joint.name}")
            draft.elements.append(Element(name, kind, place, ((key, parse_expression(name)),)))
    if joint.spring is not None:
        stiffness, rest = joint.spring
        about = f"stiffness in {joint.name}"
        name = draft.number(f"{stem}_spring", stiffness, "N*m/rad" if turns else "N/m", about)
        at = draft.number(f"{stem}_rest", rest, unit_of(body), "where its spring rests")
        place = On(place.coordinate if at == "0" else f"{place.coordinate} - {at}")
        draft.elements.append(
            Element(name, "spring", place, (("stiffness", parse_expression(name)),))
        )


def _declare_motor(draft: Draft, body: Moved) -> None:
    """Declare the input and the element that drive a joint, and how strongly they may."""
    joint, stem = body.joint, draft.names.joints[body.joint.name]
    key, unit = ("torque", "N*m") if unit_of(body) == "rad" else ("force", "N")
    name, force = f"{stem}_{key}", parse_unit(unit)
    draft.inputs.append(Input(name, force, f"on {body.name}, along + of {joint.name}"))
    draft.elements.append(Element(f"{stem}_motor", key, On(stem), ((key, parse_expression(name)),)))
    if joint.range.effort:
        draft.limits.append(Limit(name, force, (-joint.range.effort, joint.range.effort)))
