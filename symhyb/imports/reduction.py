r"""From a tree of links to bodies that move: what is welded is one rigid body.

Joints that are fixed, locked or move nothing that has mass are welds. Every link lies at a constant
pose in the body that carries it, the ground or the child of the last joint that moves:

    ground ──(moves)── body ──[weld]── link ──[weld]── link ──(moves)── body
                        └──────── one rigid body ────────┘

so a machine has as many bodies as joints that move.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.imports.loops import in_loops, pinned
from symhyb.imports.rigid import (
    Pose,
    about_point,
    about_vector,
    ball,
    from_rpy,
    here,
    joined,
    moved,
)
from symhyb.imports.robot import MOVING, STRAIGHT, Inertial, Joint, Pin, Relation, Robot
from symhyb.imports.tips import Tip, tips_of
from symhyb.imports.tree import nearest

NOTHING = (
    1e-10  # of the sum of moments: what a joint turns about its axis, if that is only rounding
)


@dataclass(frozen=True, slots=True)
class Wish:
    """What a person asked for: the ``joints`` that move (None: all), ``positions`` of joints (rad,
    m), where they are locked or start, and whether the root is ``free`` to move in space."""

    joints: tuple[str, ...] | None = None
    positions: Mapping[str, float] | None = None
    free: bool = False


@dataclass(frozen=True, slots=True)
class Drive:
    """How far a joint is: ``ratio``·(position of ``joint``) + ``offset``."""

    joint: str
    ratio: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Moved:
    """A body that moves: the ``joint`` by which it hangs on ``carrier`` (the ground, if empty), the
    constant ``pose`` of the joint's frame in that, what ``drives`` it (of a joint with one
    coordinate), its ``inertial`` in the axes of the child link, the other ``links`` in it, the
    ``poses`` of all its links in these axes, and its ``tips``, where it may carry something."""

    joint: Joint
    carrier: str
    pose: Pose
    drive: Drive | None
    inertial: Inertial | None
    links: tuple[str, ...]
    tips: tuple[Tip, ...] = ()
    poses: Mapping[str, Pose] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """That of the link that the joint moves."""
        return self.joint.child

    @property
    def own(self) -> bool:
        """Whether the joint has a position of its own."""
        return self.drive is None or self.drive.joint == self.joint.name


@dataclass(frozen=True, slots=True)
class Reduced:
    """The bodies of a robot in the order of the tree, the ``grounded`` links, the ``locked`` joints
    with their positions, where the joints ``start``, and ``notes`` on what was done otherwise.
    ``pins`` hold bodies (the ground, if empty) and ``relations`` joints; those of them that are
    ``open`` may start elsewhere."""

    bodies: tuple[Moved, ...]
    grounded: tuple[str, ...]
    locked: Mapping[str, float]
    start: Mapping[str, float]
    notes: tuple[str, ...]
    pins: tuple[Pin, ...] = ()
    relations: tuple[Relation, ...] = ()
    open: frozenset[str] = frozenset()


def reduced(robot: Robot, wish: Wish | None = None) -> Reduced:
    """The moving bodies of a robot.

    Raises:
        InputError: a wish names a joint that is not there, or nothing moves.
    """
    wish = wish or Wish()
    joints = freed(robot) if wish.free else robot.joints
    by_name = {joint.name: joint for joint in joints}
    drives = {joint.name: _drive(joint, by_name) for joint in joints if joint.kind in STRAIGHT}
    _refuse(robot, by_name, drives, wish)
    given, held = wish.positions or {}, in_loops(robot)
    start = _starts(joints, drives, given, held)
    moving = _moving(joints, drives, wish)
    notes: list[str] = []
    while True:
        bodies, places, said = _bodies(robot, joints, drives, moving, start)
        idle = _idle(bodies, drives, start)
        if not idle:
            break
        for name in idle:
            notes.append(f"the joint '{name}' moves nothing that has inertia: it is locked")
        followers = {n for n, drive in drives.items() if drive is not None and drive.joint in idle}
        moving = moving - set(idle) - followers
    if not bodies:
        text = "has no joint that moves anything with mass"
        cure = (
            ""
            if wish.free or robot.source != "URDF"
            else "; --floating-base lets the root move in space"
        )
        raise InputError(Problem(text + cure, file=robot.file))
    locked = {
        joint.name: _position(joint, drives, start)
        for joint in joints
        if joint.kind in STRAIGHT and joint.name not in moving
    }
    grounded = tuple(link for link, (carrier, _) in places.items() if link and not carrier)
    pins, rigid = pinned(robot, places)
    relations = tuple(item for item in robot.relations if {item.joint, item.of} & moving)
    return Reduced(
        bodies,
        grounded,
        locked,
        start,
        (*notes, *said, *rigid),
        pins,
        relations,
        held - set(given) - (robot.driven or frozenset()),
    )


def freed(robot: Robot) -> tuple[Joint, ...]:
    """The joints behind one by which the root is free to move in space."""
    names = {joint.name for joint in robot.joints}
    name = robot.root
    while name in names:
        name += "_free"
    return (Joint(name, "floating", "", robot.root), *robot.joints)


def _drive(joint: Joint, by_name: Mapping[str, Joint]) -> Drive | None:
    """What drives a joint in the end, None if that stands still."""
    ratio, offset = 1.0, 0.0
    while joint.mimic is not None:
        offset += ratio * joint.mimic.offset
        ratio *= joint.mimic.ratio
        joint = by_name[joint.mimic.joint]
    if joint.held is not None:
        return Drive(joint.name, 0.0, offset + ratio * joint.held)
    if joint.kind not in STRAIGHT:
        ratio = 0.0
    return Drive(joint.name, ratio, offset)


def _refuse(
    robot: Robot, by_name: Mapping[str, Joint], drives: Mapping[str, Drive | None], wish: Wish
) -> None:
    """Wishes that the robot does not know."""
    problems = []
    able = [joint.name for joint in by_name.values() if joint.kind in MOVING]
    for option, names in (("--joints", wish.joints or ()), ("--at", wish.positions or {})):
        for name in names:
            drive = drives.get(name)
            if name not in able:
                text = f"'{name}' is not a joint that can move{nearest(name, able)}"
                problems.append(Problem(text, option, robot.file))
            elif by_name[name].held is not None:
                text = f"'{name}' is held at {by_name[name].held:g} by the {robot.source}"
                problems.append(Problem(text, option, robot.file))
            elif drive is not None and drive.joint != name:
                text = f"'{name}' follows the joint '{drive.joint}'; name that one"
                problems.append(Problem(text, option, robot.file))
            elif option == "--at" and drive is None:
                text = f"'{name}' is {by_name[name].kind}; a position is that of one coordinate"
                problems.append(Problem(text, option, robot.file))
    if problems:
        raise InputError(problems)


def _starts(
    joints: Sequence[Joint],
    drives: Mapping[str, Drive | None],
    given: Mapping[str, float],
    held: frozenset[str],
) -> dict[str, float]:
    """Where joints with a position of their own start, or are locked: as given, else 0, or the
    middle of a travel that 0 does not belong to; those that loops hold as the file draws them."""
    start = {}
    for joint in joints:
        drive = drives.get(joint.name)
        if drive is None or drive.joint != joint.name:
            continue
        low, high = joint.range.travel or (0.0, 0.0)
        usual = 0.0 if low <= 0 <= high else (low + high) / 2
        usual = joint.home if joint.name in held else usual
        start[joint.name] = given.get(joint.name, usual)
    return start


def _moving(
    joints: Sequence[Joint], drives: Mapping[str, Drive | None], wish: Wish
) -> frozenset[str]:
    """The joints that move, by name."""
    found = set()
    for joint in joints:
        drive = drives.get(joint.name)
        leader = joint.name if drive is None else drive.joint
        still = drive is not None and drive.ratio == 0
        chosen = wish.joints is None or leader in wish.joints or (wish.free and not joint.parent)
        if joint.kind in MOVING and chosen and not still:
            found.add(joint.name)
    return frozenset(found)


def _position(
    joint: Joint, drives: Mapping[str, Drive | None], start: Mapping[str, float]
) -> float:
    drive = drives.get(joint.name)
    return 0.0 if drive is None else drive.ratio * start.get(drive.joint, 0.0) + drive.offset


def displaced(joint: Joint, position: float) -> Pose:
    """The child of a joint with one coordinate in the joint's frame; that frame of any other."""
    if joint.kind == "prismatic":
        return Pose(np.eye(3), position * np.array(joint.axis))
    if joint.kind in STRAIGHT and position:
        return Pose(about_vector(joint.axis, position), np.zeros(3))
    return here()


def _bodies(
    robot: Robot,
    joints: Sequence[Joint],
    drives: Mapping[str, Drive | None],
    moving: frozenset[str],
    start: Mapping[str, float],
) -> tuple[tuple[Moved, ...], dict[str, tuple[str, Pose]], tuple[str, ...]]:
    """The bodies, in which of them (the ground, if empty) every link lies, and notes."""
    places: dict[str, tuple[str, Pose]] = {"": ("", here()), robot.root: ("", here())}
    found: dict[str, Moved] = {}
    for joint in joints:
        carrier, pose = places[joint.parent]
        pose = pose.then(Pose(from_rpy(joint.rpy), np.array(joint.xyz)))
        if joint.name in moving:
            found[joint.child] = Moved(joint, carrier, pose, drives.get(joint.name), None, ())
            places[joint.child] = joint.child, here()
        else:
            weld = displaced(joint, _position(joint, drives, start))
            places[joint.child] = carrier, pose.then(weld)
    held: dict[str, list[str]] = {name: [] for name in ("", *found)}
    for link, (carrier, _) in places.items():
        if link and link != carrier:
            held[carrier].append(link)
    bodies, notes = [], []
    for name, body in found.items():
        parts = [
            moved(inertial, places[link][1])
            for link in (name, *held[name])
            if (inertial := robot.links[link].inertial) is not None
        ]
        inertial, note = _filled(name, [part for part in parts if part.mass or part.tensor.any()])
        welded = held[name]
        poses = {link: places[link][1] for link in (name, *welded)}
        tips, left_out = tips_of(robot, name, welded, poses)
        notes += [*note, *left_out]
        links = tuple(welded)
        bodies.append(replace(body, inertial=inertial, links=links, tips=tips, poses=poses))
    return tuple(bodies), places, tuple(notes)


def _filled(name: str, parts: Sequence[Inertial]) -> tuple[Inertial | None, list[str]]:
    """The sum of what is welded; a mass without any inertia gets that of a ball."""
    if not parts:
        return None, []
    whole = joined(parts)
    if whole.tensor.any() or not whole.mass:
        return whole, []
    moment = float(f"{ball(whole.mass):.3g}")
    note = (
        f"the link '{name}' has a mass of {whole.mass:g} kg and no inertia: it gets {moment:g} "
        "kg·m² about every axis, that of a solid ball of aluminium of this mass; put in what it has"
    )
    return replace(whole, tensor=moment * np.eye(3)), [note]


def _idle(
    bodies: Sequence[Moved], drives: Mapping[str, Drive | None], start: Mapping[str, float]
) -> list[str]:
    """Joints with a position of their own that, with all that follow them, move no inertia: the
    equation of motion along them would be 0 = force."""
    below: dict[str, list[Inertial]] = {body.name: [] for body in bodies}
    useful: dict[str, bool] = {}
    for body in reversed(bodies):
        parts = below[body.name] + ([body.inertial] if body.inertial is not None else [])
        whole = joined(parts) if parts else None
        leader = body.joint.name if body.drive is None else body.drive.joint
        useful[leader] = useful.get(leader, False) or _acts(body.joint, whole)
        if whole is not None and body.carrier:
            at = 0.0 if body.drive is None else _position(body.joint, drives, start)
            pose = body.pose.then(displaced(body.joint, at))
            below[body.carrier].append(moved(whole, pose))
    return [name for name, acts in useful.items() if not acts]


def _acts(joint: Joint, whole: Inertial | None) -> bool:
    """Whether a joint moves inertia."""
    if whole is None:
        return False
    if joint.kind not in ("revolute", "continuous"):
        return whole.mass > 0
    tensor, axis = about_point(whole, np.zeros(3)), np.array(joint.axis)
    return bool(axis @ tensor @ axis > NOTHING * np.trace(tensor))
