"""Seven machines of this bench, as equations by hand; their model files lie in ``models/``.

M(q) q'' = Q(q, q', u), all in SI; q and q' have shape (n, …). Every sensor reads one coordinate.
"""

import numpy as np
from shared import HERE, Array, Drive, System, Values, constant_mass, parts

MODELS = HERE / "models"

MASS = System(
    "mass",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-p["k"] * q[0],), (-p["d"] * v[0],), (u[0],)),
    Drive((0.3, 5.0), 8.0),
    folder=MODELS,
)

HARDENING = System(
    "hardening",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-(p["k"] + p["c"] * q[0] ** 2) * q[0],), (-p["d"] * v[0],), (u[0],)),
    Drive((0.3, 4.0), 8.0),
    folder=MODELS,
)

PENDULUM = System(
    "pendulum",
    ("phi",),
    lambda p, q: constant_mass(p, q, (p["m"] * p["l"] ** 2 + p["J"],)),
    lambda p, q, v, u: parts(
        (-p["m"] * p["g"] * p["l"] * np.sin(q[0]),), (-p["d"] * v[0],), (u[0],)
    ),
    Drive((0.2, 2.5), 0.3),
    inputs=("torque",),
    start=(0.3,),
    rate=120.0,
    duration=20.0,
    folder=MODELS,
)

AXIS = System(  # in closed loop: the recorded force is what the controller asks for
    "axis",
    ("x",),
    lambda p, q: constant_mass(p, q, (p["m"],)),
    lambda p, q, v, u: parts((-p["d"] * v[0],), (u[0],)),
    Drive((0.1, 2.0), 0.05, stiffness=4000.0, damping=400.0),
    duration=12.0,
    folder=MODELS,
)


def _link(p: Values, q: Array) -> tuple[Array, Array]:
    """From the first mass to the second; stretch = distance − l."""
    one = np.ones_like(q[0])
    return q[1] - q[0], np.array([-one, one])


def _chain_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    pull = p["k2"] * (q[1] - q[0])
    return parts(
        (-p["k1"] * q[0], 0.0), (pull, -pull), (-p["d"] * v[0], -p["d"] * v[1]), (u[0], 0.0)
    )


CHAIN = System(
    "chain",
    ("x1", "x2"),
    lambda p, q: constant_mass(p, q, (p["m1"], 0.0), (0.0, p["m2"])),
    _chain_forces,
    Drive((0.3, 5.0), 4.0),
    between={"p1-p2": _link},
    duration=12.0,
    apart="l",
    folder=MODELS,
)


def _cart_mass(p: Values, q: Array) -> Array:
    swing = p["m_p"] * p["l"] * np.cos(q[1])
    one = np.ones_like(swing)
    rows = [[(p["m_c"] + p["m_p"]) * one, swing], [swing, (p["J"] + p["m_p"] * p["l"] ** 2) * one]]
    return np.array(rows)


def _cart_forces(p: Values, q: Array, v: Array, u: Array) -> Array:
    inertial = p["m_p"] * p["l"] * np.sin(q[1]) * v[1] ** 2
    weight = -p["m_p"] * p["g"] * p["l"] * np.sin(q[1])
    return parts(
        (u[0], 0.0),
        (inertial, 0.0),
        (0.0, weight),
        (-p["k"] * q[0], 0.0),
        (-p["d_c"] * v[0], 0.0),
        (0.0, -p["d_p"] * v[1]),
    )


CART = System(
    "cart",
    ("s", "phi"),
    _cart_mass,
    _cart_forces,
    Drive((0.2, 3.0), 1.6),
    start=(0.0, 0.3),
    duration=15.0,
    folder=MODELS,
)

GIMBAL = System(
    "gimbal",
    ("a", "b"),
    lambda p, q: constant_mass(p, q, (p["J_a"], 0.0), (0.0, p["J_b"])),
    lambda p, q, v, u: parts(
        (-p["k_a"] * q[0], -p["k_b"] * q[1]), (-p["d"] * v[0], -p["d"] * v[1]), (u[0], u[1])
    ),
    Drive((0.3, 5.0), 0.2),
    inputs=("t_a", "t_b"),
    duration=12.0,
    folder=MODELS,
)

MACHINES = {
    machine.name: machine for machine in (MASS, HARDENING, PENDULUM, AXIS, CHAIN, CART, GIMBAL)
}


def measured_names(system: System) -> tuple[str, ...]:
    """The sensors, one of each coordinate."""
    return tuple(f"pos_{name}" for name in system.coordinates)


def uncertain(system: System) -> dict[str, tuple[float, float]]:
    """Value and standard deviation of the parameters that may be re-estimated."""
    entries = system.parameters().items()
    return {k: (float(e["value"]), float(e["sd"])) for k, e in entries if "sd" in e}
