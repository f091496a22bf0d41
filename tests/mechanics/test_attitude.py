"""Bodies turned in space: axes and angular velocity, every element, and what is printed of them."""

import numpy as np
import pytest
import sympy as sp
from builders import Array
from test_readable import compare

from symhyb.mechanics.attitude import quaternion_axes, quaternion_spin
from symhyb.mechanics.equations import derive
from symhyb.mechanics.symbols import symbols_of
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

EVERY_PLACE = """\
symhyb = 1
gravity = ["0.1*g", "0", "-g"]
[coordinates]
x = { unit = "m" }
alpha = { unit = "rad", start = 0.3 }
beta = { unit = "rad", start = 0.5 }
qw = { unit = "1", start = 1 }
qx = { unit = "1" }
qy = { unit = "1" }
qz = { unit = "1" }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 1.3, unit = "kg" }
J = { value = 0.2, unit = "kg*m^2" }
l = { value = 0.4, unit = "m" }
k = { value = 70, unit = "N/m" }
w = { value = 1.7, unit = "1/s" }
b = { value = 0.3, unit = "N*s/m" }
[points]
post = ["l", "l", "0"]
end = { body = "arm", at = ["l", "0", "0.1*l"] }
tip = { body = "ball", at = ["0", "l/3", "l/5"] }
[bodies.arm]
joint = ["x", "0", "0.2*l"]
mass = "m"
at = ["l/2", "0", "0"]
inertia = ["J", "1.4*J", "1.1*J", "J/9", "J/8", "-J/7"]
rotations = [["z", "2*alpha + w*t"], ["x", "beta"]]
[bodies.ball]
parent = "arm"
joint = "end"
mass = "m/2"
inertia = "J/3"
quaternion = ["qw", "qx", "qy", "qz"]
[bodies.load]
mass = "m/5"
at = "tip"
[elements.rope]
kind = "spring"
between = ["post", "tip"]
stiffness = "k"
length = "l"
[elements.air]
kind = "damper"
at = "tip"
damping = "b"
[elements.water]
kind = "added_mass"
at = "end"
mass = "m/3"
[elements.shaker]
kind = "harmonic"
at = "end"
amplitude = ["k*l", "0", "2*k*l"]
frequency = "w"
axes = "ball"
[elements.motor]
kind = "torque"
at = "tip"
torque = ["k*l**2", "0", "k*l**2/3"]
axes = "arm"
[elements.wind]
kind = "torque"
at = "end"
torque = ["0", "k*l**2*sin(x/l)", "0"]
[sensors]
far = { measures = "distance(post, tip)", unit = "m" }
high = { measures = "position_z(tip)", unit = "m" }
turn = { measures = "gyroscope_y(ball)", unit = "rad/s" }
felt = { measures = "accelerometer_y(tip, ball)", unit = "m/s^2" }
"""


@pytest.mark.thorough
def test_every_place_in_space_is_printed_as_it_is_computed() -> None:
    compare(parse_model(EVERY_PLACE), 1)


def placed(model: Model, q: Array, t: float) -> Array:
    """R (3, 3) of the ball, as numbers."""
    equations = derive(model)
    symbols = symbols_of(model)
    values = dict(zip(symbols.q, q, strict=True)) | {symbols.t: t}
    values |= dict(zip(symbols.p, (item.si for item in model.all_parameters()), strict=True))
    axes = equations.places.attitude("ball").axes
    return np.array([[float(entry.subs(values)) for entry in row] for row in axes])


def test_the_gyroscope_shows_how_the_axes_turn() -> None:
    """ω_y of RᵀR' = [ω]×, with R' by central differences along a motion that is prescribed."""
    model, step = parse_model(EVERY_PLACE), 1e-5
    machine, rng, still = build(model), np.random.default_rng(1), np.zeros(0)
    q, v, t = rng.normal(size=7), rng.normal(size=7), 0.7
    before, here, after = (placed(model, q + s * v, t + s) for s in (-step, 0.0, step))
    turn = here.T @ (after - before) / (2 * step)
    assert here.T @ here == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(here) == pytest.approx(1.0)
    y = call(machine.outputs, (q, v, 0 * q, still, still, t, machine.values))[0][0]
    assert y[2] == pytest.approx(turn[0, 2], rel=1e-7)


def test_the_work_of_every_element_is_what_the_energy_gains() -> None:
    """Power of torques and forces against d/dt (T + V) from the equations of motion."""
    model = parse_model(EVERY_PLACE.replace(" + w*t", ""))
    machine, rng, still = build(model), np.random.default_rng(2), np.zeros(0)
    values, step = machine.values, 1e-6
    for _ in range(5):
        q, v = rng.normal(size=7), rng.normal(size=7)
        q[3:] /= np.linalg.norm(q[3:])
        v[3:] -= q[3:] * (q[3:] @ v[3:])  # at length 1, nothing returns the quaternion to it
        a = call(machine.acceleration, (q, v, still, still, 0, values, 0 * q, still))[0][0]
        energies = []
        for s in (-step, step):
            at = (q + s * v + s**2 / 2 * a, v + s * a, still, 0, values)
            kinetic, potential, stored = call(machine.energy, at)
            energies.append(kinetic.item() + potential.item() + stored[0, 0])
        forces = call(machine.elements, (q, v, still, still, 0, values))[0]
        power = sum(force @ v for force in forces[1:])  # the rope stores
        assert (energies[1] - energies[0]) / (2 * step) == pytest.approx(power, rel=1e-6, abs=1e-6)


def test_axes_and_spin_of_a_quaternion_are_those_of_a_rotation() -> None:
    """About the axis (1, 2, 2)/3 by an angle a(t): Rodrigues' formula, and ω = a' e."""
    a, rate = sp.symbols("a rate")
    axis = sp.Matrix([1, 2, 2]) / 3
    w, x = sp.cos(a / 2), tuple(sp.sin(a / 2) * axis)
    cross = (
        axis.hat()
        if hasattr(axis, "hat")
        else sp.Matrix([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    )
    wanted = sp.eye(3) + sp.sin(a) * cross + (1 - sp.cos(a)) * cross**2
    found = sp.Matrix(quaternion_axes(3 * w, tuple(3 * part for part in x)))
    assert sp.simplify(found - wanted) == sp.zeros(3)
    spin = quaternion_spin(w, x, sp.diff(w, a) * rate, tuple(sp.diff(part, a) * rate for part in x))
    assert sp.simplify(sp.Matrix(spin) - rate * axis) == sp.zeros(3, 1)


LOCKING = """\
symhyb = 1
title = "a body whose second angle is driven into gimbal lock"
gravity = ["0", "0", "0"]
[coordinates]
psi = { unit = "rad" }
theta = { unit = "rad", start = 0.5, imposed = true }
phi = { unit = "rad" }
[parameters]
m = { value = 1, unit = "kg" }
J = { value = 1, unit = "kg*m^2" }
u = { value = 1, unit = "N*m" }
[bodies.body]
mass = "m"
at = ["0", "0", "0"]
inertia = ["J", "J", "J"]
rotations = [["z", "psi"], ["x", "theta"], ["z", "phi"]]
[elements.motor]
kind = "torque"
on = "psi"
torque = "u"
[sensors]
s = { measures = "psi", unit = "rad" }
"""


def test_a_run_into_gimbal_lock_says_so() -> None:
    machine = build(parse_model(LOCKING.replace('gravity = ["0", "0", "0"]\n', "")))
    t = np.linspace(0, 1.0, 2001)  # few steps are allowed from one to the next
    motion = np.column_stack([0.5 - t, -np.ones_like(t), 0 * t])
    none = np.zeros((t.size, 0))
    start = np.array([0.0, 0.5, 0.0]), np.array([0.0, -1.0, 0.0])
    run = simulate(machine, Scenario(t, *start, t, none, given=motion))
    assert not run.complete
    assert "the body 'body' is close to gimbal lock: at theta = " in run.reason
    assert "by a quaternion" in run.reason
    assert np.isfinite(run.q[t < 0.4]).all()
