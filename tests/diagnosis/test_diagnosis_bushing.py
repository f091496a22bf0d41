r"""A whole diagnosis of a bushing of which the model has the spring alone: a Maxwell branch and dry
friction that yields at first (Dahl) are concealed at the same place.

wall |--/\/\/--------[1 kg]--▶ x     dynamic stiffness and loss angle against amplitude
     |--/\/\--[===]--|               and frequency are those of the true bushing
     |--/\/\--≈≈≈≈≈--|
"""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.model.types import Element
from tests.pushed import DAMPING, STEP, STIFFNESS, pushed_model

Array = NDArray[np.float64]
BRANCH, TIME_S = 10.0, 0.3
RUB, YIELDS = 0.6, 30.0  # N, N/m
NOISE, SAMPLES = 5e-4, 1500
LINES = np.linspace(0.2, 2.0, 10)


def hidden(x: float, v: float, z: float, p: float) -> tuple[float, float, float]:
    """Force of branch and friction, and the rates of their states, by hand."""
    force = BRANCH * (x - z) + YIELDS * p
    return force, (x - z) / TIME_S, v - YIELDS * abs(v) * p / RUB


def pushed(size: float, seed: int) -> Recording:
    """The mass on its bushing under a multisine of ``size`` N RMS, by SciPy."""
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, LINES.size)

    def push(t: float) -> float:
        return float(size * np.sqrt(2 / LINES.size) * np.sin(2 * np.pi * LINES * t + phases).sum())

    def rates(t: float, y: Array) -> list[float]:
        x, v, z, p = y
        force, crept, slid = hidden(x, v, z, p)
        return [v, push(t) - STIFFNESS * x - DAMPING * v - force, crept, slid]

    t = STEP * np.arange(SAMPLES)
    run = solve_ivp(
        rates, (0, t[-1]), np.zeros(4), "LSODA", t, rtol=1e-9, atol=1e-11, max_step=STEP
    )
    noise = NOISE * np.random.default_rng(900 + seed).standard_normal(SAMPLES)
    force = np.array([push(now) for now in t])
    return Recording(f"{size}.csv", t, {"f": force}, {"laser": run.y[0] + noise}, (), "")


def dynamic(amplitude: float, hertz: float, force: Callable[..., tuple[float, ...]]) -> complex:
    """First harmonic of a force with inner states over that of the stretch, N/m."""
    w = 2 * np.pi * hertz
    t = np.linspace(0, 6 / hertz, 1201)

    def rates(now: float, z: Array) -> list[float]:
        return list(force(amplitude * np.sin(w * now), amplitude * w * np.cos(w * now), *z)[1:])

    run = solve_ivp(rates, (0, t[-1]), np.zeros(2), "LSODA", t, rtol=1e-8, atol=1e-11)
    last = slice(-401, -1)
    x, v = amplitude * np.sin(w * t[last]), amplitude * w * np.cos(w * t[last])
    pulls = [force(a, b, *z)[0] for a, b, z in zip(x, v, run.y[:, last].T, strict=True)]
    turn = np.exp(-1j * w * t[last])
    return complex(np.mean(pulls * turn) / np.mean(x * turn))


def value(element: Element, key: str) -> float:
    return next(one.si for one in element.parameters if str(element.value(key)) == one.name)


@pytest.mark.slow
def test_a_bushing_is_found_as_a_branch_and_friction_and_is_as_stiff_as_the_true_one() -> None:
    model = pushed_model()
    diagnosis = sh.diagnose(model, [pushed(4.0, 3), pushed(1.2, 4)])
    kinds = {one.element.kind: one.element for one in diagnosis.found}
    assert set(kinds) == {"relaxation", "friction_dynamic"}
    assert len(diagnosis.found) == 2
    assert (diagnosis.parameters, diagnosis.measurement, diagnosis.classes) == ((), (), ())
    branch, rubs = kinds["relaxation"], kinds["friction_dynamic"]
    k, d = value(branch, "stiffness"), value(branch, "damping")
    level, yields = value(rubs, "coulomb"), value(rubs, "stiffness")

    def found(x: float, v: float, z: float, p: float) -> tuple[float, float, float]:
        return k * (x - z) + yields * p, (x - z) * k / d, v - yields * abs(v) * p / level

    for amplitude in (0.03, 0.1, 0.3):
        for hertz in (0.3, 0.8, 1.8):
            true, made = (dynamic(amplitude, hertz, one) + STIFFNESS for one in (hidden, found))
            assert abs(made) == pytest.approx(abs(true), rel=0.02)
            assert np.angle(made) == pytest.approx(np.angle(true), rel=0.03)
