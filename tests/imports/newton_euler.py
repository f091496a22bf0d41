"""Inverse dynamics and energies of a URDF without symhyb: its own reading and its own mechanics.

Recursive Newton-Euler in the inertial axes: velocities and accelerations outwards, forces inwards.
Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 5.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass
class Moving:
    """A link in motion: axes ``R``, origin ``p``, ω, its rate, acceleration and velocity of the
    origin."""

    R: Array
    p: Array
    w: Array
    dw: Array
    a: Array
    v: Array


def _three(node: ElementTree.Element | None, key: str, default: str = "0 0 0") -> Array:
    text = default if node is None else node.get(key, default)
    return np.array([float(part) for part in text.split()])


def _turn(node: ElementTree.Element | None) -> Array:
    return Rotation.from_euler("xyz", _three(node, "rpy")).as_matrix()


def _body(link: ElementTree.Element) -> tuple[float, Array, Array]:
    inertial = link.find("inertial")
    if inertial is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    origin, tensor = inertial.find("origin"), inertial.find("inertia")
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    xx, xy, xz, yy, yz, zz = (float(tensor.get(key)) for key in keys)
    J, R = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), _turn(origin)
    mass = inertial.find("mass")
    return float(mass.get("value", "0")), _three(origin, "xyz"), R @ J @ R.T


def _joints(robot: ElementTree.Element) -> list[ElementTree.Element]:
    """Joints, a parent before its children."""
    waiting, order = list(robot.findall("joint")), []
    reached = {link.get("name") for link in robot.findall("link")}
    reached -= {joint.find("child").get("link") for joint in waiting}
    while waiting:
        joint = next(j for j in waiting if j.find("parent").get("link") in reached)
        waiting.remove(joint)
        order.append(joint)
        reached.add(joint.find("child").get("link"))
    return order


def _ends(joint: ElementTree.Element) -> tuple[str, str]:
    return tuple(joint.find(end).get("link") for end in ("parent", "child"))


def _outwards(
    text: str, q: Mapping[str, float], v: Mapping[str, float], a: Mapping[str, float]
) -> tuple[dict[str, Moving], dict[str, Array]]:
    """Motion of every link, and the axis of every joint, in the inertial axes."""
    robot = ElementTree.fromstring(text)
    order = _joints(robot)
    root = _ends(order[0])[0]
    rest = np.zeros(3)
    moving = {root: Moving(np.eye(3), rest, rest, rest, -GRAVITY, rest)}
    axes = {}
    for joint in order:
        parent, child = _ends(joint)
        one, name, origin = moving[parent], joint.get("name", ""), joint.find("origin")
        R = one.R @ _turn(origin)
        p = one.p + one.R @ _three(origin, "xyz")
        axis = _three(joint.find("axis"), "xyz", "1 0 0")
        n = axis / np.linalg.norm(axis)
        z = axes[name] = R @ n
        x, dx, ddx = (values.get(name, 0.0) for values in (q, v, a))
        slides = joint.get("type") == "prismatic"
        if slides:
            p = p + z * x
        elif joint.get("type") != "fixed":
            R = R @ Rotation.from_rotvec(n * x).as_matrix()
        r = p - one.p
        w, dw = one.w, one.dw
        velocity = one.v + np.cross(w, r)
        speed = one.a + np.cross(dw, r) + np.cross(w, np.cross(w, r))
        if slides:
            velocity = velocity + z * dx
            speed = speed + z * ddx + 2 * np.cross(w, z * dx)
        elif joint.get("type") != "fixed":
            dw = dw + z * ddx + np.cross(w, z * dx)
            w = w + z * dx
        moving[child] = Moving(R, p, w, dw, speed, velocity)
    return moving, axes


def inverse_dynamics(
    text: str, q: Mapping[str, float], v: Mapping[str, float], a: Mapping[str, float]
) -> dict[str, float]:
    """The torque or force of each joint for positions, rates and accelerations by joint."""
    robot = ElementTree.fromstring(text)
    moving, axes = _outwards(text, q, v, a)
    force, moment = {}, {}
    for link in robot.findall("link"):
        name = link.get("name", "")
        one, (mass, centre, J) = moving[name], _body(link)
        d, J = one.R @ centre, one.R @ J @ one.R.T
        F = mass * (one.a + np.cross(one.dw, d) + np.cross(one.w, np.cross(one.w, d)))
        force[name] = F
        moment[name] = J @ one.dw + np.cross(one.w, J @ one.w) + np.cross(d, F)
    needed = {}
    for joint in reversed(_joints(robot)):
        parent, child = _ends(joint)
        name = joint.get("name", "")
        along = force if joint.get("type") == "prismatic" else moment
        needed[name] = float(axes[name] @ along[child])
        r = moving[child].p - moving[parent].p
        force[parent] = force[parent] + force[child]
        moment[parent] = moment[parent] + moment[child] + np.cross(r, force[child])
    return needed


def energies(text: str, q: Mapping[str, float], v: Mapping[str, float]) -> tuple[float, float]:
    """Kinetic energy, and potential energy in gravity, J."""
    robot = ElementTree.fromstring(text)
    moving, _ = _outwards(text, q, v, {})
    kinetic = potential = 0.0
    for link in robot.findall("link"):
        one, (mass, centre, J) = moving[link.get("name", "")], _body(link)
        d, J = one.R @ centre, one.R @ J @ one.R.T
        speed = one.v + np.cross(one.w, d)
        kinetic += mass * speed @ speed / 2 + one.w @ J @ one.w / 2
        potential -= mass * GRAVITY @ (one.p + d)
    return float(kinetic), float(potential)
