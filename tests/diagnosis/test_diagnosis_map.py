"""A model that knows a map is diagnosed like any other, and does not lack it."""

import numpy as np
import pytest
from law_rigs import driven, numbers
from rigs import spring_model
from scipy.interpolate import RegularGridInterpolator

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.model.types import Model

STRETCH = [-0.1, -0.03, 0.0, 0.04, 0.1]
RATE = [-1.0, -0.2, 0.0, 0.3, 1.2]
FORCE = np.array([[2.5], [1.2], [1.0], [1.3], [3.0]]) * np.array([-2.0, -1.2, 0.0, 0.8, 1.6])
KNOWN = RegularGridInterpolator((STRETCH, RATE), FORCE, bounds_error=False, fill_value=None)


def strut(x: float, v: float) -> float:
    return float(KNOWN((x, v)))


def knowing(scale: str = "") -> Model:
    element = f"""[elements.strut]
kind = "map"
on = "x"
units = ["m", "m/s", "N"]
x = {STRETCH}
y = {RATE}
values = {FORCE.tolist()}
"""
    if scale:
        own = "\n[elements.strut.parameters]\nn = " + scale + "\n"
        element += 'scale = "n"' + own
    return parse_model(spring_model().text + element, "rig.toml")


@pytest.mark.slow
def test_beside_a_known_map_what_is_missing_is_found() -> None:
    run = driven(lambda x, v, z, f: (strut(x, v) + 1500.0 * x**3, 0.0), seed=3)
    found = numbers(sh.diagnose(knowing(), run))
    assert set(found) == {"spring.cubic"}
    cubic, sd = found["spring.cubic"]
    assert abs(cubic - 1500.0) < 4 * sd


@pytest.mark.slow
def test_with_the_map_nothing_is_missing() -> None:
    run = driven(lambda x, v, z, f: (strut(x, v), 0.0), seed=4)
    assert sh.diagnose(knowing(), run).verdict == "nothing missing"


@pytest.mark.slow
def test_the_factor_of_a_map_is_estimated_again() -> None:
    run = driven(lambda x, v, z, f: (1.3 * strut(x, v), 0.0), seed=5)
    diagnosis = sh.diagnose(knowing('{ value = 1.0, sd = 0.3, unit = "1" }'), run)
    assert diagnosis.verdict == "parameters"
    (factor,) = diagnosis.parameters
    assert factor.name == "strut.n"
    assert factor.value == pytest.approx(1.3, abs=4 * factor.sd)
