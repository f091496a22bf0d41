"""What presses at a coordinate, as a person would write it."""

import pytest

from symhyb.mechanics.loads import loads_on
from symhyb.model.read import parse_model

SERVO = """
symhyb = 1
title = "a servo"
gravity = ["0", "-g"]
[coordinates]
phi = { unit = "rad" }
[parameters]
m = { value = 0.5, unit = "kg" }
l = { value = 0.1, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
d = { value = 0.1, unit = "N*m*s/rad" }
k = { value = 0.1, unit = "N*m/rad" }
[inputs]
tau = { unit = "N*m" }
[bodies.weight]
mass = "m"
at = ["l*sin(phi)", "-l*cos(phi)"]
[elements.motor]
kind = "torque"
on = "phi"
torque = "tau"
[elements.bearing]
kind = "damper"
on = "phi"
damping = "d"
[sensors]
angle = { measures = "phi", unit = "rad" }
"""
SPRING = """
[elements.spring]
kind = "spring"
on = "phi"
stiffness = "k"
"""


def test_weight_and_what_is_applied_press_and_a_damper_does_not() -> None:
    model = parse_model(SERVO, "servo.toml")
    assert loads_on(model, "phi") == ("-g*l*m*sin(phi) + tau", "-g*l*m*sin(phi)", "tau")


def test_a_spring_and_a_declared_energy_press() -> None:
    text = SERVO.replace("[bodies", '[energy]\npotential = "k*phi**4/4"\n[bodies', 1) + SPRING
    loads = loads_on(parse_model(text, "servo.toml"), "phi")
    assert loads[1:] == ("-g*l*m*sin(phi)", "-k*phi**3", "tau", "-k*phi")
    assert len(loads) == 5


@pytest.mark.parametrize("of", ["weight", "motor"])
def test_what_nobody_would_write_or_read_is_left_out(of: str) -> None:
    """An own parameter is known within its element alone; a weight of twenty terms is no text."""
    if of == "weight":
        bumps = " + ".join(f"0.001*l*sin({k}*phi)" for k in range(2, 22))
        text, left = SERVO.replace('"-l*cos(phi)"', f'"-l*cos(phi) + {bumps}"'), "tau"
    else:
        own = "torque = \"c*tau\"\nparameters.c = { value = 2.0, unit = '1' }"
        text, left = SERVO.replace('torque = "tau"', own), "-g*l*m*sin(phi)"
    assert loads_on(parse_model(text, "servo.toml"), "phi") == (left,)
