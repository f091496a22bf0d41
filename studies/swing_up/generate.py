"""Recordings of the real machine: small motions while the pole hangs, and a larger swing as proof.

    python studies/swing_up/generate.py          # writes train.csv and holdout.csv beside this file

A controller of the drive holds the cart near a place that moves. Its force is recorded as it acts,
the two encoders have white noise of 1 % of their largest value. engine.py is the machine; symhyb
has no part in it.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from engine import Array, Machine

HERE = Path(__file__).resolve().parent
RATE, SEED, NOISE = 100.0, 7, 0.01  # Hz; of the largest value
SPRING, DAMPER, MOST = 60.0, 12.0, 8.0  # N/m, N·s/m, N: the controller of the drive


def sweep(t: float) -> float:
    """Where the cart is asked to be while the pole hangs: 8 cm, 0.3 to 1.3 Hz in 30 s, in m."""
    rate = (1.3 - 0.3) / 30.0
    return 0.08 * float(np.sin(2 * np.pi * (0.3 * t + rate * t**2 / 2)))


def steps(t: float) -> float:
    """And after the pole was let go at 1.2 rad: 10 cm to either side, 1.7 s each, in m."""
    return 0.1 * float(np.sign(np.sin(2 * np.pi * t / 3.4)))


def record(
    machine: Machine, asked: Callable[[float], float], angle: float, duration: float, seed: int
) -> Array:
    """t [s], push [N], cart [m], pole [rad] (N, 4); noise on the last two."""
    h = 1 / RATE
    t = h * np.arange(round(duration * RATE) + 1)
    states, push = [np.array([0.0, angle, 0.0, 0.0])], [0.0]
    for now in t[:-1]:
        x, _, v, _ = states[-1]
        force = float(np.clip(SPRING * (asked(now) - x) - DAMPER * v, -MOST, MOST))
        states.append(machine.advance(states[-1], (push[-1], force), h))
        push.append(force)
    shown = np.array(states)[:, :2]
    noise = np.random.default_rng(seed).standard_normal(shown.shape)
    measured = shown + NOISE * np.abs(shown).max(axis=0) * noise
    return np.column_stack([t, push, measured])


def recording(machine: Machine, name: str, seed: int = SEED) -> Array:
    """The one to learn from, ``train.csv``, or the one that proves, ``holdout.csv``."""
    if name == "train.csv":
        return record(machine, sweep, 0.0, 30.0, seed)
    return record(machine, steps, 1.2, 15.0, seed + 1000)


def write(folder: Path, seed: int = SEED) -> None:
    """Write both as CSV."""
    for name in ("train.csv", "holdout.csv"):
        rows = recording(Machine(), name, seed)
        np.savetxt(
            folder / name,
            rows,
            fmt=("%.2f", "%.6g", "%.6g", "%.6g"),
            delimiter=",",
            header="t,push,cart,pole",
            comments="",
        )


if __name__ == "__main__":
    write(HERE)
