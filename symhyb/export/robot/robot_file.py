"""The owner's file of a robot with what a model says of it: a URDF or an MJCF.

What the format has a place for is written there: damping and friction under ``<dynamics>`` of a
URDF; damping, frictionloss and armature of an MJCF's joint; masses and inertias under
``<inertial>``. What it cannot say stands in a comment at the joint or link. All else stays as it
was, letter by letter.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.export.robot import inertials
from symhyb.export.robot.counterpart import counterpart, unwritten
from symhyb.export.robot.losses import Losses, losses_of
from symhyb.export.robot.masses import Masses, masses_of, of_inertial, same
from symhyb.export.robot.spans import (
    Change,
    Span,
    before,
    changed,
    comment,
    first_inside,
    last_inside,
    spans_of,
    with_attributes,
)
from symhyb.imports.deliver import parse_robot, read_robot
from symhyb.imports.robot import Inertial, Robot
from symhyb.limits import ROBOT_BYTES, content_of
from symhyb.model.types import Model

FORMATS = {"urdf": "robot", "mjcf": "mujoco"}  # by the outermost element of their files
NEAR = 1e-9  # of a number: it is read back as it was written


@dataclass(frozen=True, slots=True)
class Rewritten:
    """The ``text`` of a robot's file, and ``notes`` on what was changed and what has no place."""

    text: str
    notes: tuple[str, ...]


def rewritten(model: Model, source: Path, form: str) -> Rewritten:
    """The file of a robot (``form`` urdf or mjcf) with the losses and masses of a model.

    Raises:
        InputError: a file of the other format, one that cannot be read, or a model none of whose
            coordinates is a joint of it.
    """
    robot, file = read_robot(source), str(source)
    text = _text_of(source)
    root = spans_of(text)
    if root.tag != FORMATS[form]:
        other = next((name for name, tag in FORMATS.items() if tag == root.tag), "another format")
        raise InputError(Problem(f"is {other}, not {form}; use --to {other}", file=file))
    base = counterpart(model, robot) if model.mujoco is None else None
    masses = masses_of(model, robot, base)
    imported = None if base is None else base.declared.model
    losses, elsewhere = losses_of(model, robot, imported, masses.taken)
    if not losses and base is None:
        names = ", ".join(coordinate.name for coordinate in model.coordinates)
        said = f"no coordinate of the model ({names}) is a joint of this robot"
        raise InputError(Problem(said, file=file))
    changes, notes = _of_joints(text, root, robot, losses, form)
    changes += _elsewhere(text, root, elsewhere)
    notes += elsewhere
    links = _links(root, form)
    stated = {name: new for name, new in masses.inertials.items() if name in links}
    more, told = _of_links(text, root, links, robot, masses)
    if stated and not _reads_back(changed(text, more), robot, stated):
        told = (
            "masses are not written: as the file would be read they are others (a setting of its "
            "compiler such as inertiafromgeom or settotalmass overrules them)",
        )
        more = _elsewhere(text, root, told)
    kept = () if imported is None else unwritten(model)
    return Rewritten(changed(text, [*changes, *more]), (*notes, *told, *kept))


def _of_joints(
    text: str, root: Span, robot: Robot, losses: Sequence[Losses], form: str
) -> tuple[list[Change], list[str]]:
    """What changes at joints, and what is said of it."""
    joints = {
        span.attributes.get("name", ""): span
        for span in root.every("joint")
        if "type" in span.attributes or form == "mjcf"
    }
    known = {joint.name: joint for joint in robot.joints}
    changes: list[Change] = []
    notes: list[str] = []
    for one in losses:
        span = joints.get(one.joint)
        if span is None:
            notes.append(f"{one.joint}: stands in another file or under a default; not written")
            continue
        was = known[one.joint]
        old = (was.damping, was.friction, was.armature)
        new = (one.damping, one.friction, one.armature)
        moved = [not _same(a, b) for a, b in zip(old, new, strict=True)]
        own = replace(  # what actuators have stands at them
            one, damping=one.damping - was.motors[0], armature=one.armature - was.motors[1]
        )
        change = _of_urdf if form == "urdf" else _of_mjcf
        made, lines = change(text, span, own, moved)
        changes += made
        notes += [f"{one.joint}: {line}" for line in lines]
    return changes, notes


def _of_links(
    text: str, root: Span, links: Mapping[str, Span], robot: Robot, masses: Masses
) -> tuple[list[Change], tuple[str, ...]]:
    """What changes at links, by their elements, and what is said of it."""
    urdf = root.tag == FORMATS["urdf"]
    changes: list[Change] = []
    notes = list(masses.notes)
    write = inertials.of_urdf if urdf else inertials.of_mjcf
    for name, new in masses.inertials.items():
        if name in links:
            changes += write(text, links[name], robot.links[name], new)
            notes.append(f"{name}: {inertials.said(robot.links[name], new)}")
        else:
            notes.append(f"{name}: its mass is not written, no element of the file has its name")
    if changes and not urdf:
        made = inertials.stated_count(text, root)
        changes += made
        notes += ['compiler: inertiafromgeom "auto", so that what is stated counts'] * bool(made)
    for name, reason in masses.refused.items():
        line = comment(f"symhyb found, and a link cannot have: {reason}")
        changes += first_inside(text, links[name], [line]) if name in links else []
        notes.append(f"{name}: not written, {reason}")
    return changes, tuple(notes)


def _links(root: Span, form: str) -> dict[str, Span]:
    """The elements of links by the names that these have when they are read."""
    if form == "urdf":
        spans = [span for span in root.children if span.tag == "link"]
    else:
        worlds = [span for span in root.children if span.tag == "worldbody"]
        spans = [span for world in worlds for span in world.every("body")]
    named = {}
    for k, span in enumerate(spans, start=1):
        name = " ".join(span.attributes.get("name", "").split())
        named[name or f"body_{k}"] = span
    return named


def _reads_back(text: str, robot: Robot, stated: Mapping[str, Inertial]) -> bool:
    """Whether a text is read as the same robot, with the masses that were to be written."""
    try:
        links = parse_robot(text.encode(), robot.file).links
    except InputError:
        return False
    return all(
        same(
            of_inertial(links[name].inertial),
            of_inertial(stated.get(name, link.inertial)),
        )
        for name, link in robot.links.items()
    )


def _text_of(source: Path) -> str:
    data = content_of(source, ROBOT_BYTES)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(Problem("is not UTF-8; save it as UTF-8", file=str(source))) from None


def _same(a: float, b: float) -> bool:
    return abs(a - b) <= NEAR * max(abs(a), abs(b))


def _number(value: float) -> str:
    return f"{value:.10g}"


def _of_urdf(
    text: str, span: Span, losses: Losses, moved: list[bool]
) -> tuple[list[Change], list[str]]:
    """Damping and friction under <dynamics>; a rotor has no place."""
    values = {"damping": losses.damping, "friction": losses.friction}
    wanted = {
        name: _number(value)
        for (name, value), new in zip(values.items(), moved, strict=False)
        if new
    }
    said = [f"{name} {value}" for name, value in wanted.items()]
    left = list(losses.more)
    if moved[2]:
        left.append(f"inertia of the rotor {_number(losses.armature)} (kg*m^2, on a slide kg)")
    changes: list[Change] = []
    lines = [comment(f"symhyb found, and a URDF has no place for: {one}") for one in left]
    inner = span.first("dynamics")
    if wanted and inner is not None:
        changes.append(with_attributes(text, inner, wanted))
    elif wanted:
        attributes = " ".join(f'{name}="{value}"' for name, value in wanted.items())
        lines.insert(0, f"<dynamics {attributes}/>")
    return [*changes, *last_inside(text, span, lines)], [
        *said,
        *(f"no place for {one}" for one in left),
    ]


def _of_mjcf(
    text: str, span: Span, losses: Losses, moved: list[bool]
) -> tuple[list[Change], list[str]]:
    """Attributes of the joint; those of its default class stay for all others."""
    values = {
        "damping": losses.damping,
        "frictionloss": losses.friction,
        "armature": losses.armature,
    }
    wanted = {
        name: _number(value)
        for (name, value), new in zip(values.items(), moved, strict=True)
        if new
    }
    changes = [with_attributes(text, span, wanted)] if wanted else []
    lines = [comment(f"symhyb found, and an MJCF has no place for: {x}") for x in losses.more]
    said = [f"{name} {value}" for name, value in wanted.items()]
    said += [f"no place for {one}" for one in losses.more]
    return [*changes, *before(text, span, lines)], said


def _elsewhere(text: str, root: Span, said: Sequence[str]) -> list[Change]:
    """What acts at no single joint, as comments at the top."""
    return first_inside(text, root, [comment(f"symhyb found: {one}") for one in said])
