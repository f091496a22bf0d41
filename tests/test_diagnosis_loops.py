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
from symhyb.model.read import read_model
from symhyb.model.types import On

pytestmark = pytest.mark.slow

MODEL = read_model(Path(__file__).parents[1] / "models" / "slider_crank.toml")
FRICTION, TRANSITION = 2.0, 2e-3  # N on the slider, m/s
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


def test_a_loop_that_lacks_nothing_is_told_so() -> None:
    assert answer(0.0).verdict == "nothing missing"
