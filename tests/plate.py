"""A plate on two springs across each other, each direction with a push of its own."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from symhyb.data.recording import Recording
from tests.builders import damper, model_of, push, spring
from tests.pushed import NOISE, STEP, pushing

Array = NDArray[np.float64]
SAMPLES = 1000

PLATE = model_of(
    coordinates={"a": {"unit": "m", "start": 0.0}, "b": {"unit": "m", "start": 0.0}},
    parameters={"m": (1.0, "kg"), "k": (25.0, "N/m"), "l": (40.0, "N/m"), "d": (0.6, "N*s/m")},
    inputs={"f": {"unit": "N"}, "g": {"unit": "N"}},
    bodies={"plate": {"mass": "m", "at": ["a", "b"]}},
    elements={
        "first": spring("k", "a"),
        "second": spring("l", "b"),
        "slow": damper("d", "a"),
        "slower": damper("d", "b"),
        "push": push("f", "a"),
        "pull": push("g", "b"),
    },
    sensors={
        "left": {"measures": "a", "unit": "m"},
        "right": {"measures": "b", "unit": "m"},
    },
)


def plate(gyroscopic: float = 0.0, leak: float = 0.0) -> Recording:
    """A plate whose directions may act on each other by their speeds, or whose first push may act
    along the second too."""
    t, random = STEP * np.arange(SAMPLES), np.random.default_rng(31)
    pushes = np.stack([pushing(random, t), pushing(random, t)])
    push = CubicSpline(t, pushes, axis=1)

    def rates(time: float, state: Array) -> list[float]:
        a, b, u, v = state
        f, g = push(time)
        return [
            u,
            v,
            f - 25.0 * a - 0.6 * u - gyroscopic * v,
            g + leak * f - 40.0 * b - 0.6 * v + gyroscopic * u,
        ]

    run = solve_ivp(rates, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-8, atol=1e-10, max_step=STEP)
    left, right = run.y[:2] + NOISE * random.standard_normal((2, t.size))
    sensors = {"left": left, "right": right}
    return Recording("made.csv", t, {"f": pushes[0], "g": pushes[1]}, sensors, (), "")


def with_noisy_inputs(made: Recording, sizes: Sequence[float], seed: int) -> Recording:
    """The recording with white noise of these ``sizes``, N, on its inputs."""
    random = np.random.default_rng(seed)
    inputs = {
        name: values + size * random.standard_normal(values.size)
        for (name, values), size in zip(made.inputs.items(), sizes, strict=True)
    }
    return replace(made, inputs=inputs)
