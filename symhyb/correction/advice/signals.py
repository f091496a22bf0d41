"""Signals that a person can drive a machine with: sines, sweeps, steps, slow triangles.

docs/output.md states them for programs that play them; all begin at their offset.
"""

import numpy as np

from symhyb.discrepancy.results import Manoeuvre
from symhyb.numeric.kernels.buffers import Array

LINES = 8  # of a multisine
SMOOTH = ("sine", "sweep", "multisine")  # may be imposed on a coordinate: speeds do not jump


def signal_of(plan: Manoeuvre, t: Array) -> Array:
    """The signal (N,) of a manoeuvre at times ``t`` (N,) in s from its start, in its unit.

    sine       A sin(2π f t)
    sweep      A sin(2π f₁ T/ln(f₂/f₁) ((f₂/f₁)^(t/T) − 1))       T: duration
    multisine  8 lines evenly from f₁ to f₂, phases −π k(k−1)/8 + π/2 (Schroeder), peak A
    steps      A, 0, −A, 0, each for a quarter of a period
    triangle   straight from 0 to A to −A and back
    release    0: the machine is let go
    """
    lo, hi = plan.frequency or (0.0, 0.0)
    turn = 2 * np.pi * lo * t
    match plan.signal:
        case "sine":
            wave = np.sin(turn)
        case "sweep":
            pace = np.log(hi / lo)
            wave = np.sin(
                2 * np.pi * lo * plan.duration / pace * np.expm1(pace * t / plan.duration)
            )
        case "multisine":
            k = np.arange(1, LINES + 1)[:, None]
            lines = lo + (k - 1) * (hi - lo) / (LINES - 1)
            wave = np.sin(2 * np.pi * lines * t - np.pi * k * (k - 1) / LINES).sum(axis=0)
            wave = wave / np.abs(wave).max()
        case "steps":
            wave = np.array([1.0, 0.0, -1.0, 0.0])[np.floor(4 * lo * t + 1e-9).astype(int) % 4]
        case "triangle":
            wave = 2 / np.pi * np.arcsin(np.sin(turn))
        case "release":
            wave = np.zeros_like(t)
    return np.asarray(plan.offset * (plan.signal != "release") + plan.amplitude * wave)
