"""A number of the model file that is wrong, and that the file takes for certain."""

from dataclasses import replace

import numpy as np
import pytest
from rigs import spring_model, spring_recording
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.model.types import Model


def with_wrong(name: str, value: float) -> Model:
    model = spring_model()
    return replace(
        model,
        parameters=tuple(
            replace(item, value=value) if item.name == name else item for item in model.parameters
        ),
    )


@pytest.mark.parametrize(
    ("name", "wrong", "truth", "kind"),
    [
        ("m", 1.2, 1.3, "added_mass"),
        pytest.param("k", 190.0, 200.0, "spring", marks=pytest.mark.thorough),
        pytest.param("d", 0.6, 0.8, "damper", marks=pytest.mark.thorough),
    ],
)
def test_a_held_number_that_says_as_much_as_a_law_is_reported_beside_it(
    name: str, wrong: float, truth: float, kind: str
) -> None:
    diagnosis = sh.diagnose(with_wrong(name, wrong), spring_recording(1, {}))
    assert [one.element.kind for one in diagnosis.found] == [kind]
    rival = diagnosis.alternatives[0]
    assert (rival.kind, rival.parameter) == ("parameter", name)
    (value,) = rival.estimates
    assert abs(value.value - truth) < 3 * value.sd
    assert f"One number that the model file holds says as much: {name} = " in diagnosis.sentence


@pytest.mark.thorough
def test_no_number_is_blamed_for_friction() -> None:
    diagnosis = sh.diagnose(spring_model(), spring_recording(1, {"coulomb": 0.5}))
    assert [one.element.kind for one in diagnosis.found] == ["friction"]
    assert "that the model file holds" not in diagnosis.sentence
    assert all(rival.parameter is None for rival in diagnosis.alternatives)


PENDULUM = """
symhyb = 1
title = "a rod with a weight that was not weighed"
gravity = ["0", "-g"]
[coordinates]
phi = {{ unit = "rad" }}
[parameters]
g = {{ value = 9.81, unit = "m/s^2" }}
l = {{ value = 0.4, unit = "m" }}
M = {{ value = {mass}, unit = "kg" }}
J = {{ value = 0.01, unit = "kg*m^2" }}
k = {{ value = 0.8, unit = "N*m/rad" }}
[points]
weight = ["l*sin(phi)", "-l*cos(phi)"]
[inputs]
tau = {{ unit = "N*m", between = "smooth" }}
[bodies.rod]
mass = "M"
at = "weight"
inertia = "J"
angle = "phi"
[elements.spring]
kind = "spring"
on = "phi"
stiffness = "k"
[elements.motor]
kind = "torque"
on = "phi"
torque = "tau"
[sensors]
encoder = {{ measures = "phi", unit = "rad" }}
"""


@pytest.mark.thorough
def test_no_physics_is_named_where_one_held_number_says_more_than_all_of_it() -> None:
    """A mass is inertia and weight at once, and no law of the list is both: a spring that pushes
    away and a gain of the motor were reported."""
    truth, random = 0.6, np.random.default_rng(1)
    t = np.arange(0, 15, 0.005)
    lines, phases = np.linspace(0.2, 2.5, 12), random.uniform(0, 2 * np.pi, 12)

    def torque(now: float) -> float:
        return float(0.35 * np.sin(2 * np.pi * lines * now + phases).sum())

    def rate(now: float, state: np.ndarray) -> list[float]:
        pull = torque(now) - 0.8 * state[0] - truth * 9.81 * 0.4 * np.sin(state[0])
        return [state[1], pull / (0.01 + truth * 0.4**2)]

    run = solve_ivp(rate, (0, 15), [0, 0], t_eval=t, rtol=1e-9, atol=1e-11, max_step=0.01)
    phi = run.y[0] + 1e-3 * random.standard_normal(t.size)
    inputs = {"tau": np.array([torque(now) for now in t])}
    recording = Recording("swing.csv", t, inputs, {"encoder": phi}, (), "")
    model = parse_model(PENDULUM.format(mass=0.5), "pendulum.toml")
    diagnosis = sh.diagnose(model, recording)
    rival = diagnosis.alternatives[0]
    assert rival.parameter == "M"
    assert abs(rival.estimates[0].value - truth) < 3 * rival.estimates[0].sd
    assert "A number that the model file holds explains more than all causes: M = " in (
        diagnosis.sentence
    )
    assert diagnosis.verdict == "undecided"
    assert not diagnosis.found
