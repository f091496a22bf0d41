"""What the tests of the shipped models share: how far each moves, random states, inputs."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline
from textbook import MODELS, SI, Array, entries

from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build

# By model: how far each coordinate moves about its start (SI), the time in which it does so (s),
# and the size of each input.
SPREAD: dict[str, tuple[tuple[float, ...], float, tuple[float, ...]]] = {
    "oscillator": ((0.5,), 0.3, (3.0,)),
    "duffing": ((0.01,), 0.05, (10.0,)),
    "emps": ((0.2,), 0.5, (50.0,)),
    "silverbox": ((0.1,), 2e-3, (0.1,)),
    "ship_roll": ((0.2,), 0.5, ()),
    "pendulum": ((2.0,), 0.2, ()),
    "double_pendulum": ((2.0, 2.0), 0.2, ()),
    "triple_pendulum": ((2.0, 2.0, 2.0), 0.2, ()),
    "pendulum_on_cart": ((0.5, 2.0, 2.0), 0.3, (5.0,)),
    "cartpole": ((0.1, 2.0), 0.3, (1.0,)),
    "two_link_arm": ((2.0, 2.0), 0.5, (20.0, 8.0)),
    "quarter_car": ((0.05, 0.03, 0.02), 0.1, ()),
    "strut": ((0.05,), 0.08, (800.0,)),
    "half_car": ((0.05, 0.05, 0.03, 0.03), 0.1, (0.03, 0.03)),
    "chain_of_masses": ((2e-3,) * 4, 0.02, (1.0,)),
    "two_inertia_backlash": ((1.0, 0.02), 0.02, (1.0,)),
    "rotor_imbalance": ((2e-4, 2e-4), 5e-3, ()),
    "falling_ball": ((1.0, 5.0), 0.5, ()),
    "damper_rig": ((0.02,), 0.3, ()),
    "dropped_ball": ((5.0,), 0.5, ()),
    "rig_alone": ((0.02,), 0.3, ()),
    "loudspeaker": ((3e-3, 1e-3), 3e-3, (4.0,)),
    "maglev": ((2e-3, 1e-2), 1e-2, (1.0,)),
}
NAMES = sorted(SPREAD)
IN_SPACE = {"gyroscope", "furuta_pendulum", "quadrotor", "six_joint_arm", "bicycle"}
"""Verified in test_models_in_space.py, against MuJoCo and Newton's and Euler's equations; the
bicycle in numeric/test_rolling.py."""
PERIODS = 10  # the length of a run, in the times of SPREAD
INNER = 3e-3  # m: how far the state of the damper on the rig moves


@dataclass(frozen=True)
class States:
    """Random states: q, v (N, n), z (N, z), u (N, k), t (N,), SI."""

    q: Array
    v: Array
    z: Array
    u: Array
    t: Array


def shipped(name: str) -> Model:
    return read_model(MODELS / f"{name}.toml")


def machine_of(name: str) -> Machine:
    return build(shipped(name))


def start_of(name: str) -> Array:
    """The start of each coordinate, SI, as the file says it."""
    table = entries(name, "coordinates").values()
    return np.array([float(c.get("start", 0.0)) * SI[str(c["unit"])] for c in table])


def random_states(machine: Machine, name: str, total: int, seed: int = 1) -> States:
    """Normally distributed states about the start of a model."""
    far, period, inputs = SPREAD[name]
    rng = np.random.default_rng(seed)
    q, v = rng.normal(size=(2, total, len(far))) * far
    u = rng.normal(size=(total, len(inputs))) * np.array(inputs)
    z = INNER * rng.normal(size=(total, machine.inner_states))
    return States(start_of(name) + q, v / period, z, u, rng.uniform(0, 10, total))


def inertial_size(machine: Machine, name: str) -> Array:
    """The size (n,) of M q'' in the motion of a model: below its rounding nothing is reported."""
    far, period, _ = SPREAD[name]
    (mass,) = call(machine.M, (start_of(name), 0.0, machine.values))
    return np.asarray(np.abs(mass) @ np.array(far) / period**2)


def knots(name: str, end: float, total: int = 21) -> tuple[Array, Array]:
    """Random inputs (total, k) at even times (total,): between them they run straight."""
    inputs = np.array(SPREAD[name][2])
    rng = np.random.default_rng(7)
    return np.linspace(0, end, total), rng.normal(size=(total, inputs.size)) * inputs


def acting(name: str, t_u: Array, u: Array) -> tuple[Array, Array]:
    """Times and inputs between which they run straight: the knots, or of a smooth input eight lines
    a sample along the quintic spline through them (docs/model-file.md)."""
    if not any(item.get("between") == "smooth" for item in entries(name, "inputs").values()):
        return t_u, u
    fine = np.linspace(t_u[0], t_u[-1], 8 * (t_u.size - 1) + 1)
    return fine, make_interp_spline(t_u, u, k=5)(fine)


def imposed_motion(name: str, t_u: Array) -> Array | None:
    """Place, speed and acceleration of the imposed coordinate of a model, at the knots."""
    imposed = [bool(c.get("imposed")) for c in entries(name, "coordinates").values()]
    if not any(imposed):
        return None
    far = SPREAD[name][0][imposed.index(True)]
    turn = 2 * np.pi / (t_u[-1] / 2)
    swing, slope = np.sin(turn * t_u), np.cos(turn * t_u)
    return far * np.column_stack([swing, turn * slope, -(turn**2) * swing])


def close(found: Array, wanted: Array, tolerance: float, floor: Array | float = 0.0) -> bool:
    """Whether every entry agrees, relative to itself or to its typical size over the rows (N, …);
    ``floor`` is what rounding leaves of numbers that cancel."""
    typical = np.sqrt(np.mean(np.square(wanted), axis=0))
    allowed = tolerance * np.maximum(np.abs(wanted), typical) + floor
    return bool(np.all(np.abs(found - wanted) <= allowed))
