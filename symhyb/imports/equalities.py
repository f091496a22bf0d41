r"""What stands under <equality> of an MJCF: what closes loops and what holds joints to others.

    connect    two places are one                     a pin
    weld       two bodies do not move against each    three pins 0.14 m beside a place;
               other                                  a lone joint between them is locked
    joint      q = c₀ + c₁ p + … + c₄ p⁴ of another   a straight line: q follows, as a mimic; else
                                                      a relation; without another: q is locked

What MuJoCo holds by soft forces is held exactly. Source: MuJoCo's mj_instantiateEquality.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from symhyb.imports.compiled import Compiled, unused
from symhyb.imports.rigid import SAME, Pose, from_quaternion, here
from symhyb.imports.robot import Array, Mimic, Relation

_CONNECT, _WELD, _JOINT = 0, 1, 2  # types of equalities
_SITE = 6  # the type of an object
_SLIDE = 2  # the type of a joint
_LEVERS = {  # m, from the place of a weld to its pins: on no axis that a hinge there would have
    "_1": np.array([0.1, 0.1, 0.0]),
    "_2": np.array([0.0, 0.1, 0.1]),
    "_3": np.array([0.1, 0.0, 0.1]),
}


class End(NamedTuple):
    """A place, ``at`` (3,), m, in the axes of a ``body``."""

    body: int
    at: Array


@dataclass(frozen=True, slots=True)
class Held:
    """What holds: joints by name that follow others (``mimics``) or are ``locked`` at a position,
    ``relations`` of others, ``pins`` by name, and ``notes`` on what is left out."""

    mimics: dict[str, Mimic] = field(default_factory=dict)
    locked: dict[str, float] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    pins: dict[str, tuple[End, End]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def equalities(model: Compiled) -> Held:
    """What the equalities of a model hold."""
    held, taken = Held(), set[str]()
    for row, kind in enumerate(model.arrays["eq_type"]):
        about = f"condition {row + 1} under <equality> is left out"
        if not model.arrays["eq_active0"][row]:
            held.notes.append(f"{about}: it is not active")
        elif kind == _JOINT:
            _hold_joint(model, row, held, taken, about)
        elif kind not in (_CONNECT, _WELD):
            held.notes.append(f"{about}: it holds no joints and no bodies")
        elif any(_driven(model, pose[0]) for pose in _frames(model, row)):
            held.notes.append(f"{about}: a mocap body is moved from outside")
        else:
            _hold_bodies(model, row, held, taken)
    return held


def _name(model: Compiled, row: int, parts: tuple[str, str], taken: set[str]) -> str:
    """The name of an equality, or that of what it holds."""
    return unused(model.equalities[row] or "_".join(filter(None, parts)), taken)


def _hold_joint(model: Compiled, row: int, held: Held, taken: set[str], about: str) -> None:
    """A joint that follows another, or stands."""
    ids = [model.index(f"eq_obj{end}id", row) for end in (1, 2)]
    first, second = (model.joints[one] if one >= 0 else "" for one in ids)
    places = [float(model.arrays["qpos0"][model.index("jnt_qposadr", one)]) for one in ids]
    bent = Polynomial(model.arrays["eq_data"][row][:5])
    whole = bent(Polynomial([-places[1] if second else 0.0, 1.0])) + places[0]
    coefficients = [*(float(part) for part in whole.coef), 0.0][: 5 if second else 1]
    alone = first not in held.mimics and first not in held.locked
    if alone and not second:
        held.locked[first] = coefficients[0]
    elif first in held.locked and not second:
        held.notes.append(f"{about}: the joint '{first}' is locked already")
    elif alone and not any(coefficients[2:]) and first not in _followed(second, held.mimics):
        held.mimics[first] = Mimic(second, coefficients[1], coefficients[0])
    else:
        name = _name(model, row, (first, second), taken)
        unit, other = ("m" if model.index("jnt_type", k) == _SLIDE else "rad" for k in ids)
        relation = Relation(name, first, second, tuple(coefficients), (unit, other))
        held.relations.append(relation)


def _followed(joint: str, mimics: Mapping[str, Mimic]) -> Iterator[str]:
    """A joint and those that it follows."""
    while joint in mimics:
        yield joint
        joint = mimics[joint].joint
    yield joint


def _frames(model: Compiled, row: int) -> tuple[tuple[int, Pose], tuple[int, Pose]]:
    """The bodies of a connect or a weld with the frames in them that become one, of a connect by
    their origins alone."""
    arrays = model.arrays
    ids, data = [model.index(f"eq_obj{end}id", row) for end in (1, 2)], arrays["eq_data"][row]
    if arrays["eq_objtype"][row] == _SITE:
        first, second = (
            Pose(from_quaternion(arrays["site_quat"][one]), arrays["site_pos"][one]) for one in ids
        )
        bodies = [model.index("site_bodyid", one) for one in ids]
        return (bodies[0], first), (bodies[1], second)
    if arrays["eq_type"][row] == _CONNECT:
        ends = data[:3], data[3:6]
        return (ids[0], Pose(np.eye(3), ends[0])), (ids[1], Pose(np.eye(3), ends[1]))
    turned = from_quaternion(data[6:10])
    return (ids[0], Pose(turned, data[3:6])), (ids[1], Pose(np.eye(3), data[:3]))


def _hold_bodies(model: Compiled, row: int, held: Held, taken: set[str]) -> None:
    """A connect or a weld."""
    frames = _frames(model, row)
    (first, one), (second, other) = frames
    name = _name(model, row, (model.bodies[first], model.bodies[second]), taken)
    whole = model.arrays["eq_type"][row] == _WELD and model.arrays["eq_data"][row][10] != 0
    joints = _between(model, first, second)
    here, there = _drawn(model, first).then(one), _drawn(model, second).then(other)
    joint = model.joints[joints[0]] if len(joints) == 1 else ""
    if whole and joint and joint not in held.mimics and _same(here, there):
        held.locked[joint] = float(model.arrays["qpos0"][model.index("jnt_qposadr", joints[0])])
        held.notes.append(f"the weld '{name}' locks the joint '{joint}'")
        return
    for suffix, lever in _LEVERS.items() if whole else [("", np.zeros(3))]:
        pin = unused(name + suffix, taken) if suffix else name
        begin, end = (End(body, pose.turned @ lever + pose.at) for body, pose in frames)
        held.pins[pin] = begin, end


def _chain(model: Compiled, body: int) -> list[int]:
    """A body and its carriers up to the world."""
    found = [body]
    while found[-1]:
        found.append(model.index("body_parentid", found[-1]))
    return found


def _between(model: Compiled, first: int, second: int) -> list[int]:
    """The joints by which one body moves against the other."""
    apart = {*_chain(model, first)} ^ {*_chain(model, second)}
    begins = {body: model.index("body_jntadr", body) for body in apart}
    return [begins[body] + k for body in apart for k in range(model.index("body_jntnum", body))]


def _driven(model: Compiled, body: int) -> bool:
    """Whether a body is rigid with one that is moved from outside."""
    for one in _chain(model, body):
        if model.arrays["body_mocapid"][one] >= 0:
            return True
        if model.index("body_jntnum", one):
            return False
    return False


def _drawn(model: Compiled, body: int) -> Pose:
    """Where a body lies in the world as the file draws it."""
    pose = here()
    for one in reversed(_chain(model, body)):
        turned = from_quaternion(model.arrays["body_quat"][one])
        pose = pose.then(Pose(turned, model.arrays["body_pos"][one]))
    return pose


def _same(one: Pose, other: Pose) -> bool:
    return bool(
        np.abs(one.at - other.at).max() < SAME and np.abs(one.turned - other.turned).max() < SAME
    )
