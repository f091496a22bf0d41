"""Diagnoses of a machine with a declared state, the current of a motor with inductance."""

import pytest
from motors import motor, recorded

import symhyb as sh


@pytest.mark.parametrize(
    "ammeter", [pytest.param(False), pytest.param(True, marks=pytest.mark.slow)]
)
def test_a_wrong_resistance_is_found_and_nothing_else(ammeter: bool) -> None:
    """R stands in the rate of the current alone. The first current is not what it settles to."""
    diagnosis = sh.diagnose(motor(ammeter=ammeter), recorded(ammeter, resistance=1.25))
    assert diagnosis.verdict == "parameters"
    (found,) = diagnosis.parameters
    assert found.name == "R"
    assert abs(found.value - 1.25) < 3 * found.sd
    assert found.sd < 0.01


@pytest.mark.parametrize(
    "ammeter", [pytest.param(False), pytest.param(True, marks=pytest.mark.slow)]
)
def test_missing_friction_is_found_and_nothing_else(ammeter: bool) -> None:
    diagnosis = sh.diagnose(motor(ammeter=ammeter), recorded(ammeter, friction=0.004))
    assert diagnosis.verdict == "missing physics"
    (found,) = diagnosis.found
    assert found.element.kind == "friction"
    assert found.coulomb.value == pytest.approx(0.004, abs=3 * found.coulomb.sd + 2e-5)
    assert not diagnosis.parameters


@pytest.mark.slow
@pytest.mark.parametrize("ammeter", [False, True])
def test_nothing_is_missing(ammeter: bool) -> None:
    diagnosis = sh.diagnose(motor(ammeter=ammeter), recorded(ammeter))
    assert diagnosis.verdict == "nothing missing"
