"""A machine driven by a controller that holds its output: reported so, nothing is missing."""

import numpy as np
from builders import DRIVEN_MASS
from scipy.linalg import expm

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.model.read import parse_model

HOLD = 0.04  # s


def held_recording() -> Recording:
    """x'' + 0.6 x' + 25 x = f with f held, position with 0.2 % noise; exact by the exponential."""
    random, t = np.random.default_rng(3), np.arange(0, 30, HOLD)
    lines, phases = np.linspace(0.2, 2.5, 12), random.uniform(0, 2 * np.pi, 12)
    force = np.sin(2 * np.pi * np.outer(t, lines) + phases).sum(axis=1)
    system = np.array([[0.0, 1.0, 0.0], [-25.0, -0.6, 1.0], [0.0, 0.0, 0.0]])
    over, state, places = expm(system * HOLD), np.zeros(3), []
    for value in force:
        state[2] = value
        places.append(state[0])
        state = over @ state
    x = np.array(places)
    measured = x + 0.002 * x.std() * random.standard_normal(t.size)
    return Recording("held.csv", t, {"f": force}, {"laser": measured}, (), "")


def test_nothing_is_missing_where_the_input_is_known_to_be_held() -> None:
    text = DRIVEN_MASS.replace('f = { unit = "N"', 'f = { unit = "N", between = "held"')
    diagnosis = sh.diagnose(parse_model(text), held_recording())
    assert diagnosis.verdict == "nothing missing"
