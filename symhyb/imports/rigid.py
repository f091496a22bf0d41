r"""Rigid displacements, and moments of inertia that a body can have.

    R = Rz(yaw) Ry(pitch) Rx(roll)          r_parent = R r_child + p

An angle within ``SAME`` of a multiple of a right angle is that multiple, so that its matrix has
zeros where the drawing has them; ``1.57079632679`` is π/2 in the digits that the file states.

A tensor J is that of a body if the second moments Σ = ½ tr(J)·1 − J = ∫ r rᵀ dm have no negative
principal value, which is the triangle inequality of J. Source: P. Wensing, S. Kim, J.-J. Slotine,
Linear matrix inequalities for physically consistent inertial parameter identification, IEEE
Robotics and Automation Letters 3(1), 2018.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from symhyb.imports.robot import Array, Inertial

SAME = 1e-9  # rad, and of components of unit vectors
SLIGHT = 1e-9  # relative, of principal moments: rounding
ROUNDING = 1e-14  # relative, of second moments: what is left of a zero by sums
DENSITY = 2700.0  # kg/m³, of aluminium: of what links are made


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A frame in another: the columns of ``turned`` (3, 3) are its axes, ``at`` (3,), m, its
    origin."""

    turned: Array
    at: Array

    def then(self, inner: "Pose") -> "Pose":
        """A frame that is given in this one, in the frame in which this one is given."""
        return Pose(self.turned @ inner.turned, self.turned @ inner.at + self.at)

    @property
    def matrix(self) -> Array:
        """T (4, 4): coordinates in the other frame are T·(r, 1)."""
        found: Array = np.eye(4)
        found[:3, :3], found[:3, 3] = self.turned, self.at
        return found


def here() -> Pose:
    """The frame itself."""
    return Pose(np.eye(3), np.zeros(3))


def right_angles(angle: float) -> int | None:
    """How many right angles an angle is, None if it is not a whole number of them."""
    count = round(angle / (pi / 2))
    return count if abs(angle - count * pi / 2) < SAME else None


def cosine_and_sine(angle: float) -> tuple[float, float]:
    """cos and sin, exactly 0 and ±1 at right angles."""
    count = right_angles(angle)
    if count is None:
        return cos(angle), sin(angle)
    return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[count % 4]


def about(axis: int, angle: float) -> Array:
    """R (3, 3), dimensionless, of a turn about the axis of that index."""
    c, s = cosine_and_sine(angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix: Array = np.eye(3)
    matrix[j, j], matrix[j, k], matrix[k, j], matrix[k, k] = c, -s, s, c
    return matrix


def from_rpy(rpy: Sequence[float]) -> Array:
    """R (3, 3) of roll, pitch and yaw in rad."""
    roll, pitch, yaw = rpy
    return about(2, yaw) @ about(1, pitch) @ about(0, roll)


def to_rpy(turned: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw, rad, of R (3, 3); where the pitch is a right angle the roll is 0."""
    cross = hypot(turned[0, 0], turned[1, 0])
    pitch = atan2(-turned[2, 0], cross)
    if cross < SAME:
        yaw, roll = atan2(-turned[0, 1], turned[1, 1]), 0.0
    else:
        yaw, roll = atan2(turned[1, 0], turned[0, 0]), atan2(turned[2, 1], turned[2, 2])
    return _snapped(roll), _snapped(pitch), _snapped(yaw)


def _snapped(angle: float) -> float:
    count = right_angles(angle)
    return angle if count is None else count * pi / 2


def about_vector(axis: Sequence[float], angle: float) -> Array:
    """R (3, 3), dimensionless, of a turn about a unit vector (Rodrigues)."""
    c, s = cosine_and_sine(angle)
    x, y, z = axis
    skew: Array = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + s * skew + (1 - c) * (skew @ skew)
    return turned


def from_quaternion(parts: Sequence[float]) -> Array:
    """R (3, 3), dimensionless, of a quaternion, scalar part first; exact at right angles."""
    w, x, y, z = (float(part) for part in parts)
    size = w * w + x * x + y * y + z * z
    skew: Array = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + 2 * (w * skew + skew @ skew) / size
    near = np.round(turned)
    return near if np.abs(turned - near).max() < SAME else turned


def quaternion_of(turned: Array) -> Array:
    """The quaternion (4,), dimensionless, scalar part first and not negative, of R (3, 3)."""
    xx, yy, zz = np.diag(turned)
    sums = np.array([xx + yy + zz, xx - yy - zz, yy - xx - zz, zz - xx - yy])
    lead = int(np.argmax(sums))
    w = turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]
    xy, xz, yz = (turned[i, j] + turned[j, i] for i, j in ((0, 1), (0, 2), (1, 2)))
    rows = (
        (1 + sums[0], *w),
        (w[0], 1 + sums[1], xy, xz),
        (w[1], xy, 1 + sums[2], yz),
        (w[2], xz, yz, 1 + sums[3]),
    )
    found: Array = np.array(rows[lead]) / np.linalg.norm(rows[lead])
    return found if found[0] >= 0 else -found


def moved(inertial: Inertial, pose: Pose) -> Inertial:
    """What is given in a frame, in the frame in which that one is given."""
    turned = pose.turned
    tensor = turned @ inertial.tensor @ turned.T
    return Inertial(inertial.mass, turned @ inertial.centre + pose.at, (tensor + tensor.T) / 2)


def joined(parts: Sequence[Inertial]) -> Inertial:
    """Several masses as one rigid body (parallel axes), about its centre of mass."""
    if len(parts) == 1:
        return parts[0]
    mass = sum(part.mass for part in parts)
    moment = sum((part.mass * part.centre for part in parts), np.zeros(3))
    centre = moment / mass if mass else np.zeros(3)
    tensor = sum((about_point(part, centre) for part in parts), np.zeros((3, 3)))
    return Inertial(mass, centre, tensor)


def about_point(part: Inertial, point: Array) -> Array:
    """The tensor (3, 3), kg·m², about another point (3,), m, than the centre."""
    arm = part.centre - point
    swept: Array = (arm @ arm) * np.eye(3) - np.outer(arm, arm)
    return part.tensor + part.mass * swept


def is_of_a_body(tensor: Array) -> bool:
    """Whether a tensor (3, 3), SI, about the centre is positive and obeys the triangle inequality;
    0, that of a point, does."""
    second = np.linalg.eigvalsh(_second_moments(tensor))
    return bool(second[0] >= -SLIGHT * max(second[-1], 0.0))


def nearest_of_a_body(tensor: Array, least: float = 0.0) -> Array:
    """The tensor (3, 3), SI, of a body whose second moments are nearest to those of this one, the
    principal ones at least that part of the largest."""
    values, axes = np.linalg.eigh(_second_moments(tensor))
    second = (axes * np.maximum(values, least * values[-1])) @ axes.T
    nearest: Array = np.trace(second) * np.eye(3) - second
    return nearest


def _second_moments(tensor: Array) -> Array:
    second: Array = np.trace(tensor) / 2 * np.eye(3) - tensor
    return second


def pseudo_inertia(part: Inertial) -> Array:
    """∫ (r, 1)(r, 1)ᵀ dm (4, 4) about the origin, SI: second moments, first moments and mass, which
    add up over bodies. In a frame in which this one lies at T (4, 4) it is T·P·Tᵀ."""
    arm, whole = np.array([*part.centre, 1.0]), np.zeros((4, 4))
    whole[:3, :3] = _second_moments(part.tensor)
    pseudo: Array = whole + part.mass * np.outer(arm, arm)
    return pseudo


def from_pseudo_inertia(pseudo: Array) -> Inertial:
    """Mass, centre and tensor about that of ∫ (r, 1)(r, 1)ᵀ dm (4, 4), SI; without mass the centre
    is the origin."""
    mass = float(pseudo[3, 3])
    centre = pseudo[:3, 3] / mass if mass else np.zeros(3)
    second = pseudo[:3, :3] - mass * np.outer(centre, centre)
    second[np.abs(second) <= ROUNDING * np.abs(np.diag(pseudo)[:3]).max()] = 0.0
    return Inertial(mass, centre, np.trace(second) * np.eye(3) - second)


def ball(mass: float) -> float:
    """The moment of inertia of a solid ball of aluminium of that mass, kg·m²."""
    radius = float((3 * mass / (4 * pi * DENSITY)) ** (1 / 3))
    return 0.4 * mass * radius**2
