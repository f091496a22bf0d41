"""Velocities passed on from body to body are the rates of inertial positions, turned."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from symhyb.mechanics.equations import derive
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.links import velocities
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.translate import Lowered

MODELS = Path(__file__).parents[2] / "models"
JOINTS = """\
symhyb = 1
[coordinates]
x = { unit = "m", start = 0.2 }
y = { unit = "m", start = -0.3 }
alpha = { unit = "rad", start = 0.4 }
qw = { unit = "1", start = 1 }
qx = { unit = "1" }
qy = { unit = "1" }
qz = { unit = "1" }
[parameters]
m = { value = 2.0, unit = "kg" }
l = { value = 0.7, unit = "m" }
w = { value = 1.3, unit = "rad/s" }
J = { value = 0.2, unit = "kg*m^2" }
[bodies.base]
joint = ["x", "l*sin(w*t)", "0"]
mass = "m"
rotations = [["y", "w*t"], ["x", "pi/2"]]
[bodies.slider]
parent = "base"
joint = ["l", "y", "y**2/l"]
mass = "m"
at = ["l/3", "0", "l/4*cos(alpha)"]
inertia = ["J", "2*J", "2*J", "J/9", "J/8", "-J/7"]
rotations = [["z", "alpha"]]
[bodies.ball]
parent = "slider"
joint = ["0", "l", "x"]
mass = "m/2"
at = ["0", "l/5", "0"]
inertia = "J"
quaternion = ["qw", "qx", "qy", "qz"]
"""


@pytest.mark.parametrize(
    "model",
    [
        parse_model(JOINTS),
        read_model(MODELS / "six_joint_arm.toml"),
        read_model(MODELS / "bicycle.toml"),
    ],
    ids=["every kind of joint", "six-joint arm", "bicycle"],
)
def test_velocities_in_own_axes_are_the_rates_of_inertial_positions(model: Model) -> None:
    equations = derive(model)
    low = Lowered(equations)
    found = velocities(equations.masses, low.column, lambda at: low.rate(low.column(at)))
    assert [*found] == [body.name for body in model.bodies]
    speeds, errors = [], []
    for body in equations.masses:
        velocity, omega = found[body.body]
        axes = equations.places.attitude(body.body).axes
        matrix = ca.vertcat(*(low.column(row).T for row in axes))
        inertial = low.rate(low.column(body.centre))
        assert body.link is not None
        if any(body.link.centre):
            errors.append(ca.mtimes(matrix, velocity) - inertial)
        speeds.append(ca.sumsqr(velocity) - ca.sumsqr(inertial))
        spin = ca.jtimes(matrix, ca.vertcat(low.q, low.t), ca.vertcat(low.v, 1))
        across = ca.mtimes(matrix.T, spin)
        errors.append(omega - ca.vertcat(across[2, 1], across[0, 2], across[1, 0]))
    gap = ca.Function("gap", [low.q, low.v, low.t, low.p], [ca.vertcat(*speeds, *errors)])
    values = np.array([item.si for item in model.all_parameters()])
    draws = np.random.default_rng(5)
    for _ in range(3):
        q, v = draws.standard_normal((2, low.q.numel()))
        assert np.abs(call(gap, (q, v, 0.7, values))[0]).max() < 1e-12


def test_the_rates_of_an_arm_are_no_longer_than_recursion_makes_them() -> None:
    """By inertial positions they took 3251 instructions."""
    machine = build(read_model(MODELS / "six_joint_arm.toml"), keep=False)
    assert state_form(machine).rates().n_instructions() < 2000
