r"""Velocities of bodies in space, each in its own axes, passed on from body to body:

    v_joint = v_parent + ω_parent × d + d'    at d in the axes of the parent
    v, ω    = … E₂ᵀ E₁ᵀ (v_joint, ω_parent)   each turn E adds its spin to ω
    v_c     = v + ω × c + c'                  at c in the own axes; v_joint where c = 0

T depends on lengths, and on components in one system of axes, whichever that is. With these
velocities M, k_c and their slopes of an arm of six joints are a third to a fifth as long as with
the rates of inertial positions, whose products of rotations differentiation repeats.

Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 4.
"""

from collections.abc import Callable, Iterator, Sequence

import casadi as ca

from symhyb.mechanics.attitude import Vector
from symhyb.mechanics.equations import Link, Mass

Column = Callable[[Vector], ca.SX]
Velocity = tuple[ca.SX, ca.SX]
"""Of a point of a body (3,), m/s, and of turning (3,), rad/s, in the axes of the body."""


def moving(masses: Sequence[Mass]) -> Iterator[Vector]:
    """The positions (3,) whose rates :func:`velocities` needs."""
    for body in masses:
        if body.link is not None:
            yield from (body.link.joint, body.link.centre)


def velocities(masses: Sequence[Mass], column: Column, rate: Column) -> dict[str, Velocity]:
    """The velocities of the centres of all bodies in space, SI, by name.

    ``column`` gives expressions (3,) as SX, ``rate`` the rates of those that are :func:`moving`.
    """
    links = {body.body: body.link for body in masses if body.link is not None}
    origins: dict[str, Velocity] = {"": (ca.SX(3, 1), ca.SX(3, 1))}
    joints: dict[str, ca.SX] = {}  # in the axes before the body is turned

    def carried(origin: Velocity, at: Vector) -> Velocity:
        speed, omega = origin
        swept = ca.cross(omega, ca.sparsify(column(at)))
        return speed + swept + ca.sparsify(rate(at)), omega

    def origin(name: str) -> Velocity:
        if name not in origins:
            link = links[name]
            speed, omega = carried(origin(link.parent), link.joint)
            joints[name] = speed
            for turn in link.turns:
                across = ca.sparsify(ca.horzcat(*map(column, turn.axes)))  # its columns are rows
                speed, omega = ca.mtimes(across, speed), ca.mtimes(across, omega)
                omega += ca.sparsify(column(turn.spin))
            origins[name] = speed, omega
        return origins[name]

    def centre(name: str, link: Link) -> Velocity:
        speed, omega = carried(origin(name), link.centre)
        return (speed if any(link.centre) else joints[name]), omega

    return {name: centre(name, link) for name, link in links.items()}
