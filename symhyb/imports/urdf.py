"""Read a URDF, the robot description of ROS: links, joints, and what their dynamics states.

Shapes, materials and meshes are not read, and no file that a URDF names is opened. All problems of
a file are reported at once, each with its line. The format: wiki.ros.org/urdf/XML.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isfinite, nan
from pathlib import Path
from typing import TypeVar

import numpy as np

from symhyb.data.files.xml_file import Node, parse_xml
from symhyb.errors import InputError, Problem, visible
from symhyb.imports.rigid import Pose, from_rpy, is_of_a_body, moved, nearest_of_a_body
from symhyb.imports.robot import MOVING, STRAIGHT, Inertial, Joint, Link, Mimic, Range, Robot
from symhyb.imports.tree import nearest, tree_problems, walk
from symhyb.limits import DECLARED, ROBOT_NUMBER
from symhyb.model.tables import shorten

IGNORED = frozenset(
    {"visual", "collision", "material", "gazebo", "sensor", "ros2_control", "mujoco"}
)
KINDS = (MOVING - {"ball"}) | {"fixed"}
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_NO_LIMIT = 1e9  # what is larger is written for "none"
Value = TypeVar("Value")
_TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def parse_urdf(data: bytes, file: str = "") -> Robot:
    """Read a URDF from its bytes.

    Raises:
        InputError: every problem at once.
    """
    root = parse_xml(data, file, IGNORED)
    if root.tag != "robot":
        raise InputError(Problem(_other(root.tag), file=file, line=root.line))
    if any(node.tag.startswith("xacro:") for node in root.children):
        cure = "expand it first: xacro robot.urdf.xacro > robot.urdf"
        raise InputError(Problem(f"is a xacro file, not a URDF; {cure}", file=file, line=root.line))
    link_nodes, joint_nodes = root.all("link"), root.all("joint")
    for what, count in (("links", len(link_nodes)), ("joints", len(joint_nodes))):
        if count > DECLARED:
            text = f"has {count} {what}; at most {DECLARED} are read"
            raise InputError(Problem(text, file=file))
    reading = _Reading(file)
    links = reading.named(link_nodes, "link", _link)
    joints = reading.named(joint_nodes, "joint", _joint)
    whole = len(links) == len(link_nodes) and len(joints) == len(joint_nodes)
    if whole or not reading.problems:
        reading.problems.extend(tree_problems(links, list(joints.values()), file))
    reading.problems.extend(_mimic_problems(joints, file))
    if reading.problems:
        raise InputError(reading.problems)
    name = _name(root) or Path(file).stem
    first, order = walk(links, list(joints.values()))
    return Robot(name, first, links, order, file, _gears(root), tuple(reading.notes))


def _name(node: Node, key: str = "name") -> str:
    """A name in one line, of letters that are shown."""
    return visible(" ".join(node.attributes.get(key, "").split()))


def _other(tag: str) -> str:
    found = "is SDF, the format of Gazebo" if tag == "sdf" else f"begins with <{shorten(tag)}>"
    return f"{found}; a URDF begins with <robot>, an MJCF with <mujoco>"


@dataclass(frozen=True, slots=True)
class _Reading:
    """One reading of a file: its problems and notes so far."""

    file: str
    problems: list[Problem] = field(default_factory=list)
    notes: list[tuple[str, str]] = field(default_factory=list)

    def named(
        self, nodes: Sequence[Node], what: str, read: "Callable[[_Part], Value | None]"
    ) -> dict[str, Value]:
        """Read all elements of a kind by their names, which are there and not twice."""
        found: dict[str, Value] = {}
        for node in nodes:
            name = _name(node)
            part = _Part(self, node, f"{what}.{shorten(name)}" if name else what)
            if not name:
                part.problem("has no name")
            elif name in found:
                part.problem(f"there is already a {what} of this name; rename one of them")
            else:
                value = read(replace(part, name=name))
                if value is not None:
                    found[name] = value
        return found


@dataclass(frozen=True, slots=True)
class _Part:
    """One element that is read: where it stands, and what is wrong with it."""

    reading: _Reading
    node: Node
    place: str
    name: str = ""

    def problem(self, text: str, *keys: str) -> None:
        place = ".".join((self.place, *keys))
        self.reading.problems.append(Problem(text, place, self.reading.file, self.node.line))

    def note(self, text: str) -> None:
        self.reading.notes.append((self.name, text))

    def inner(self, tag: str) -> "_Part | None":
        node = self.node.first(tag)
        return None if node is None else replace(self, node=node, place=f"{self.place}.{tag}")

    def number(self, key: str, default: float | None = None, unbounded: bool = False) -> float:
        """A finite number; ``default`` where it is not stated. NaN with a problem."""
        text = self.node.attributes.get(key)
        if text is None:
            if default is None:
                self.problem(f"'{key}' is missing", key)
            return nan if default is None else default
        return self._number(text, key, unbounded)

    def numbers(self, key: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """Three finite numbers."""
        text = self.node.attributes.get(key)
        if text is None:
            return default
        parts = text.split()
        if len(parts) != 3:
            self.problem(f"must be three numbers, not '{shorten(text)}'", key)
            return default
        x, y, z = (self._number(part, key) for part in parts)
        return x, y, z

    def _number(self, text: str, key: str, unbounded: bool = False) -> float:
        word = text.strip()
        if unbounded and word.lstrip("+-").lower() in ("inf", "infinity"):
            return -inf if word.startswith("-") else inf
        if not _NUMBER.fullmatch(word):
            cure = "; expand the xacro file first" if "${" in word else ""
            self.problem(f"must be a finite number, not '{shorten(text)}'{cure}", key)
            return nan
        value = float(word)
        if not unbounded and not abs(value) <= ROBOT_NUMBER:
            self.problem(f"is '{shorten(text)}'; no robot has more than {ROBOT_NUMBER:g}", key)
            return nan
        return value

    def origin(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """xyz and rpy of the origin."""
        zero, origin = (0.0, 0.0, 0.0), self.inner("origin")
        if origin is None:
            return zero, zero
        return origin.numbers("xyz", zero), origin.numbers("rpy", zero)


def _link(part: _Part) -> Link:
    inertial = part.inner("inertial")
    return Link(part.name, None if inertial is None else _inertial(inertial), part.node.line)


def _inertial(part: _Part) -> Inertial | None:
    """Mass, centre and tensor in the axes of the link; what no body has is repaired with a note."""
    xyz, rpy = part.origin()
    mass, inertia = part.inner("mass"), part.inner("inertia")
    if mass is None:
        part.problem("<mass> is missing; a link without mass has no <inertial>")
    kilograms = 0.0 if mass is None else mass.number("value")
    if kilograms < 0:
        part.problem(f"is {kilograms:g} kg; a mass is not negative", "mass", "value")
    if inertia is None:
        part.note(f"the link '{part.name}' states no <inertia>; it is taken as 0")
        xx = xy = xz = yy = yz = zz = 0.0
    else:
        xx, xy, xz, yy, yz, zz = (inertia.number(key) for key in _TENSOR)
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not np.isfinite([*xyz, *rpy, kilograms, *own.flat]).all():
        return None  # which is a problem that was noted
    if not is_of_a_body(own):
        low, middle, high = np.linalg.eigvalsh(own)
        own = nearest_of_a_body(own)
        now = ", ".join(f"{value:.4g}" for value in np.linalg.eigvalsh(own))
        part.note(
            f"the inertia of the link '{part.name}' is that of no body: its principal moments are "
            f"{low:.4g}, {middle:.4g} and {high:.4g} kg·m², where none may be negative and the "
            f"largest at most the sum of the others; the nearest of a body are taken: {now}"
        )
    return moved(Inertial(kilograms, np.zeros(3), own), Pose(from_rpy(rpy), np.array(xyz)))


def _joint(part: _Part) -> Joint | None:
    kind = part.node.attributes.get("type", "").strip()
    if kind not in KINDS:
        said = f"'{shorten(kind)}' is not a kind of joint" if kind else "is missing"
        part.problem(f"{said}{nearest(kind, sorted(KINDS))}", "type")
    ends = []
    for end in ("parent", "child"):
        inner = part.inner(end)
        link = "" if inner is None else _name(inner.node, "link")
        if not link:
            part.problem(f'is missing; write <{end} link="…"/>', end)
        ends.append(link)
    xyz, rpy = part.origin()
    axis = _axis(part) if kind in MOVING else (1.0, 0.0, 0.0)
    damping, friction = _losses(part, kind)
    range_ = _range(part, kind)
    mimic = _mimic(part, kind)
    if kind not in KINDS or not all(ends):
        return None
    return Joint(
        part.name,
        kind,
        ends[0],
        ends[1],
        xyz,
        rpy,
        axis,
        damping,
        friction,
        range_,
        mimic,
        part.node.line,
    )


def _axis(part: _Part) -> tuple[float, float, float]:
    """The axis as a unit vector, x unless stated."""
    inner = part.inner("axis")
    axis = (1.0, 0.0, 0.0) if inner is None else inner.numbers("xyz", (1.0, 0.0, 0.0))
    length = float(np.linalg.norm(axis))
    if inner is not None and length == 0:
        inner.problem("has the length 0; an axis has a direction", "xyz")
        return 1.0, 0.0, 0.0
    x, y, z = (float(value) / length for value in axis)
    return x, y, z


def _losses(part: _Part, kind: str) -> tuple[float, float]:
    """Damping and dry friction of a joint."""
    inner = part.inner("dynamics")
    if inner is None:
        return 0.0, 0.0
    damping, friction = (inner.number(key, 0.0) for key in ("damping", "friction"))
    for key, value in (("damping", damping), ("friction", friction)):
        if value < 0:
            inner.problem(f"is {value:g}; it would drive the joint", key)
    if (damping or friction) and kind not in STRAIGHT:
        text = f"damping and friction of the joint '{part.name}' are left out: it is {kind}"
        part.note(text)
        return 0.0, 0.0
    return damping, friction


def _range(part: _Part, kind: str) -> Range:
    inner = part.inner("limit")
    if inner is None or kind not in STRAIGHT:
        return Range()
    lower, upper = (inner.number(key, 0.0, unbounded=True) for key in ("lower", "upper"))
    speed, effort = (inner.number(key, 0.0, unbounded=True) for key in ("velocity", "effort"))
    if lower > upper:
        inner.problem(f"lower is {lower:g} and upper {upper:g}; the lower must be the smaller")
    bounded = kind != "continuous" and lower < upper and max(-lower, upper) < _NO_LIMIT
    return Range((lower, upper) if bounded else None, _positive(speed), _positive(effort))


def _positive(value: float) -> float | None:
    """A limit that limits: 0 and what no machine reaches are written where none is known."""
    return value if isfinite(value) and 0 < value < _NO_LIMIT else None


def _mimic(part: _Part, kind: str) -> Mimic | None:
    inner = part.inner("mimic")
    if inner is None or kind not in STRAIGHT:
        return None
    joint = _name(inner.node, "joint")
    if not joint:
        inner.problem("is missing: the name of the joint that is followed", "joint")
        return None
    return Mimic(joint, inner.number("multiplier", 1.0), inner.number("offset", 0.0))


def _mimic_problems(joints: dict[str, Joint], file: str) -> Iterator[Problem]:
    """Joints that follow one that is not there, of more than one coordinate, or themselves."""
    for joint in joints.values():
        if joint.mimic is None:
            continue
        place, name = f"joint.{shorten(joint.name)}.mimic", joint.mimic.joint
        followed = joints.get(name)
        if followed is None:
            text = f"'{shorten(name)}' is not a joint{nearest(name, list(joints))}"
            yield Problem(text, place, file, joint.line)
        elif followed.kind not in STRAIGHT | {"fixed"}:
            text = (
                f"'{shorten(name)}' is {followed.kind}; a joint of one coordinate can be followed"
            )
            yield Problem(text, place, file, joint.line)
        elif _follows_itself(joint, joints):
            text = "follows itself, directly or through others"
            yield Problem(text, place, file, joint.line)


def _follows_itself(joint: Joint, joints: dict[str, Joint]) -> bool:
    at: Joint | None = joint
    seen: set[str] = set()
    while at is not None and at.mimic is not None:
        if at.name in seen:
            return True
        seen.add(at.name)
        at = joints.get(at.mimic.joint)
    return False


def _gears(root: Node) -> dict[str, float]:
    """The ratios that transmissions state, by joint; what is not readable is not used."""
    found: dict[str, float] = {}
    for transmission in root.all("transmission"):
        joints = transmission.all("joint")
        if len(joints) != 1:
            continue
        for node in (*transmission.all("actuator"), *joints):
            ratio = node.first("mechanicalReduction")
            if ratio is not None and _NUMBER.fullmatch(ratio.text):
                found[_name(joints[0])] = float(ratio.text)
    return found
