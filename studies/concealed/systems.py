"""What a system is to the generators, and the small machines with one or two coordinates.

Every machine is written twice on purpose: as a model file in ``models/`` for the tool that is
judged, and as equations by hand here, M(q) q'' = Q(q, q', u). All in SI; q and q' have shape
(n, …), where … is one state or many. The numbers come from the model file, read as plain TOML.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from laws import Array

MODELS = Path(__file__).resolve().parent / "models"
Values = Mapping[str, float]
Path_ = Callable[[Values, Array], tuple[Array, Array]]  # p, q -> stretch (…), direction (n, …)


@dataclass(frozen=True, slots=True)
class Drive:
    """How a system is excited: lines of ``band`` Hz; ``size`` is the RMS of the input, or of the
    motion that a controller (``stiffness`` N/m, ``damping`` N·s/m) makes coordinate 0 follow."""

    band: tuple[float, float]
    size: float
    stiffness: float = 0.0
    damping: float = 0.0

    @property
    def closed(self) -> bool:
        """Whether a controller makes the input from the motion."""
        return self.stiffness > 0


@dataclass(frozen=True, slots=True)
class System:
    """One machine: its equations, its places, how it is driven and sampled.

    ``mass(p, q)`` is M (n, n, …); ``forces(p, q, v, u)`` are the known generalized forces by origin
    (parts, n, …). ``places`` give stretch and direction J, with rate J·v. ``imposed``: the one
    coordinate is moved by a rig, whose force is what the cell reads. ``apart``: the parameter that
    is the distance of neighbours at stretch 0, where all points lie on one line.
    """

    name: str
    coordinates: tuple[str, ...]
    mass: Callable[[Values, Array], Array]
    forces: Callable[[Values, Array, Array, Array], Array]
    drive: Drive
    inputs: tuple[str, ...] = ("f",)
    between: Mapping[str, Path_] = field(default_factory=dict)
    start: tuple[float, ...] = ()
    rate: float = 200.0  # samples in 1/s
    duration: float = 15.0  # s
    imposed: bool = False
    apart: str = ""
    folder: Path = MODELS  # of the model file

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.coordinates)

    @property
    def places(self) -> tuple[str, ...]:
        """All places by name: coordinates, then pairs of points as ``a-b``."""
        return (*self.coordinates, *self.between)

    def path(self, p: Values, q: Array, place: str) -> tuple[Array, Array]:
        """Stretch (…) and direction (n, …) of a place."""
        if place in self.between:
            return self.between[place](p, q)
        i = self.coordinates.index(place)
        direction = np.zeros_like(q)
        direction[i] = 1.0
        return q[i], direction

    def met(self, p: Values, q: Array) -> bool:
        """Whether two neighbours on one line come within a twentieth of their distance, or pass
        through each other, along q (n, N): the equations know no such thing, points do."""
        closest = min(
            (float(path(p, q)[0].min()) for path in self.between.values()), default=np.inf
        )
        return bool(self.apart) and closest < -0.95 * p[self.apart]

    def text(self) -> str:
        """The model file."""
        return (self.folder / f"{self.name}.toml").read_text(encoding="utf-8")

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Parameters of the model file: ``value``, ``unit`` and perhaps ``sd``, all in SI."""
        entries: dict[str, dict[str, Any]] = tomllib.loads(self.text())["parameters"]
        return entries

    def values(self) -> dict[str, float]:
        """The values of the parameters, SI."""
        return {name: float(entry["value"]) for name, entry in self.parameters().items()}


def constant_mass(p: Values, q: Array, *rows: tuple[float, ...]) -> Array:
    """A mass matrix that does not depend on q, for all states of ``q`` (n, …)."""
    matrix = np.array(rows, dtype=float)
    return matrix.reshape(matrix.shape + (1,) * (q.ndim - 1)) + np.zeros((1, 1, *q.shape[1:]))


def parts(*rows: tuple[Any, ...]) -> Array:
    """Forces by origin (parts, n, …) from one row of n components an origin."""
    result = np.empty(
        (len(rows), len(rows[0]), *np.broadcast(*(x for row in rows for x in row)).shape)
    )
    for i, row in enumerate(rows):
        for j, item in enumerate(row):
            result[i, j] = item
    return result


OSCILLATOR = System(
    "oscillator",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-p["k"] * q[0],), (-p["d"] * v[0],), (u[0],)),
    Drive((0.3, 5.0), 8.0),
)

DUFFING = System(
    "duffing",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-(p["k"] + p["c"] * q[0] ** 2) * q[0],), (-p["d"] * v[0],), (u[0],)),
    Drive((0.3, 4.0), 9.0),
)

VOLTS = System(
    "volts",
    ("y",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-p["k"] * q[0],), (-p["d"] * v[0],), (u[0],)),
    Drive((4.0, 45.0), 0.25),
    rate=2000.0,
    duration=1.5,
)

PENDULUM = System(
    "pendulum",
    ("phi",),
    lambda p, q: constant_mass(p, q, (p["m"] * p["l"] ** 2 + p["J"],)),
    lambda p, q, v, u: parts(
        (-p["m"] * p["g"] * p["l"] * np.sin(q[0]),), (-p["d"] * v[0],), (u[0],)
    ),
    Drive((0.2, 2.5), 0.25),
    inputs=("torque",),
    start=(0.3,),
    duration=20.0,
)

SLED = System(  # a free mass under a controller, the recorded force is what the controller asks for
    "sled",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((u[0],)),
    Drive((0.1, 1.5), 0.08, stiffness=6000.0, damping=900.0),
)

RIG = System(  # the rig imposes x; forces are what the model knows, the cell reads the rest
    "rig",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-p["k"] * q[0],), (-p["d"] * v[0],)),
    Drive((0.2, 3.0), 0.02),
    inputs=(),
    imposed=True,
)


def _cart_mass(p: Values, q: Array) -> Array:
    swing = p["m_p"] * p["l"] * np.cos(q[1])
    one = np.ones_like(swing)
    rows = [[(p["m_c"] + p["m_p"]) * one, swing], [swing, (p["J"] + p["m_p"] * p["l"] ** 2) * one]]
    return np.array(rows)


def _band(p: Values, q: Array) -> tuple[Array, Array]:
    """From the post to the tip of the pole; stretch = distance − slack length."""
    x = q[0] + 2 * p["l"] * np.sin(q[1]) - p["post_x"]
    y = -2 * p["l"] * np.cos(q[1]) - p["post_y"]
    distance = np.hypot(x, y)
    turn = (x * np.cos(q[1]) + y * np.sin(q[1])) * 2 * p["l"] / distance
    return distance - p["l_b"], np.array([x / distance, turn])


def _cart_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    s, direction = _band(p, q)
    pull = -p["k_b"] * s * direction
    inertial = p["m_p"] * p["l"] * np.sin(q[1]) * v[1] ** 2
    weight = -p["m_p"] * p["g"] * p["l"] * np.sin(q[1])
    return parts(
        (u[0], 0.0), (inertial, 0.0), (0.0, weight), (0.0, -p["d"] * v[1]), (pull[0], pull[1])
    )


CARTPOLE = System(
    "cartpole",
    ("s", "phi"),
    _cart_mass,
    _cart_forces,
    Drive((0.2, 2.5), 1.0),
    between={"post-tip": _band},
    start=(0.0, 0.3),
    duration=18.0,
)


def _arm_mass(p: Values, q: Array) -> Array:
    m, rod, c, J = p["m"], p["l"], p["c"], p["J"]
    cross, one = m * rod * c * np.cos(q[1]), np.ones_like(q[1])
    inner = J + m * c**2
    first = inner + J + m * (rod**2 + c**2)
    return np.array(
        [[first * one + 2 * cross, inner * one + cross], [inner * one + cross, inner * one]]
    )


def _arm_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    m, rod, c, g = p["m"], p["l"], p["c"], p["g"]
    h = m * rod * c * np.sin(q[1])
    inertial = h * (2 * v[0] * v[1] + v[1] ** 2), -h * v[0] ** 2
    lower = -m * g * c * np.sin(q[0] + q[1])
    upper = -m * g * (c + rod) * np.sin(q[0])
    return parts(
        inertial, (upper + lower, lower), (-p["d"] * v[0], -p["d"] * v[1]), (u[0], 0.0), (0.0, u[1])
    )


DOUBLE_PENDULUM = System(
    "double_pendulum",
    ("a", "b"),
    _arm_mass,
    _arm_forces,
    Drive((0.3, 3.0), 0.2),
    inputs=("shoulder", "elbow"),
    start=(0.2, -0.1),
)


def _drive_mass(p: Values, q: Array) -> Array:
    return constant_mass(p, q, (p["J_m"] + p["J_l"], -p["J_l"]), (-p["J_l"], p["J_l"]))


def _drive_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    return parts((u[0], 0.0), (-p["d_m"] * v[0], 0.0), (0.0, -p["k"] * q[1]), (0.0, -p["d"] * v[1]))


TWO_INERTIAS = System(
    "two_inertias",
    ("theta", "twist"),
    _drive_mass,
    _drive_forces,
    Drive((0.2, 4.0), 0.9, stiffness=5.0, damping=0.35),
    inputs=("torque",),
)


def _springs_of_table(p: Values, q: Array) -> list[tuple[Array, Array]]:
    return [_post(p, q, side) for side in (-1.0, 1.0)]


def _post(p: Values, q: Array, side: float) -> tuple[Array, Array]:
    """From a post at (±a, −a) to the puck; stretch = distance − slack length."""
    x, y = q[0] - side * p["a"], q[1] + p["a"]
    distance = np.hypot(x, y)
    return distance - p["slack"], np.array([x / distance, y / distance])


def _table_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    (s_1, n_1), (s_2, n_2) = _springs_of_table(p, q)
    left, right = -p["k"] * s_1 * n_1, -p["k"] * s_2 * n_2
    return parts(
        (u[0], 0.0),
        (0.0, u[1]),
        (left[0], left[1]),
        (right[0], right[1]),
        (-p["d"] * v[0], -p["d"] * v[1]),
    )


TABLE = System(
    "table",
    ("x", "y"),
    lambda p, q: constant_mass(p, q, (p["m"], 0.0), (0.0, p["m"])),
    _table_forces,
    Drive((0.3, 4.0), 2.5),
    inputs=("f_x", "f_y"),
    between={
        "left-puck": lambda p, q: _post(p, q, -1.0),
        "right-puck": lambda p, q: _post(p, q, 1.0),
    },
)
