"""Diagnoses of machines with a declared state: the current of a motor with inductance, and the
integrator of a controller."""

import numpy as np
import pytest
from motors import MOTOR, K, L, R, motor, recorded
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording

SERVO = """symhyb = 1
[coordinates]
phi = { unit = "rad" }
[states]
e = { unit = "rad*s", rate = "w - phi", about = "integrator of the controller" }
[parameters]
J = { value = 0.02, unit = "kg*m^2" }
P = { value = 4.0, unit = "N*m/rad" }
I = { value = 3.0, unit = "N*m/(rad*s)" }
D = { value = 0.25, unit = "N*m*s/rad" }
[inputs]
w = { unit = "rad" }
[bodies.rotor]
joint = ["0", "0"]
mass = "0"
inertia = "J"
angle = "phi"
[elements.controller]
kind = "torque"
on = "phi"
torque = "P*(w - phi) + I*e - D*phi'"
[sensors]
encoder = { measures = "phi", unit = "rad" }
"""


def servo(friction: float = 0.0, begin: float = 0.0) -> Recording:
    """The servo by SciPy, 15 s at 5 ms; its integrator begins with ``begin``, rad·s."""
    t, random = 0.005 * np.arange(3000), np.random.default_rng(2)
    lines, phases = np.linspace(0.1, 3.0, 14), random.uniform(0, 2 * np.pi, 14)

    def wanted(time: np.ndarray | float) -> np.ndarray:
        waves = np.sin(2 * np.pi * np.multiply.outer(time, lines) + phases)
        return np.asarray(0.3 * waves.sum(axis=-1))

    def rates(time: float, state: np.ndarray) -> list[float]:
        phi, v, e = state
        off = float(wanted(time)) - phi
        return [v, (4 * off + 3 * e - 0.25 * v - friction * np.tanh(v / 0.01)) / 0.02, off]

    options = {"method": "LSODA", "rtol": 1e-9, "atol": 1e-11, "max_step": 0.005}
    phi = solve_ivp(rates, (0, t[-1]), [0.0, 0.0, begin], t_eval=t, **options).y[0]
    noise = 2e-3 * phi.std() * random.standard_normal(t.size)
    return Recording("servo.csv", t, {"w": wanted(t)}, {"encoder": phi + noise}, (), "")


def test_where_an_integrator_begins_is_no_physics() -> None:
    """It begins at 0.4 rad·s instead of 0: as a constant torque of 1.2 N·m it would be named
    wrongly."""
    diagnosis = sh.diagnose(sh.parse_model(SERVO), servo(begin=0.4))
    assert diagnosis.verdict == "nothing missing"


@pytest.mark.slow
def test_friction_is_found_under_a_controller_that_integrates() -> None:
    diagnosis = sh.diagnose(sh.parse_model(SERVO), servo(friction=0.12))
    (found,) = diagnosis.found
    assert found.element.kind == "friction"
    assert found.coulomb.value == pytest.approx(0.12, abs=3 * found.coulomb.sd + 6e-4)


@pytest.mark.slow
@pytest.mark.parametrize("ammeter", [False, True])
def test_a_wrong_resistance_is_found_and_nothing_else(ammeter: bool) -> None:
    """R stands in the rate of the current alone. The first current is not what it settles to."""
    diagnosis = sh.diagnose(motor(ammeter=ammeter), recorded(ammeter, resistance=1.25))
    assert diagnosis.verdict == "parameters"
    (found,) = diagnosis.parameters
    assert found.name == "R"
    assert abs(found.value - 1.25) < 3 * found.sd
    assert found.sd < 0.01


@pytest.mark.parametrize(
    "ammeter",
    [pytest.param(False, marks=pytest.mark.slow), pytest.param(True, marks=pytest.mark.thorough)],
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


@pytest.mark.thorough
def test_a_missing_back_emf_is_named_as_what_it_does_to_the_shaft() -> None:
    """L i' = u − R i lacks −k φ'. What is missing is the torque k i_2 of a current with
    L i_2' = −R i_2 − k φ': a Maxwell element of stiffness k²/L and damping k²/R."""
    text = MOTOR.replace("(u - R*i - k*phi')/L", "(u - R*i)/L").replace(", sd = 0.3 }", " }")
    diagnosis = sh.diagnose(sh.parse_model(text, "motor.toml"), recorded(ammeter=False))
    (found,) = diagnosis.found
    assert found.element.kind == "relaxation"
    value = {one.term: one for one in found.estimates}
    for key, true in (("stiffness", K**2 / L), ("damping", K**2 / R)):
        assert abs(value[key].value - true) < 3 * value[key].sd < 0.1 * true
