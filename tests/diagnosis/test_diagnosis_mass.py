"""Diagnoses of a machine whose mass runs out: named with its course, and nothing is missing where
the model file states it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import symhyb as sh
from symhyb.data.recording import Recording
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, pushed_model, pushing


def emptied(seed: int = 5) -> Recording:
    """The pushed mass by SciPy, from 1 kg down to 0.8 kg in 20 s: m(t) x'' is the force."""
    t = STEP * np.arange(1000)
    push = pushing(np.random.default_rng(seed), t)
    acting = CubicSpline(t, push)

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, (float(acting(time)) - STIFFNESS * x - DAMPING * v) / (1 - 0.01 * time)]

    run = solve_ivp(rates, (0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.005)
    noise = NOISE * np.random.default_rng(900 + seed).standard_normal(t.size)
    return Recording("made.csv", t, {"f": push}, {"laser": run.y[0] + noise}, (), "")


def model(mass: str) -> sh.Model:
    text = pushed_model().text.replace('m = { value = 1.0, unit = "kg" }', KNOWN)
    assert KNOWN in text
    return sh.parse_model(text.replace('mass = "m"', f'mass = "{mass}"'))


KNOWN = 'm = { value = 1.0, unit = "kg", sd = 0.05 }'


def test_nothing_is_missing_where_the_file_states_it() -> None:
    diagnosis = sh.diagnose(model("m - 0.01 kg/s * t"), emptied())
    assert diagnosis.verdict == "nothing missing"


@pytest.mark.thorough
def test_a_mass_that_runs_out_is_named_with_its_course() -> None:
    diagnosis = sh.diagnose(model("m"), emptied())
    assert diagnosis.verdict == "parameters"
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.measurement))
    (course,) = diagnosis.courses
    assert (course.parameter, course.shape, course.unit) == ("m", "drift", "kg")
    for name, true in (("begin", 1.0), ("end", 0.8)):
        number = course.number(name)
        assert abs(number.value - true) < 4 * number.sd
    corrected = sh.apply(model("m"), diagnosis.found, courses=diagnosis.courses)
    assert corrected.bodies["mass"].mass.text == "(m*curve(m_course, t))"
