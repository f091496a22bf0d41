r"""Where a body hangs, and how it is turned, in the words of a model file.

A body is turned by what the file of the robot says, in the same order: yaw, pitch and roll of the
joint's frame, then the joint about its axis. An axis that is none of x, y and z is turned onto one
of them before the joint, which are taken back after it:

    R = Rz(yaw) Ry(pitch) Rx(roll) · Rz(turn) Ry(tilt) · Rz(q) · Ry(−tilt) Rz(−turn)
"""

from dataclasses import dataclass
from math import atan2, hypot

import numpy as np

from symhyb.imports.draft import AXES, Draft, unit_of
from symhyb.imports.reduction import Moved
from symhyb.imports.rigid import SAME, from_rpy, to_rpy
from symhyb.imports.robot import STRAIGHT, TURNED, Array
from symhyb.model.expression import parse_expression
from symhyb.model.turned import Quaternion, Rotations

_RATIOS = {("m", "rad"): "m/rad", ("rad", "m"): "rad/m"}  # of a joint over the one it follows

Steps = list[tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Hung:
    """A place in the axes of the carrier, component by component, and how the body is turned."""

    at: list[str]
    turned: Rotations | Quaternion | None


def hung(draft: Draft, body: Moved) -> Hung:
    """Where a body hangs on its carrier, and how it is turned; its parameters are declared."""
    joint, stem = body.joint, draft.names.joints[body.joint.name]
    of = f"of {joint.name} in {body.carrier or 'the inertial axes'}"
    at = [
        draft.number(f"{stem}_o{axis}", value, "m", f"{axis} {of}")
        for axis, value in zip(AXES, body.pose.at, strict=True)
    ]
    if joint.kind in TURNED:
        return _quaternion(stem, at, joint.kind == "floating")
    steps = _origin(draft, stem, body, of)
    if joint.kind == "planar":
        at, more = _planar(draft, stem, body, at)
        steps += more
    elif joint.kind == "prismatic":
        way = body.pose.turned @ np.array(joint.axis)
        at = _along(draft, f"{stem}_d", at, way, position(draft, body))
    elif joint.kind in STRAIGHT:
        steps += _about(draft, stem, joint.axis, position(draft, body))
    if not steps:
        return Hung(at, None)
    turns = tuple((axis, parse_expression(angle)) for axis, angle in steps)
    return Hung(at, Rotations(turns))


def position(draft: Draft, body: Moved) -> str:
    """How far a joint with one coordinate is: that coordinate, or an expression of another's."""
    assert body.drive is not None
    if body.own:
        return draft.names.joints[body.joint.name]
    name, other = body.joint.name, body.drive.joint
    stem, leader = draft.names.joints[name], draft.names.joints[other]
    unit = _RATIOS.get((unit_of(body), draft.units[other]), "1")
    ratio, sign, factor = body.drive.ratio, "", ""
    if unit == "1" and abs(ratio) == 1:
        sign = "-" if ratio < 0 else ""
    else:
        factor = draft.number(f"{stem}_ratio", ratio, unit, f"{name} per {other}") + "*"
    text = f"{sign}{factor}{leader}"
    if body.drive.offset:
        where = f"{name} at {other} = 0"
        text += f" + {draft.number(f'{stem}_offset', body.drive.offset, unit_of(body), where)}"
    return text


def _origin(draft: Draft, stem: str, body: Moved, of: str) -> Steps:
    """The turns to the frame of the joint: as the file says, unless links that are welded between
    joints turn it on."""
    angles = body.joint.rpy
    if np.abs(from_rpy(angles) - body.pose.turned).max() >= SAME:
        angles = to_rpy(body.pose.turned)
    named = tuple(zip(AXES, ("roll", "pitch", "yaw"), angles, strict=True))
    steps = [
        (axis, draft.angle(f"{stem}_{word}", value, f"{word} {of}"))
        for axis, word, value in reversed(named)
    ]
    return [(axis, angle) for axis, angle in steps if angle != "0"]


def _about(draft: Draft, stem: str, axis: tuple[float, float, float], angle: str) -> Steps:
    """Turn by ``angle`` about a unit vector, by turns about x, y and z."""
    along = [k for k in range(3) if abs(axis[k]) >= SAME]
    if len(along) == 1:
        k = along[0]
        return [(AXES[k], angle if axis[k] > 0 else _back(angle))]
    if len(along) == 2:  # in the plane of two axes: turn one of them there
        k = 3 - sum(along)
        i, j = (k + 1) % 3, (k + 2) % 3
        said = f"axis from {AXES[i]}, about {AXES[k]}"
        turn = draft.angle(f"{stem}_turn", atan2(axis[j], axis[i]), said)
        return [(AXES[k], turn), (AXES[i], angle), (AXES[k], _back(turn))]
    turn = draft.angle(f"{stem}_turn", atan2(axis[1], axis[0]), "axis from x, about z")
    tilt = draft.angle(f"{stem}_tilt", atan2(hypot(axis[0], axis[1]), axis[2]), "axis from z")
    back = [("y", _back(tilt)), ("z", _back(turn))]
    return [("z", turn), ("y", tilt), ("z", angle), *back]


def _back(angle: str) -> str:
    """The same angle backwards."""
    if "+" in angle:
        return f"-({angle})"
    return angle[1:] if angle.startswith("-") else f"-{angle}"


def _along(draft: Draft, stem: str, at: list[str], way: Array, travel: str) -> list[str]:
    """A place that moves along a unit vector: at + way·travel, component by component."""
    moved = []
    for axis, place, part in zip(AXES, at, way, strict=True):
        if abs(part) < SAME:
            moved.append(place)
            continue
        if abs(abs(part) - 1) < SAME:
            term = travel if part > 0 else _back(travel)
        else:
            about = f"{axis} of the unit vector along which {travel} counts"
            size = draft.number(f"{stem}{axis}", part, "1", about)
            term = f"{size}*({travel})" if not travel.isidentifier() else f"{size}*{travel}"
        joiner = " " if term.startswith("-") else " + "
        moved.append(term if place == "0" else f"{place}{joiner}{term}")
    return moved


def _planar(draft: Draft, stem: str, body: Moved, at: list[str]) -> tuple[list[str], Steps]:
    """Travel along two directions across the axis, and turn about it."""
    axis = body.joint.axis
    for letter, name, way in zip("de", (f"{stem}_x", f"{stem}_y"), across(axis), strict=True):
        at = _along(draft, f"{stem}_{letter}", at, body.pose.turned @ way, name)
    return at, _about(draft, stem, axis, f"{stem}_angle")


def across(axis: tuple[float, float, float]) -> tuple[Array, Array]:
    """Two unit vectors (3,), dimensionless, that with ``axis`` as the third make a right-handed
    frame: of z, x and y."""
    third = np.array(axis)
    first = np.eye(3)[(int(np.argmax(np.abs(third))) + 1) % 3]
    first = first - (first @ third) * third
    first = first / np.linalg.norm(first)
    return first, np.cross(third, first)


def _quaternion(stem: str, at: list[str], floating: bool) -> Hung:
    """A quaternion, and three coordinates of place in the axes of the carrier if it is floating."""
    turned = Quaternion(tuple(f"{stem}_q{part}" for part in "wxyz"))
    if not floating:
        return Hung(at, turned)
    names = [f"{stem}_{axis}" for axis in AXES]
    moved = [
        name if place == "0" else f"{place} + {name}" for place, name in zip(at, names, strict=True)
    ]
    return Hung(moved, turned)
