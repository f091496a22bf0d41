"""Recordings of a driven pendulum and of two masses for channels that lie, made by SciPy alone."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.model.types import Model
from tests.builders import damper, model_of, push, spring

Array = NDArray[np.float64]
STEP = 0.01


def multisine(random: np.random.Generator, size: float, high: float = 2.5):  # type: ignore[no-untyped-def]
    """A force of time with ten lines up to ``high`` Hz and an RMS of ``size``."""
    lines, phases = np.linspace(0.15, high, 10), random.uniform(0, 2 * np.pi, 10)

    def force(t: Array | float) -> Array:
        waves = np.sin(2 * np.pi * np.multiply.outer(np.asarray(t), lines) + phases)
        return np.asarray(size * np.sqrt(2 / 10) * waves.sum(axis=-1))

    return force


def noisy(random: np.random.Generator, values: Array, noise: float) -> Array:
    return values + noise * values.std() * random.standard_normal(values.size)


def pendulum_model(gravity: float = 9.81, gyro: bool = False) -> Model:
    """A driven pendulum: m = 0.5 kg at 0.4 m, torque input, encoder and, if asked for, a gyro."""
    sensors: dict[str, Mapping[str, object]] = {"encoder": {"measures": "phi", "unit": "rad"}}
    if gyro:
        sensors["gyro"] = {"measures": "phi'", "unit": "rad/s"}
    return model_of(
        gravity=["0", "-g"],
        coordinates={"phi": {"unit": "rad"}},
        parameters={
            "g": (gravity, "m/s^2"),
            "m": (0.5, "kg"),
            "l": (0.4, "m"),
            "d": (0.05, "N*m*s/rad"),
        },
        inputs={"motor": {"unit": "N*m"}},
        points={"bob": ["l*sin(phi)", "-l*cos(phi)"]},
        bodies={"bob": {"mass": "m", "at": "bob"}},
        elements={
            "bearing": damper("d", on="phi"),
            "drive": {"kind": "torque", "on": "phi", "torque": "motor"},
        },
        sensors=sensors,
    )


def pendulum_recording(
    seed: int,
    hidden: Mapping[str, float] | None = None,
    *,
    noise: float = 0.01,
    duration: float = 15.0,
    size: float = 1.2,
    gyro: bool = False,
) -> Recording:
    """The pendulum of :func:`pendulum_model` under a multisine; ``hidden`` are coulomb, drag and
    stiffness, SI."""
    random, lacks = np.random.default_rng(seed), hidden or {}
    torque, t = multisine(random, size), np.arange(0, duration, STEP)

    def rate(time: float, state: Array) -> list[float]:
        phi, v = state
        lost = 0.05 * v + 0.5 * 9.81 * 0.4 * np.sin(phi) + lacks.get("stiffness", 0) * phi
        lost += lacks.get("coulomb", 0) * np.tanh(v / 1e-4) + lacks.get("drag", 0) * abs(v) * v
        return [v, (float(torque(time)) - lost) / (0.5 * 0.4**2)]

    run = solve_ivp(rate, (0, duration), [0, 0], t_eval=t, method="LSODA", rtol=1e-8, atol=1e-9)
    sensors = {"encoder": noisy(random, run.y[0], noise)}
    if gyro:
        sensors["gyro"] = noisy(random, run.y[1], noise)
    return Recording("pendulum.csv", t, {"motor": torque(t)}, sensors, (), "")


def chain_model(stiffness: float = 150.0, damping: float = 0.6) -> Model:
    r"""wall o--k--[1 kg]--150 N/m--[2 kg], a force on the first; both places are measured."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={
            "k": (stiffness, "N/m"),
            "c": (150.0, "N/m"),
            "d": (damping, "N*s/m"),
            "a": (1.0, "kg"),
            "b": (2.0, "kg"),
            "gap": (1.0, "m"),
        },
        inputs={"f": {"unit": "N"}},
        points={"wall": ["-gap", "0"], "first": ["x", "0"], "second": ["gap + y", "0"]},
        bodies={"first": {"mass": "a", "at": "first"}, "second": {"mass": "b", "at": "second"}},
        elements={
            "left": spring("k", on="x"),
            "loss": damper("d", on="x"),
            "loss_y": damper("d", on="y"),
            "link": {
                "kind": "spring",
                "between": ["first", "second"],
                "stiffness": "c",
                "length": "gap",
            },
            "shaker": push("f", on="x"),
        },
        sensors={"near": {"measures": "x", "unit": "m"}, "far": {"measures": "y", "unit": "m"}},
    )


def chain_recording(
    seed: int,
    hidden: Mapping[str, float] | None = None,
    *,
    noise: float = 0.01,
    duration: float = 15.0,
) -> Recording:
    """The chain of :func:`chain_model`; ``hidden`` are coulomb, drag and stiffness on y, SI."""
    random, lacks = np.random.default_rng(seed), hidden or {}
    force, t = multisine(random, 6.0, 3.5), np.arange(0, duration, STEP)

    def rate(time: float, state: Array) -> list[float]:
        x, y, v, w = state
        link = 150.0 * (y - x)
        lost = 0.6 * w + lacks.get("coulomb", 0) * np.tanh(w / 1e-4)
        lost += lacks.get("drag", 0) * abs(w) * w + lacks.get("stiffness", 0) * y
        return [v, w, float(force(time)) - 150.0 * x - 0.6 * v + link, (-link - lost) / 2.0]

    run = solve_ivp(rate, (0, duration), 4 * [0], t_eval=t, method="LSODA", rtol=1e-8, atol=1e-9)
    sensors = {"near": noisy(random, run.y[0], noise), "far": noisy(random, run.y[1], noise)}
    return Recording("chain.csv", t, {"f": force(t)}, sensors, (), "")
