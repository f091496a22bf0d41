"""A machine in space: what rubs is named at its joint, and nothing is named where nothing rubs.

The recordings come from the equations of the Furuta pendulum written by hand, which share nothing
with symhyb but the numbers of the model file.
"""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.model.types import At, On

MODEL = Path(__file__).parents[2] / "models" / "furuta_pendulum.toml"
END, STEP = 10.0, 0.01


def numbers() -> dict[str, float]:
    table = tomllib.loads(MODEL.read_text(encoding="utf-8"))["parameters"]
    return {name: float(entry["value"]) for name, entry in table.items()}


def recording(seed: int, coulomb: float) -> sh.Recording:
    r"""The arm driven by ten sines of 1 N·m/100 together, with dry friction in its motor:

        ψ: (I + K sin²α) ψ'' + h cosα α'' = u − d_a ψ' − 2 K sinα cosα ψ' α' + h sinα α'² − rub
        α: h cosα ψ'' + L α'' = K sinα cosα ψ'² − d_p α' − m a g sinα

    I: all that turns with the arm, L = J_p + m a², K = L − J_l, h = m a r.
    """
    p, random = numbers(), np.random.default_rng(seed)
    total = p["J_a"] + p["m_a"] * p["c"] ** 2 + p["m_p"] * p["r"] ** 2 + p["J_l"]
    swing = p["J_p"] + p["m_p"] * p["a"] ** 2
    more, coupled = swing - p["J_l"], p["m_p"] * p["a"] * p["r"]
    lines, phases = np.linspace(0.3, 3.3, 10), random.uniform(0, 2 * np.pi, 10)

    def torque(time: float) -> float:
        return float(0.01 * np.sin(2 * np.pi * lines * time + phases).sum())

    def rate(time: float, state: NDArray[np.float64]) -> list[float]:
        _, alpha, arm, rod = state
        s, c = np.sin(alpha), np.cos(alpha)
        mass = np.array([[total + more * s**2, coupled * c], [coupled * c, swing]])
        rub = coulomb * np.tanh(arm / 1e-4)
        turn = torque(time) - p["d_a"] * arm - 2 * more * s * c * arm * rod + coupled * s * rod**2
        fall = more * s * c * arm**2 - p["d_p"] * rod - p["m_p"] * p["a"] * p["g"] * s
        return [arm, rod, *np.linalg.solve(mass, [turn - rub, fall])]

    t = np.arange(0, END, STEP)
    run = solve_ivp(
        rate,
        (0, END),
        [0, 1.0, 0, 0],
        t_eval=t,
        method="LSODA",
        rtol=1e-8,
        atol=1e-10,
        max_step=STEP,
    )
    alpha, arm = run.y[1], run.y[2]
    seen = {"arm": run.y[0], "swing": alpha, "turn_z": np.cos(alpha) * arm}
    noise = {"arm": 1e-3, "swing": 1e-3, "turn_z": 0.02}
    seen = {k: x + noise[k] * random.standard_normal(t.size) for k, x in seen.items()}
    inputs = {"torque": np.array([torque(time) for time in t])}
    return sh.Recording("furuta.csv", t, inputs, seen, (), "")


@pytest.mark.thorough
def test_dry_friction_in_the_motor_of_a_furuta_pendulum_is_named() -> None:
    diagnosis = sh.diagnose(sh.read_model(MODEL), recording(1, 0.008))
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.place) == ("friction", On("psi"))
    (estimate,) = [item for item in found.estimates if item.term == "coulomb"]
    assert abs(estimate.value - 0.008) < 4 * estimate.sd + 2e-4
    reported = [place.occurrence.sentence for place in diagnosis.places if place.occurrence]
    assert any("On psi (joint of arm to the ground)" in sentence for sentence in reported)


@pytest.mark.thorough
def test_a_furuta_pendulum_that_lacks_nothing_is_left_alone() -> None:
    diagnosis = sh.diagnose(sh.read_model(MODEL), recording(2, 0.0))
    assert diagnosis.found == ()
    assert diagnosis.verdict == "nothing missing"


HUNG = """symhyb = 1
title = "a rod hung in a ball joint"
gravity = ["0", "0", "-g"]
[coordinates]
qw = { unit = "1", start = 1.0 }
qx = { unit = "1" }
qy = { unit = "1" }
qz = { unit = "1" }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 1.0, unit = "kg" }
l = { value = 0.3, unit = "m" }
J = { value = 0.02, unit = "kg*m^2" }
[points]
tip = { body = "rod", at = ["0", "0", "-l"] }
[bodies.rod]
joint = ["0", "0", "0"]
mass = "m"
at = ["0", "0", "-l/2"]
inertia = ["J", "0.9*J", "0.4*J"]
quaternion = ["qw", "qx", "qy", "qz"]
[sensors]
turn_x = { measures = "gyroscope_x(rod)", unit = "rad/s" }
turn_y = { measures = "gyroscope_y(rod)", unit = "rad/s" }
turn_z = { measures = "gyroscope_z(rod)", unit = "rad/s" }
east = { measures = "position_x(tip)", unit = "m" }
north = { measures = "position_y(tip)", unit = "m" }
"""


def swung(damping: float) -> sh.Recording:
    """J ω' + ω × J ω = c × m g − damping·tip × (ω × tip) about the joint, in the axes of the rod,
    which are the columns of a rotation matrix R' = R [ω]×."""
    inertia = 0.02 * np.array([1, 0.9, 0.4]) + np.array([1, 1, 0]) * 0.15**2
    centre, tip = np.array([0, 0, -0.15]), np.array([0, 0, -0.3])

    def rate(_: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        turned, w = state[:9].reshape(3, 3), state[9:]
        cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        torque = np.cross(centre, turned.T @ [0, 0, -9.81])
        torque = torque - damping * np.cross(tip, np.cross(w, tip))
        return np.concatenate(
            [(turned @ cross).ravel(), (torque - np.cross(w, inertia * w)) / inertia]
        )

    t = np.arange(0, 6, 0.02)
    start = np.concatenate([np.eye(3).ravel(), [2.4, 1.2, 1.8]])
    run = solve_ivp(rate, (0, 6), start, t_eval=t, rtol=1e-10, atol=1e-12)
    random = np.random.default_rng(4)
    seen = [*run.y[9:], *(run.y[[2, 5]] * -0.3)]
    noise = (0.01, 0.01, 0.01, 1e-3, 1e-3)
    seen = [x + s * random.standard_normal(t.size) for x, s in zip(seen, noise, strict=True)]
    names = ("turn_x", "turn_y", "turn_z", "east", "north")
    return sh.Recording("swung.csv", t, {}, dict(zip(names, seen, strict=True)), (), "")


@pytest.mark.thorough
def test_what_slows_a_body_that_a_quaternion_turns_is_named_at_its_point() -> None:
    diagnosis = sh.diagnose(parse_model(HUNG, "hung.toml"), swung(0.05))
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.place) == ("damper", At("tip"))
    (estimate,) = found.estimates
    assert estimate.value == pytest.approx(0.05, rel=0.1)
    assert abs(estimate.value - 0.05) < 4 * estimate.sd
