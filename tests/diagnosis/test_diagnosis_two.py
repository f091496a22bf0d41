"""Two masses in a row: the effect is named at its place, not where its force also shows."""

from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.model.types import Between, On

CHAIN = """
symhyb = 1
title = "two masses in a row"
[coordinates]
x1 = { unit = "m" }
x2 = { unit = "m" }
[parameters]
m1 = { value = 1.0, unit = "kg" }
m2 = { value = 0.7, unit = "kg" }
k1 = { value = 150.0, unit = "N/m" }
k2 = { value = 90.0, unit = "N/m", sd = 5.0 }
l2 = { value = 0.5, unit = "m" }
d1 = { value = 0.4, unit = "N*s/m" }
[inputs]
f = { unit = "N" }
[points]
first = ["x1", "0"]
second = ["l2 + x2", "0"]
[bodies.one]
mass = "m1"
at = "first"
[bodies.two]
mass = "m2"
at = "second"
[elements.wall]
kind = "spring"
on = "x1"
stiffness = "k1"
[elements.bearing]
kind = "damper"
on = "x1"
damping = "d1"
[elements.link]
kind = "spring"
between = ["first", "second"]
stiffness = "k2"
length = "l2"
[elements.motor]
kind = "force"
on = "x1"
force = "f"
[sensors]
one = { measures = "x1", unit = "m" }
two = { measures = "x2", unit = "m" }
"""


def recording(seed: int, hidden: Mapping[str, float]) -> sh.Recording:
    """Positions only, 1 % noise, 12 s at 200 Hz; the damper acts between, the friction on x2."""
    random = np.random.default_rng(seed)
    t = np.arange(0, 12, 0.005)
    lines, phases = np.linspace(0.4, 4.5, 12), random.uniform(0, 2 * np.pi, 12)

    def force(time: float) -> float:
        return float(6 * np.sqrt(2 / 12) * np.sin(2 * np.pi * lines * time + phases).sum())

    def rate(time: float, state: NDArray[np.float64]) -> list[float]:
        x1, x2, v1, v2 = state
        pull = 90 * (x2 - x1) + hidden.get("damping", 0) * (v2 - v1)
        rub = hidden.get("coulomb", 0) * np.tanh(v2 / 1e-5)
        return [v1, v2, force(time) - 150 * x1 - 0.4 * v1 + pull, (-pull - rub) / 0.7]

    run = solve_ivp(
        rate, (0, 12), np.zeros(4), t_eval=t, method="LSODA", rtol=1e-8, atol=1e-10, max_step=0.005
    )
    seen = [x + 0.01 * x.std() * random.standard_normal(t.size) for x in run.y[:2]]
    inputs = {"f": np.array([force(time) for time in t])}
    return sh.Recording("chain.csv", t, inputs, {"one": seen[0], "two": seen[1]}, (), "")


@pytest.mark.slow
def test_a_damper_between_and_friction_on_the_second_mass() -> None:
    hidden = {"damping": 0.6, "coulomb": 0.4}
    diagnosis = sh.diagnose(parse_model(CHAIN, "chain.toml"), recording(1, hidden))
    found = {
        (item.element.place, estimate.term): (estimate.value, estimate.sd)
        for item in diagnosis.found
        for estimate in item.estimates
    }
    assert set(found) == {(Between("first", "second"), "damping"), (On("x2"), "coulomb")}
    for (_, term), (value, sd) in found.items():
        assert value == pytest.approx(hidden[term], rel=0.02)
        assert abs(value - hidden[term]) < 4 * sd
    assert not diagnosis.parameters
    assert not diagnosis.measurement


@pytest.mark.slow
def test_two_masses_with_nothing_concealed() -> None:
    diagnosis = sh.diagnose(parse_model(CHAIN, "chain.toml"), recording(3, {}))
    assert diagnosis.verdict == "nothing missing"
