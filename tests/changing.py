"""The pushed mass with a stiffness that is a function of the time."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from symhyb.data.recording import Recording
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, pushing

Course = Callable[[float], float]


def one(_: float) -> float:
    return 1.0


def changing(
    seed: int,
    factor: Course = one,
    drive: Course = one,
    samples: int = 1000,
    name: str = "made.csv",
) -> Recording:
    """Position of the pushed mass: its stiffness times ``factor``, its push times ``drive``."""
    t = STEP * np.arange(samples)
    push = pushing(np.random.default_rng(seed), t)
    acting = CubicSpline(t, push)

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        force = float(acting(time)) * drive(time)
        return [v, force - STIFFNESS * factor(time) * x - DAMPING * v]

    run = solve_ivp(rates, (0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.005)
    noise = NOISE * np.random.default_rng(900 + seed).standard_normal(t.size)
    return Recording(name, t, {"f": push}, {"laser": run.y[0] + noise}, (), "")


def stepped(t: float) -> float:
    """A stiffness that falls by a tenth at 8.13 s."""
    return 1.0 if t < 8.13 else 0.9


def drifted(t: float) -> float:
    """One that grows by 15 % in 20 s."""
    return 1.0 + 0.0075 * t


def pulsed(t: float) -> float:
    """One that pulsates by a tenth at 1.3 Hz."""
    return 1.0 + 0.1 * float(np.sin(2 * np.pi * 1.3 * t + 0.4))


def staged(t: float) -> float:
    """One that is held at four levels."""
    return float(np.interp(t, [4.0, 4.2, 9.0, 9.2, 14.0, 14.2], [1.0, 0.9, 0.9, 1.06, 1.06, 0.96]))
