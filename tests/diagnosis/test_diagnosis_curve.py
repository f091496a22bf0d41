"""A model that knows a characteristic curve is diagnosed like any other, and does not lack it."""

import pytest
from law_rigs import driven, numbers
from rigs import spring_model
from scipy.interpolate import PchipInterpolator

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.model.types import Model

SPEED = [-0.5, -0.15, -0.03, 0.0, 0.05, 0.2, 0.6]
FORCE = [-2.4, -1.6, -0.8, 0.0, 0.4, 0.9, 1.3]
INNER = PchipInterpolator(SPEED, FORCE)


def strut(v: float) -> float:
    return float(INNER(min(max(v, SPEED[0]), SPEED[-1])))


def knowing(scale: str = "") -> Model:
    points = [[x, f] for x, f in zip(SPEED, FORCE, strict=True)]
    element = f"""[elements.strut]
kind = "curve"
on = "x"
over = "rate"
units = ["m/s", "N"]
extrapolation = "hold"
points = {points}
"""
    if scale:
        own = "\n[elements.strut.parameters]\nn = " + scale + "\n"
        element += 'scale = "n"' + own
    return parse_model(spring_model().text + element, "rig.toml")


@pytest.mark.slow
def test_beside_a_known_curve_what_is_missing_is_found() -> None:
    run = driven(lambda x, v, z, f: (strut(v) + 1500.0 * x**3, 0.0), seed=3)
    diagnosis = sh.diagnose(knowing(), run)
    found = numbers(diagnosis)
    assert set(found) == {"spring.cubic"}
    cubic, sd = found["spring.cubic"]
    assert abs(cubic - 1500.0) < 4 * sd


@pytest.mark.slow
def test_with_the_curve_nothing_is_missing() -> None:
    run = driven(lambda x, v, z, f: (strut(v), 0.0), seed=4)
    assert sh.diagnose(knowing(), run).verdict == "nothing missing"


@pytest.mark.slow
def test_the_factor_of_a_curve_is_estimated_again() -> None:
    run = driven(lambda x, v, z, f: (1.3 * strut(v), 0.0), seed=5)
    diagnosis = sh.diagnose(knowing('{ value = 1.0, sd = 0.3, unit = "1" }'), run)
    assert diagnosis.verdict == "parameters"
    (factor,) = diagnosis.parameters
    assert factor.name == "strut.n"
    assert factor.value == pytest.approx(1.3, abs=4 * factor.sd)
