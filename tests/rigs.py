"""Recordings of small machines with concealed effects, made by SciPy alone."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.model.types import Model

MASS, STIFFNESS, DAMPING = 1.3, 200.0, 0.8
_MODEL = """
symhyb = 1
title = "mass on a spring, driven"
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = 1.3, unit = "kg" }}
k = {{ value = {stiffness}, unit = "N/m"{sd} }}
d = {{ value = 0.8, unit = "N*s/m" }}
[inputs]
f = {{ unit = "N" }}
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.damper]
kind = "damper"
on = "x"
damping = "d"
[elements.shaker]
kind = "force"
on = "x"
force = "f"
[sensors]
laser = {{ measures = "x", unit = "m" }}
"""


def spring_model(stiffness: float = STIFFNESS, sd: float | None = None) -> Model:
    """The model that knows mass, spring, damper and shaker."""
    said = "" if sd is None else f", sd = {sd}"
    return parse_model(_MODEL.format(stiffness=stiffness, sd=said), "rig.toml")


def spring_recording(
    seed: int,
    hidden: Mapping[str, float],
    *,
    noise: float = 0.01,
    duration: float = 15.0,
    gain: float = 1.0,
    name: str = "rig.csv",
) -> Recording:
    """Position only at 200 Hz under a multisine of 8 N; ``hidden`` are coefficients by term, and
    ``noise`` is relative to the standard deviation of the position."""
    random = np.random.default_rng(seed)
    t = np.arange(0, duration, 0.005)
    lines, phases = np.linspace(0.3, 5, 14), random.uniform(0, 2 * np.pi, 14)

    def force(time: float) -> float:
        return float(8 * np.sqrt(2 / 14) * np.sin(2 * np.pi * lines * time + phases).sum())

    def rate(time: float, state: NDArray[np.float64]) -> list[float]:
        x, v = state
        lost = hidden.get("coulomb", 0) * np.tanh(v / 1e-5) + hidden.get("drag", 0) * abs(v) * v
        lost += hidden.get("cubic", 0) * x**3 - hidden.get("constant", 0)
        return [v, (force(time) - STIFFNESS * x - DAMPING * v - lost) / MASS]

    run = solve_ivp(
        rate, (0, duration), [0, 0], t_eval=t, method="LSODA", rtol=1e-8, atol=1e-10, max_step=0.005
    )
    x = run.y[0]
    measured = gain * x + noise * x.std() * random.standard_normal(t.size)
    return Recording(name, t, {"f": np.array([force(s) for s in t])}, {"laser": measured}, (), "")


def made(
    seed: int,
    spring: Callable[[float, float], float],
    *,
    size: float,
    duration: float,
    control: tuple[float, float] = (0.0, 0.0),
    noise: float = 0.005,
) -> Recording:
    """The same mass on any ``spring`` (x, v) in N, under a multisine of ``size`` N; ``control`` are
    the stiffness and the damping of a controller that drives the mass besides."""
    random = np.random.default_rng(seed)
    t = np.arange(0, duration, 0.005)
    lines, phases = np.linspace(0.3, 4, 10), random.uniform(0, 2 * np.pi, 10)

    def force(time: float, x: float, v: float) -> float:
        driven = size * np.sqrt(2 / 10) * np.sin(2 * np.pi * lines * time + phases).sum()
        return float(driven - control[0] * x - control[1] * v)

    def rate(time: float, state: NDArray[np.float64]) -> list[float]:
        x, v = state
        return [v, (force(time, x, v) - spring(x, v) - DAMPING * v) / MASS]

    run = solve_ivp(rate, (0, duration), [0, 0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=0.005)
    x, v = run.y
    driven = np.array([force(*one) for one in zip(t, x, v, strict=True)])
    measured = x + noise * x.std() * random.standard_normal(t.size)
    return Recording(f"run{seed}-{size:g}.csv", t, {"f": driven}, {"laser": measured}, (), "")
