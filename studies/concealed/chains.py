"""Masses, inertias and cars in a row: hand-written equations of the longer systems."""

from collections.abc import Callable

import numpy as np
from laws import Array
from systems import Drive, Path_, System, Values, constant_mass, parts


def _neighbours(first: int) -> Path_:
    """From the point of mass ``first`` to that of the next; stretch = x_{i+1} − x_i."""

    def path(p: Values, q: Array) -> tuple[Array, Array]:
        direction = np.zeros_like(q)
        direction[first], direction[first + 1] = -1.0, 1.0
        return q[first + 1] - q[first], direction

    return path


def _chain_mass(n: int) -> Callable[[Values, Array], Array]:
    def mass(p: Values, q: Array) -> Array:
        return constant_mass(
            p, q, *(tuple(row) for row in np.diag([p[f"m{i + 1}"] for i in range(n)]))
        )

    return mass


def _chain_forces(n: int) -> Callable[[Values, Array, Array, Array], Array]:
    """Wall – k1 – m1 – k2 – m2 …; a damper d from every mass to the ground, the input on m1."""

    def forces(p: Values, q: Array, v: Array, u: Array) -> Array:
        result = np.zeros((n + 2, *q.shape))
        result[0, 0] = -p["k1"] * q[0]
        for i in range(1, n):
            pull = p[f"k{i + 1}"] * (q[i] - q[i - 1])
            result[i, i - 1], result[i, i] = pull, -pull
        result[n] = -p["d"] * v
        result[n + 1, 0] = u[0]
        return result

    return forces


def _chain(name: str, n: int, drive: Drive) -> System:
    coordinates = tuple(f"x{i + 1}" for i in range(n))
    between = {f"p{i + 1}-p{i + 2}": _neighbours(i) for i in range(n - 1)}
    return System(
        name, coordinates, _chain_mass(n), _chain_forces(n), drive, between=between, apart="l"
    )


TWO_MASSES = _chain("two_masses", 2, Drive((0.4, 4.5), 6.0))
THREE_MASSES = _chain("three_masses", 3, Drive((0.4, 5.0), 6.0))
FOUR_MASSES = _chain("four_masses", 4, Drive((0.3, 5.0), 7.0))
SIX_MASSES = _chain("six_masses", 6, Drive((0.3, 5.0), 8.0))


def _car_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    spring, strut = p["k_s"] * (q[0] - q[1]), p["d_s"] * (v[0] - v[1])
    return parts((-spring, spring), (-strut, strut), (0.0, p["k_t"] * (u[0] - q[1])))


QUARTER_CAR = System(  # z body, w wheel, both from their rest; the road is the input
    "quarter_car",
    ("z", "w"),
    lambda p, q: constant_mass(p, q, (p["m_b"], 0.0), (0.0, p["m_w"])),
    _car_forces,
    Drive((0.4, 12.0), 0.012),
    inputs=("road",),
    between={
        "hub-top": lambda p, q: (q[0] - q[1], np.stack([np.ones_like(q[0]), -np.ones_like(q[0])]))
    },
    rate=500.0,
    duration=10.0,
)


def _rotor_mass(p: Values, q: Array) -> Array:
    """Angles of the disks: theta, theta − twist1, theta − twist1 − twist2."""
    J_1, J_2, J_3 = p["J1"], p["J2"], p["J3"]
    return constant_mass(
        p, q, (J_1 + J_2 + J_3, -J_2 - J_3, -J_3), (-J_2 - J_3, J_2 + J_3, J_3), (-J_3, J_3, J_3)
    )


def _rotor_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    return parts(
        (u[0], 0.0, 0.0),
        (-p["k0"] * q[0], 0.0, 0.0),
        (-p["d0"] * v[0], 0.0, 0.0),
        (0.0, -p["k1"] * q[1], 0.0),
        (0.0, 0.0, -p["k2"] * q[2]),
        (0.0, -p["d1"] * v[1], -p["d2"] * v[2]),
    )


ROTOR = System(
    "rotor",
    ("theta", "twist1", "twist2"),
    _rotor_mass,
    _rotor_forces,
    Drive((0.4, 6.0), 0.5),
    inputs=("torque",),
)
