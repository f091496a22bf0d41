"""The recorded excitation: a rotor with an unbalance runs up and down on a floor that shakes.

    python studies/machine_mount/generate.py           # writes excitation.csv beside this file

Two recordings of a plausible rig, brought onto one clock: the vertical force that the machine
applies to a rigid table when it is bolted to it (its blocked force), and the acceleration of the
floor in the hall where it is to stand. NumPy alone; the seed is fixed.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).resolve().parent
Array = NDArray[np.float64]

RATE, DURATION, SEED = 400.0, 24.0, 20261122  # Hz, s
UNBALANCE = 0.02  # kg·m
SPEED, RISE, FALL, OFF = 25.0, 6.0, 8.0, 14.0  # Hz reached, s to rise, s to fall, s when it begins
BLOWS = ((9.5, 3.0, 0.6), (19.0, 8.0, 0.9))  # a crane that brakes, a press: s, Hz, m/s²
LASTING = 0.35  # s, of a blow
MURMUR, BAND = 0.03, (3.0, 40.0)  # of the hall: m/s² RMS, Hz
NOISE = {"floor": 2e-3, "force": 1.0}  # standard deviations: m/s², N


def rotor(t: Array) -> tuple[Array, Array, Array]:
    """Angle in rad, speed in rad/s and its rate of the rotor (N,): it rises, stays and falls."""
    full = 2 * np.pi * SPEED
    angle, speed, rate = np.zeros((3, t.size))
    for begin, lasts, way in ((0.0, RISE, 1.0), (OFF, FALL, -1.0)):
        s = np.clip((t - begin) / lasts, 0.0, 1.0)  # 3s² − 2s³ is level at both ends
        beyond = np.maximum(t - begin - lasts, 0.0)
        angle += way * full * (lasts * (s**3 - s**4 / 2) + beyond)
        speed += way * full * (3 * s**2 - 2 * s**3)
        rate += way * full * (6 * s - 6 * s**2) / lasts
    return angle, speed, rate


def blocked_force(t: Array) -> Array:
    """The vertical force in N (N,) of the unbalance: −d²/dt² of me sin(angle)."""
    angle, speed, rate = rotor(t)
    return np.asarray(UNBALANCE * (speed**2 * np.sin(angle) - rate * np.cos(angle)))


def floor(t: Array, rng: np.random.Generator) -> Array:
    """The acceleration in m/s² (N,) of the floor: a murmur of many lines, and two blows."""
    lines = np.arange(BAND[0], BAND[1], 1 / (2 * DURATION))
    size = 1 / lines  # falls with frequency
    size *= MURMUR / np.sqrt(np.sum(size**2) / 2)
    phase = rng.uniform(0, 2 * np.pi, lines.size)
    a = size @ np.sin(2 * np.pi * lines[:, None] * t + phase[:, None])
    for middle, frequency, peak in BLOWS:
        s = t - middle
        a += peak * np.exp(-((s / LASTING) ** 2)) * np.sin(2 * np.pi * frequency * s)
    return np.asarray(a)


def recorded(seed: int = SEED) -> Array:
    """t [s], floor [m/s²], force [N] as (N, 3), with the noise of both sensors."""
    t = np.arange(round(DURATION * RATE) + 1) / RATE
    rng = np.random.default_rng(seed)
    clean = {"floor": floor(t, rng), "force": blocked_force(t)}
    noisy = [clean[key] + sd * rng.standard_normal(t.size) for key, sd in NOISE.items()]
    return np.column_stack([t, *noisy])


def main() -> None:
    """Write the recording."""
    np.savetxt(
        HERE / "excitation.csv",
        recorded(),
        fmt=("%.4f", "%.4f", "%.2f"),
        delimiter=",",
        header="t,floor,force",
        comments="",
    )


if __name__ == "__main__":
    main()
