r"""A hydromount: the fluid of an inertia track behind the stiffness of its chamber, against SciPy
and against its dynamic stiffness in closed form.

    wall |--/\/\/--[m]--o──▶ x ──/\/\/──[m_f]──[===]──|
"""

from typing import Any

import numpy as np
import pytest
from builders import model_of
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.exact.simulation import simulate
from symhyb.laws.hydromount import LAW
from symhyb.laws.maths import NUMPY, Action, Motion
from symhyb.laws.mode import LAW as MODE
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import Block, WindowModel

Array = NDArray[np.float64]
M, K, D = 1.2, 980.0, 3.0
CHAMBER, FLUID, LOSS, SQUARE, PLAY = 600.0, 0.4, 2.5, 6.0, 0.002
PARAMETERS = {
    "m": (M, "kg"),
    "k": (K, "N/m"),
    "d": (D, "N*s/m"),
    "k_b": (CHAMBER, "N/m"),
    "m_f": (FLUID, "kg"),
    "d_f": (LOSS, "N*s/m"),
    "b_f": (SQUARE, "N*s^2/m^2"),
    "c_f": (PLAY, "m"),
}
TRACK = {"kind": "hydromount", "on": "x", "stiffness": "k_b", "mass": "m_f", "damping": "d_f"}
T = np.linspace(0, 3, 601)
PUSH = 8 * np.sin(2 * np.pi * 5 * T) + 5 * np.sin(2 * np.pi * 3.1 * T)


def mounted(**more: str) -> Model:
    return model_of(
        coordinates={"x": {"unit": "m", "start": 0.01}},
        parameters=PARAMETERS,
        inputs={"f": {"unit": "N"}},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "rubber": {"kind": "spring", "on": "x", "stiffness": "k"},
            "loss": {"kind": "damper", "on": "x", "damping": "d"},
            "shaker": {"kind": "force", "on": "x", "force": "f"},
            "track": {**TRACK, **more},
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


def by_hand(square: float, play: float) -> Array:
    """x, z (2, N) by SciPy from the equations of machine and fluid."""

    def rates(now: float, y: Array) -> list[float]:
        x, v, z, w = y
        apart = x - z
        pressed = CHAMBER * (apart - np.clip(apart, -play, play))
        push = np.interp(now, T, PUSH)
        return [
            v,
            (push - K * x - D * v - pressed) / M,
            w,
            (pressed - LOSS * w - square * abs(w) * w) / FLUID,
        ]

    begin = [0.01, 0.0, 0.01, 0.0]
    run = solve_ivp(rates, (0, 3), begin, "DOP853", T, rtol=1e-11, atol=1e-13, max_step=0.005)
    return np.asarray(run.y[[0, 2]])


@pytest.mark.parametrize(
    ("more", "square", "play"),
    [
        ({}, 0.0, 0.0),
        pytest.param({"drag": "b_f"}, SQUARE, 0.0, marks=pytest.mark.slow),
        ({"drag": "b_f", "clearance": "c_f"}, SQUARE, PLAY),
    ],
)
def test_it_moves_as_scipy_says(more: dict[str, str], square: float, play: float) -> None:
    model, true = mounted(**more), by_hand(square, play)
    scenario = Scenario(T, np.array([0.01]), np.zeros(1), T, PUSH[:, None])
    run = simulate(build(model), scenario)
    assert run.y[:, 0] == pytest.approx(true[0], abs=2e-7)
    assert run.z[:, 0] == pytest.approx(true[1], abs=2e-7)


@pytest.mark.slow
def test_the_exact_run_is_the_same() -> None:
    scenario = Scenario(T, np.array([0.01]), np.zeros(1), T, PUSH[:, None])
    run = simulate(build(mounted(drag="b_f")), scenario, exact=True)
    assert run.y[:, 0] == pytest.approx(by_hand(SQUARE, 0.0)[0], abs=2e-7)


def test_windows_follow_it_too() -> None:
    machine, true = build(mounted(drag="b_f")), by_hand(SQUARE, 0.0)
    t, u, parts = T[None, :201], PUSH[None, :201, None], np.full((1, 200), 4)
    starts = np.array([[0.01, 0.0, 0.01, 0.0]])
    block = Block(t, u, np.zeros((1, 201, 1)), parts)
    x, _ = WindowModel(machine).simulate(block, starts, machine.values)
    assert x[0, :, 0] == pytest.approx(true[0, :201], abs=1e-5 * np.ptp(true[0]))


def acts(s: float, r: float, z: float, w: float, **values: float) -> Action:
    return LAW.action(NUMPY, Motion(s, r, (z, w), 0.0), values, {})  # type: ignore[misc]


def test_it_pulls_back_what_the_fluid_does_not_follow() -> None:
    plain: dict[str, Any] = {"stiffness": CHAMBER, "mass": FLUID, "damping": LOSS}
    pulled = acts(0.02, 0.0, 0.005, 0.1, **plain)
    assert pulled.force == pytest.approx(CHAMBER * 0.015)
    speed, gain = pulled.inner
    assert speed == 0.1
    assert gain == pytest.approx((CHAMBER * 0.015 - LOSS * 0.1) / FLUID)
    assert acts(0.02, 0.0, 0.005, 0.1, **plain, clearance=0.02).force == 0
    assert acts(-0.02, 0.0, 0.005, 0.0, **plain, clearance=0.02).force == pytest.approx(
        -CHAMBER * 0.005
    )
    braked = acts(0.0, 0.0, 0.0, -2.0, **plain, drag=SQUARE).inner[1]
    assert braked == pytest.approx((LOSS * 2.0 + SQUARE * 4.0) / FLUID)


@pytest.mark.parametrize("hertz", [0.5, 4.0, 6.5, 20.0])
def test_its_dynamic_stiffness_is_that_of_an_inertia_track(hertz: float) -> None:
    """k_b (m s² + d s)/(m s² + d s + k_b): a damper far below its frequency, k_b far above."""
    s = 2j * np.pi * hertz
    z = CHAMBER / (FLUID * s**2 + LOSS * s + CHAMBER)  # of a stretch of 1
    whole = CHAMBER * (FLUID * s**2 + LOSS * s) / (FLUID * s**2 + LOSS * s + CHAMBER)
    plain = {"stiffness": CHAMBER, "mass": FLUID, "damping": LOSS}
    does = LAW.action(NUMPY, Motion(1.0, s, (z, s * z), 0.0), plain, {})  # type: ignore[misc]
    assert does.force == pytest.approx(whole)
    assert does.inner[0] == pytest.approx(s * z)
    assert does.inner[1] == pytest.approx(s**2 * z)


def test_without_losses_it_is_a_mode() -> None:
    """k m s²/(m s² + k) both ways."""
    s, still = 2j * np.pi * 3.0, {"stiffness": CHAMBER, "mass": FLUID}
    line = np.sqrt(CHAMBER / FLUID) / (2 * np.pi)
    z = CHAMBER / (FLUID * s**2 + CHAMBER)
    track = LAW.action(NUMPY, Motion(1.0, s, (z, s * z), 0.0), still, {})  # type: ignore[misc]
    riding = {"mass": FLUID, "frequency": line}
    mode = MODE.action(NUMPY, Motion(1.0, s, (1 - z, s * z), 0.0), riding, {})  # type: ignore[misc]
    assert track.force == pytest.approx(mode.force)
