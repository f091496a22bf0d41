"""A robot as files of other programs declare it: links that joints tie to a tree.

Lengths in m, angles in rad, masses in kg, all vectors in the axes that are named. Everything here
is as the file says it; what a model makes of it is in :mod:`symhyb.imports.reduction`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STRAIGHT = frozenset({"revolute", "continuous", "prismatic"})  # joints with one coordinate
MOVING = STRAIGHT | {"floating", "ball", "planar"}
TURNED = frozenset({"floating", "ball"})  # joints that turn by a quaternion


@dataclass(frozen=True, slots=True, eq=False)
class Inertial:
    """``mass`` (kg) at ``centre`` (3,) in m, and its ``tensor`` (3, 3) about that, kg·m², both in
    the axes of the link."""

    mass: float
    centre: Array
    tensor: Array


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body by its ``name``; ``line`` is where the file declares it, ``origin`` (m, in the
    axes of the link) where the file counts its places from."""

    name: str
    inertial: Inertial | None = None
    line: int = 0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Mimic:
    """A joint that moves with another: ``ratio``·(position of ``joint``) + ``offset``."""

    joint: str
    ratio: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class Range:
    """How far, how fast and how strongly a joint may be driven; None where nothing is stated."""

    travel: tuple[float, float] | None = None
    speed: float | None = None
    effort: float | None = None


@dataclass(frozen=True, slots=True)
class Joint:
    """The joint by which ``child`` hangs on ``parent``.

    Its frame lies at ``xyz`` in the axes of the parent, turned by ``rpy`` (roll, pitch, yaw about
    the fixed axes x, y, z in this order). In that frame the child turns about the unit vector
    ``axis``, or travels along it. ``armature`` is the inertia of the rotor as the joint feels it,
    ``spring`` a stiffness and where it rests. Of damping and armature ``motors`` is what actuators
    have. ``home`` is where the file draws the robot, ``held`` where the joint is locked.
    """

    name: str
    kind: str
    parent: str
    child: str
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    damping: float = 0.0
    friction: float = 0.0
    range: Range = Range()
    mimic: Mimic | None = None
    line: int = 0
    armature: float = 0.0
    spring: tuple[float, float] | None = None
    motors: tuple[float, float] = (0.0, 0.0)
    home: float = 0.0
    held: float | None = None


@dataclass(frozen=True, slots=True)
class Site:
    """A marked place of a ``link``, ``at`` (m) in the axes of that."""

    name: str
    link: str
    at: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Pin:
    """Two places, of two links, that are one: what closes a loop."""

    name: str
    first: Site
    second: Site

    @property
    def ends(self) -> tuple[Site, Site]:
        """Both places."""
        return self.first, self.second


@dataclass(frozen=True, slots=True)
class Relation:
    """A ``joint`` whose position is a polynomial of that of another, ``of`` (a constant, without
    one): its ``coefficients`` from the constant one on, SI, and the ``units`` of both positions."""

    name: str
    joint: str
    of: str
    coefficients: tuple[float, ...]
    units: tuple[str, str]


@dataclass(frozen=True, slots=True)
class Robot:
    """A tree of links. ``joints`` come in the order of the tree, a parent before its children;
    ``gears`` are the ratios that the file states for the transmission of a joint; ``notes`` say
    what was read otherwise than it stands, each with the link or joint that it is about. Of a
    ``source`` that knows motors ``driven`` are the joints that have one, of one that marks places
    ``sites`` are these. ``pins`` close loops, ``relations`` hold joints to others."""

    name: str
    root: str
    links: Mapping[str, Link]
    joints: tuple[Joint, ...]
    file: str = ""
    gears: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[tuple[str, str], ...] = ()
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)
    driven: frozenset[str] | None = None
    source: str = "URDF"
    sites: tuple[Site, ...] = ()
    pins: tuple[Pin, ...] = ()
    relations: tuple[Relation, ...] = ()
