"""What a drawing of a machine is made of, and a draft of one: where things are, how they move.

Sizes: n coordinates, K places of a line.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from symhyb.model.types import Between, Body, Model
from symhyb.report.placing import Placed
from symhyb.report.series import Array

STEP = 1e-6  # of a coordinate, SI: how places move with it
STILL = 1e-6  # of the size of a symbol, by 1 SI: no motion
SAME = 1e-9  # of a distance that stays
SIZES = (0.12, 0.085)  # of a symbol, as a part of a machine of one or two bodies, and of more
BOX = 0.5  # sizes, from the centre of a body to its side
LONE = 0.12  # m, where all is in one place
LETTER = 0.16  # sizes: the width of one of a name


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """One mark: ``shape`` is ``line``, ``arrow`` (its head at the last place), ``body``, ``pivot``
    or ``text``; ``at`` (K, 2) in m; ``role`` says what it stands for: ``body``, ``link``,
    ``element``, ``ground``, ``coordinate``, ``input`` or ``axis``, ``name`` for which of them.
    ``shown`` asks for emphasis; a text stands ``away`` (a direction, dimensionless) from there."""

    shape: str
    at: Array
    role: str
    name: str = ""
    text: str = ""
    shown: bool = False
    away: tuple[float, float] = (0.0, 0.0)


@dataclass(slots=True, eq=False)
class Draft:
    """What is drawn so far in the plane of the drawing, which a ``view`` (2, d), dimensionless,
    gives: parts where they are (``here``), ``moved`` by each coordinate in turn, and ``far`` from
    there. ``size`` is that of a symbol in m, ``shift`` (2,) in m by body how far it is drawn from
    its place; ``walls`` counts what lies side by side, and ``taken`` has how many sizes of either
    side that takes. ``held`` has the wall (2,) in m by the
    element that it holds, ``excursions`` (K, 2) in m by body how far that is seen to go from here.
    """

    model: Model
    view: Array
    here: Placed
    moved: list[Placed]
    far: Placed
    size: float
    shown: frozenset[str]
    shift: dict[str, Array] = field(default_factory=dict)
    marks: list[Mark] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    walls: dict[str, int] = field(default_factory=dict)
    taken: dict[tuple[str, float], float] = field(default_factory=dict)
    held: dict[str, Array] = field(default_factory=dict)
    excursions: dict[str, Array] = field(default_factory=dict)

    def flat(self, place: Array) -> Array:
        """A place (d,) in m in the plane of the drawing, (2,) in m."""
        return np.asarray(self.view @ place)

    def centre(self, body: str) -> Array:
        """Where the centre of a body is drawn, (2,) in m."""
        return self.flat(self.here.centres[body]) + self.shift.get(body, np.zeros(2))

    def rate(self, body: str, j: int) -> Array:
        """How the centre of a body moves with the j-th coordinate, (2,) in m per SI."""
        moved = self.moved[j].centres[body] - self.here.centres[body]
        return self.flat(moved) / STEP

    def turning(self, body: str, j: int) -> float:
        """By how much a body turns with the j-th coordinate, with the sign of the plane."""
        change = self.moved[j].frames[body].axes @ self.here.frames[body].axes.T
        if change.shape[0] == 2:
            return float(change[1, 0]) / STEP
        return float(np.linalg.norm(change - np.eye(3))) / STEP

    def turns(self, body: str, j: int) -> bool:
        """Whether a body turns with the j-th coordinate."""
        return abs(self.turning(body, j)) > STILL

    def room(self, body: str, along: Array) -> float:
        """How far a body is seen to go back against a direction (2,), dimensionless, in m."""
        return (
            float(np.max(-self.excursions[body] @ along, initial=0.0)) if self.excursions else 0.0
        )

    def row(self, key: str) -> int:
        """How many have asked for that place before."""
        self.walls[key] = self.walls.get(key, -1) + 1
        return self.walls[key]

    def lane(self, key: str, side: float, name: str, across: Array, least: float = 0.0) -> float:
        """How many sizes from the middle, at least the ``least``, the next element lies of those
        that share a place and a side (1 or -1): beyond the names of those before, whose letters
        take room where what lies ``across`` (2,), dimensionless, is horizontal."""
        before = self.taken.get((key, side), 0.0)
        offset = max(least, before + 0.5) if before else least
        wide = LETTER * len(name) * abs(float(across[0]))
        self.taken[key, side] = offset + 0.65 + wide
        return offset

    def add(
        self, shape: str, at: Array | Sequence[Array], role: str, name: str, text: str = ""
    ) -> None:
        """Draw a mark whose places are (K, 2) in m."""
        places, shown = np.atleast_2d(np.asarray(at)), name in self.shown
        self.marks.append(Mark(shape, places, role, name, text, shown))

    def label(self, at: Array, role: str, name: str, away: Array) -> None:
        """Write a name beside a place (2,) in m, ``away`` (2,) from it, any unit."""
        size = max(float(np.linalg.norm(away)), 1e-300)
        towards = (float(away[0]) / size, float(away[1]) / size)
        shown = name in self.shown
        self.marks.append(Mark("text", np.atleast_2d(at), role, name, name, shown, towards))


def symbol_size(model: Model, here: Placed, far: Placed, view: Array) -> float:
    """The size of a symbol in m: a part of that of the machine ``here`` (and ``far`` from there),
    seen by a ``view`` (2, d), dimensionless; 0.12 m where all is in one place."""
    places = [view @ p for p in (*here.centres.values(), *here.points.values())]
    places += [view @ here.frames[body.name].origin for body in model.bodies]
    if any(about_origin(body, here, far) for body in model.bodies):
        places.append(np.zeros(2))
    reach = float(np.ptp(np.array(places), axis=0).max()) if places else 0.0
    return SIZES[len(model.bodies) > 2] * reach if reach > 0 else LONE


def about_origin(body: Body, here: Placed, far: Placed) -> bool:
    """Whether a free body that turns stays at its distance from the origin of the axes."""
    if body.joint is not None or body.angle is None:
        return False
    now, later = here.centres[body.name], far.centres[body.name]
    size = float(np.linalg.norm(now))
    moves = float(np.linalg.norm(later - now)) > SAME * size
    return size > 0 and moves and abs(float(np.linalg.norm(later)) - size) < SAME * size


def spread_out(draft: Draft) -> None:
    """Move free bodies that lie on one place apart, in the order of the file: along their motion,
    and rotors along their shaft."""
    taken: dict[tuple[int, int], list[str]] = {}
    between = any(isinstance(element.place, Between) for element in draft.model.elements)
    for body in draft.model.bodies:
        if body.joint is not None or between:
            continue
        key = tuple(int(x) for x in np.round(draft.centre(body.name) / draft.size))
        taken.setdefault((key[0], key[1]), []).append(body.name)
    for names in taken.values():
        rates = [draft.rate(name, j) for name in names for j in range(len(draft.moved))]
        largest = max(rates, key=lambda rate: float(np.linalg.norm(rate)), default=np.zeros(2))
        along = np.array([1.0, 0.0])
        if abs(largest[1]) > abs(largest[0]):
            along = np.array([0.0, 1.0])
        for i, name in enumerate(names):
            draft.shift[name] = 6 * draft.size * i * along


def mover_of(draft: Draft, j: int) -> tuple[str, Array | None] | None:
    """The first body that the j-th coordinate turns, and None; else the first of those that it
    moves most, and by how much, (2,) in m per SI; None where it moves no body."""
    rates = {body.name: draft.rate(body.name, j) for body in draft.model.bodies}
    sizes = {name: float(np.linalg.norm(rate)) for name, rate in rates.items()}
    turned = [b.name for b in draft.model.bodies if draft.turns(b.name, j)]
    if turned:  # an angle, whatever it carries along
        return turned[0], None
    largest = max(sizes.values(), default=0.0)
    if largest > STILL * draft.size:
        name = next(name for name, size in sizes.items() if size > 0.99 * largest)
        return name, rates[name]
    return None


def point_moved(draft: Draft, j: int) -> tuple[Array, Array] | None:
    """Where a point is that a coordinate without a body moves (a road under a wheel), (2,) in m,
    and by how much, (2,) in m per SI."""
    for point in draft.model.points:
        here, there = draft.here.points[point.name], draft.moved[j].points[point.name]
        rate = draft.flat(there - here) / STEP
        if np.linalg.norm(rate) > STILL * draft.size:
            return draft.flat(here), rate
    return None
