"""Play in a spring that the model has is one cause, and only there is it looked for."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.candidates import force_hypotheses
from symhyb.laws.reach import Reach
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On

MODEL = """symhyb = 1
[coordinates]
motor = { unit = "rad" }
load = { unit = "rad" }
[parameters]
m = { value = 1.0, unit = "kg" }
j_m = { value = 2e-3, unit = "kg*m^2" }
j_l = { value = 5e-3, unit = "kg*m^2" }
k = { value = 30.0, unit = "N*m/rad" }
d = { value = 0.02, unit = "N*m*s/rad" }
d_m = { value = 0.05, unit = "N*m*s/rad" }
[inputs]
u = { unit = "N*m" }
[bodies.motor]
mass = "m"
at = ["0", "0"]
inertia = "j_m"
angle = "motor"
[bodies.load]
mass = "m"
at = ["0", "0"]
inertia = "j_l"
angle = "load"
[elements.shaft]
kind = "spring"
on = "motor - load"
stiffness = "k"
[elements.loss]
kind = "damper"
on = "motor - load"
damping = "d"
[elements.bearing]
kind = "damper"
on = "motor"
damping = "d_m"
[elements.drive]
kind = "torque"
on = "motor"
torque = "u"
[sensors]
motor = { measures = "motor", unit = "rad", sd = 2e-4 }
load = { measures = "load", unit = "rad", sd = 2e-4 }
"""
TWIST = On("motor - load")
PLAY, NOISE = 0.012, 2e-4  # rad


def shaft() -> Model:
    return parse_model(MODEL, "shaft.toml")


def recorded(seed: int) -> Recording:
    """Two inertias whose shaft has play, under a sum of sines, by SciPy."""
    t = np.arange(0, 8, 0.004)
    chance = np.random.default_rng(seed)
    phases = chance.uniform(0, 2 * np.pi, 10)
    u = sum(0.35 * np.sin((2 + 2.7 * i) * t + phase) for i, phase in enumerate(phases))

    def rates(now: float, y: np.ndarray) -> tuple[float, ...]:
        twist, turning = y[0] - y[1], y[2] - y[3]
        torque = 30.0 * (twist - np.clip(twist, -PLAY, PLAY)) + 0.02 * turning
        push = np.interp(now, t, u) - 0.05 * y[2]
        return y[2], y[3], (push - torque) / 2e-3, torque / 5e-3

    run = solve_ivp(rates, (0, 8), np.zeros(4), t_eval=t, max_step=1e-3, rtol=1e-8, atol=1e-10)
    motor, load = run.y[:2] + NOISE * chance.standard_normal((2, t.size))
    return Recording(f"run{seed}.csv", t, {"u": u}, {"motor": motor, "load": load}, (), "")


@pytest.mark.slow
def test_play_in_a_shaft_is_named_with_its_clearance() -> None:
    found = sh.diagnose(shaft(), recorded(1), recorded(2))
    (one,) = found.found
    assert (one.element.kind, one.element.place) == ("play", TWIST)
    values = {estimate.term: estimate for estimate in one.estimates}
    assert values["clearance"].value == pytest.approx(PLAY, abs=4 * values["clearance"].sd)
    assert values["stiffness"].value == pytest.approx(30.0, abs=4 * values["stiffness"].sd)
    assert values["clearance"].sd < 0.01 * PLAY
    assert "the model lacks play (backlash) of" in found.sentence
    corrected = sh.apply(shaft(), found.found, found.parameters, found.measurement)
    scores = sh.judge(shaft(), corrected, on=recorded(3)).to_frame().set_index(["score", "of"])
    after = scores.loc[("window_rmse", "load"), "after"]
    assert after < 1.2 * NOISE < 0.2 * scores.loc[("window_rmse", "load"), "before"]


def test_play_is_looked_for_where_the_model_has_a_spring_and_nowhere_else() -> None:
    t = np.arange(400) / 100
    swing = Reach(0.05 * np.sin(t), 0.05 * np.cos(t), np.cos(t), t)
    places = {TWIST: swing, On("motor"): swing, On("load"): swing}
    plays = [one for one in force_hypotheses(shaft(), places) if one.kind == "play"]
    assert {one.place for one in plays} == {TWIST}
    assert {one.limits("stiffness") for one in plays} == {(15.0, 60.0)}
    assert len(plays) == 3
