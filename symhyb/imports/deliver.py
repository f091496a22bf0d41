"""Carry out an order: read a robot, make a model of it, check that, and write the file."""

from dataclasses import dataclass
from pathlib import Path

from symhyb.data.files.xml_file import parse_xml
from symhyb.errors import InputError, Problem
from symhyb.imports.declare import declare
from symhyb.imports.holding import closed
from symhyb.imports.mjcf import parse_mjcf
from symhyb.imports.narrate import comments, notes
from symhyb.imports.reduction import Reduced, Wish, reduced
from symhyb.imports.robot import Robot
from symhyb.imports.tree import nearest
from symhyb.imports.urdf import parse_urdf
from symhyb.limits import COORDINATES, DECLARED, ROBOT_BYTES, content_of
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import Model
from symhyb.writing import write_file


@dataclass(frozen=True, slots=True)
class Order:
    """What is wanted: the ``joints`` that move (None: all), positions as ``at`` ("joint=value"),
    joints that are ``passive``, sensors of ``rates``, a root that is ``floating``, and whether a
    file that is there is replaced."""

    joints: tuple[str, ...] | None = None
    at: tuple[str, ...] = ()
    passive: tuple[str, ...] = ()
    rates: bool = False
    floating: bool = False
    force: bool = False


@dataclass(frozen=True, slots=True)
class Done:
    """A ``model`` that was written, a ``sentence`` on it, and ``notes`` on what is otherwise."""

    model: Model
    sentence: str
    notes: tuple[str, ...]


def deliver(source: Path, order: Order, target: Path) -> Done:
    """Write the model file of a robot, whole or not at all.

    Raises:
        InputError: every problem of the robot or of the order at once; or the target is there.
    """
    if target.exists():
        reason = "" if order.force else "is there already; --force replaces it"
        if source.exists() and target.samefile(source):
            reason = "is the robot that is read; name another file"
        if reason:
            raise InputError(Problem(reason, file=str(target)))
    robot = read_robot(source)
    model, said = model_of(robot, order, str(target))
    write_file(target, model.text)
    count = len(model.coordinates)
    sentence = (
        f"{target}: {count} coordinates, {len(model.bodies)} bodies; next: symhyb check {target}"
    )
    return Done(model, sentence, said)


def read_robot(path: Path) -> Robot:
    """A robot from a URDF or an MJCF, as its outermost element says.

    Raises:
        InputError: every problem of the file.
    """
    return parse_robot(content_of(path, ROBOT_BYTES), str(path))


def parse_robot(data: bytes, file: str = "") -> Robot:
    """A robot from the bytes of a URDF or an MJCF.

    Raises:
        InputError: every problem of the file.
    """
    read = parse_mjcf if parse_xml(data, file).tag == "mujoco" else parse_urdf
    return read(data, file)


def model_of(robot: Robot, order: Order, file: str = "") -> tuple[Model, tuple[str, ...]]:
    """The checked model of a robot with its text, and notes on what is otherwise.

    Raises:
        InputError: an order that the robot does not know, or a model beyond the limits.
    """
    wish = Wish(order.joints, _positions(order.at, robot.file), order.floating)
    found = reduced(robot, wish)
    _require_passive(order, found, robot)
    declared = declare(robot, found, order.rates, order.passive)
    _require_limits(declared.model, robot)
    model, moves = closed(declared.model, found, declared.names, robot.file)
    text = render(model, comments(robot, found, declared))
    return parse_model(text, file), (*notes(robot, found, declared), *moves)


def _require_limits(model: Model, robot: Robot) -> None:
    """A model within the limits; what lies far beyond takes long to check."""
    sizes = (
        ("coordinates", len(model.coordinates), COORDINATES),
        ("parameters", len(model.parameters), DECLARED),
    )
    cure = "name those joints that should move by --joints"
    problems = [
        Problem(f"needs {count} {what}; a machine has at most {most}; {cure}", file=robot.file)
        for what, count, most in sizes
        if count > most
    ]
    if problems:
        raise InputError(problems)


def _require_passive(order: Order, found: Reduced, robot: Robot) -> None:
    known = [body.joint.name for body in found.bodies if body.drive is not None and body.own]
    problems = [
        Problem(
            f"'{name}' is not a joint that moves{nearest(name, known)}", "--passive", robot.file
        )
        for name in order.passive
        if name not in known
    ]
    if problems:
        raise InputError(problems)


def _positions(options: tuple[str, ...], file: str) -> dict[str, float]:
    """Positions from ``joint=value``."""
    found: dict[str, float] = {}
    problems = []
    for text in options:
        name, equals, value = (part.strip() for part in text.rpartition("="))
        try:
            number = float(value)
        except ValueError:
            number = float("nan")
        if not (name and equals) or not abs(number) < 1e12:
            problems.append(Problem("write it as joint=number", f"--at {text}", file))
        elif name in found:
            problems.append(Problem(f"'{name}' stands twice", f"--at {text}", file))
        found[name] = number
    if problems:
        raise InputError(problems)
    return found
