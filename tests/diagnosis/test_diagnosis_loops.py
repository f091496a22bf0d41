"""Diagnosis of closed loops: recordings by an independent simulation in one minimal coordinate."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from mechanisms import slider_crank
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.diagnosis import diagnose
from symhyb.discrepancy.results import Diagnosis
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import On

pytestmark = pytest.mark.thorough

MODEL = read_model(Path(__file__).parents[2] / "models" / "slider_crank.toml")
# N on the slider; m/s, as sharp as its noise can show: at 2 mm/s, 0.06 % of the largest speed,
# 1.976 N are named beside friction in the rod, which is not there
FRICTION, TRANSITION = 2.0, 4e-4
STARTS = (0.3, 1.0, 2.0)  # rad
STEP, LENGTH = 0.01, 4.0  # s


def torque(t: float, seed: int) -> float:
    t = t + 3.3 * seed
    return 0.7 * np.sin(np.pi * t) + 0.4 * np.sin(2 * np.pi * 1.3 * t + 1)


def recording(friction: float, seed: int) -> Recording:
    """The crank turns under a motor torque and the spring; encoder and scale with their noise."""

    def slope(t: float, state: np.ndarray) -> list[float]:  # type: ignore[type-arg]
        now, rate = slider_crank(state[0]), state[1]
        held = -friction * np.tanh(now.slope[2] * rate / TRANSITION)
        return [rate, now.acceleration(rate, torque(t, seed) + held * now.slope[2])]

    t = np.arange(0, LENGTH + STEP / 2, STEP)
    run = solve_ivp(
        slope, (0, LENGTH), [STARTS[seed], 3.0], "LSODA", t_eval=t, rtol=1e-9, atol=1e-10
    )
    places = np.array([slider_crank(angle).q for angle in run.y[0]])
    noise = np.random.default_rng(seed).standard_normal((2, t.size))
    sensors = {
        "encoder": places[:, 0] + 1e-3 * noise[0],
        "scale": places[:, 2] + 5e-5 * noise[1],
    }
    inputs = {"tau": np.array([torque(float(now), seed) for now in t])}
    return Recording(f"run {seed}", t, inputs, sensors, (), "")


@cache
def answer(friction: float) -> Diagnosis:
    runs = [recording(friction, seed) for seed in range(3)]
    return diagnose(MODEL, runs[:2], runs[2])


def test_friction_of_the_slider_is_named_and_measured() -> None:
    found = answer(FRICTION)
    assert found.verdict == "missing physics"
    (friction,) = found.found
    assert (friction.element.kind, friction.element.place) == ("friction", On("x"))
    (level,) = [item for item in friction.estimates if item.term == "coulomb"]
    assert abs(level.value - FRICTION) < max(3 * level.sd, 0.01 * FRICTION)
    assert friction.share > 0.9


def test_a_loop_that_lacks_nothing_is_reported_so() -> None:
    assert answer(0.0).verdict == "nothing missing"


HOIST = """\
symhyb = 1
title = "A motor lifts a load by a gear, a drum and a rope; a spring holds the load"
gravity = ["0", "-g"]
[coordinates]
motor = { unit = "rad" }
drum  = { unit = "rad" }
lift  = { unit = "m" }
[parameters]
g   = { value = 9.81, unit = "m/s^2" }
J_1 = { value = 0.01, unit = "kg*m^2" }
J_2 = { value = 0.2, unit = "kg*m^2" }
m   = { value = 5.0, unit = "kg" }
n   = { value = 10.0, unit = "1" }
r   = { value = 0.1, unit = "m" }
k   = { value = 400.0, unit = "N/m" }
[inputs]
tau = { unit = "N*m" }
[bodies.load]
mass = "m"
at = ["0", "lift"]
[energy]
kinetic = "J_1*motor'**2/2 + J_2*drum'**2/2"
potential = "k*lift**2/2"
[constraints.gearbox]
kind = "gear"
on = ["motor", "drum"]
ratio = "n"
[constraints.rope]
kind = "rolling"
on = ["lift", "drum"]
radius = "r"
[elements.drive]
kind = "torque"
on = "motor"
torque = "tau"
[sensors]
encoder = { measures = "motor", unit = "rad", sd = 1e-2 }
cell    = { measures = "reaction(rope)", unit = "N", sd = 0.5, about = "between rope and load" }
"""
DAMPING = 0.015  # N·m·s/rad on the motor


def hoisted(damping: float, seed: int) -> Recording:
    """The hoist in the angle of the drum alone: I psi'' = n tau − n² d psi' − r (m g + k r psi)."""
    n, r, m, g, k = 10.0, 0.1, 5.0, 9.81, 400.0
    inertia = n**2 * 0.01 + 0.2 + m * r**2

    def drive(t: float) -> float:
        return float(0.9 * np.sin(2 * t + seed) + 0.7 * np.sin(5.3 * t + 2 * seed))

    def slope(t: float, state: np.ndarray) -> list[float]:  # type: ignore[type-arg]
        load = r * (m * g + k * r * state[0])
        return [state[1], (n * drive(t) - n**2 * damping * state[1] - load) / inertia]

    t = np.arange(0, 8, 0.02)
    run = solve_ivp(slope, (0, 8), [0.3, 0.0], t_eval=t, rtol=1e-9, atol=1e-10)
    pull = np.array([slope(now, state)[1] for now, state in zip(t, run.y.T, strict=True)])
    noise = np.random.default_rng(seed).standard_normal((2, t.size))
    sensors = {
        "encoder": n * run.y[0] + 1e-2 * noise[0],
        "cell": m * (r * pull + g) + k * r * run.y[0] + 0.5 * noise[1],
    }
    inputs = {"tau": np.array([drive(float(now)) for now in t])}
    return Recording(f"hoist {seed}", t, inputs, sensors, (), "")


def test_what_a_gear_and_a_rope_tie_together_is_one_place() -> None:
    runs = [hoisted(DAMPING, seed) for seed in (1, 2, 3)]
    found = diagnose(parse_model(HOIST), runs[:2], runs[2])
    (damper,) = found.found
    assert (damper.element.kind, damper.element.place) == ("damper", On("motor"))
    (level,) = damper.estimates
    assert abs(level.value - DAMPING) < 4 * level.sd
    assert level.sd < 0.01 * DAMPING
