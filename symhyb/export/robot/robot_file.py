"""The owner's file of a robot with what a model says of its joints: a URDF or an MJCF.

What the format has a place for is written there: damping and friction under ``<dynamics>`` of a
URDF; damping, frictionloss and armature of an MJCF's joint. What it cannot say stands in a comment
at the joint. All else stays as it was, letter by letter.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.export.robot.losses import Losses, losses_of
from symhyb.export.robot.spans import (
    Change,
    Span,
    changed,
    comment,
    indent_of,
    spans_of,
    with_attributes,
)
from symhyb.imports.deliver import read_robot
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
    """The file of a robot (``form`` urdf or mjcf) with the losses of a model.

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
    losses, elsewhere = losses_of(model, robot)
    if not losses:
        names = ", ".join(coordinate.name for coordinate in model.coordinates)
        said = f"no coordinate of the model ({names}) is a joint of this robot"
        raise InputError(Problem(said, file=file))
    joints = {
        span.attributes.get("name", ""): span
        for span in root.every("joint")
        if "type" in span.attributes or form == "mjcf"
    }
    before = {joint.name: joint for joint in robot.joints}
    changes: list[Change] = []
    notes: list[str] = []
    for one in losses:
        span = joints.get(one.joint)
        if span is None:
            notes.append(f"{one.joint}: stands in another file or under a default; not written")
            continue
        was = before[one.joint]
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
    changes += _elsewhere(text, root, elsewhere)
    notes += elsewhere
    return Rewritten(changed(text, changes), tuple(notes))


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
    return [*changes, *_added(text, span, lines)], [*said, *(f"no place for {one}" for one in left)]


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
    return [*changes, *_before(text, span, lines)], said


def _added(text: str, span: Span, lines: list[str]) -> list[Change]:
    """Lines before the end tag of an element."""
    if not lines:
        return []
    pad = indent_of(text, span.begin)
    step = indent_of(text, span.children[0].begin) if span.children else pad + "  "
    newline = "\r\n" if "\r\n" in text else "\n"
    place = len(text[: span.end].rstrip())
    block = "".join(f"{newline}{step}{line}" for line in lines)
    return [(place, place, block)]


def _before(text: str, span: Span, lines: list[str]) -> list[Change]:
    """Lines before an element, indented as it is."""
    newline = "\r\n" if "\r\n" in text else "\n"
    pad = indent_of(text, span.begin)
    block = "".join(f"{line}{newline}{pad}" for line in lines)
    return [(span.begin, span.begin, block)] if lines else []


def _elsewhere(text: str, root: Span, said: tuple[str, ...]) -> list[Change]:
    """What acts at no single joint, as comments at the top."""
    newline = "\r\n" if "\r\n" in text else "\n"
    step = indent_of(text, root.children[0].begin) if root.children else "  "
    block = "".join(f"{newline}{step}{comment(f'symhyb found: {one}')}" for one in said)
    return [(root.inside, root.inside, block)] if said else []
