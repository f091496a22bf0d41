"""Recordings of a mass whose input acts otherwise than it was recorded, by NumPy alone."""

from collections.abc import Callable

import numpy as np
from rigs import DAMPING, MASS, STIFFNESS

from symhyb.data.recording import Recording
from symhyb.numeric.kernels.buffers import Array

FINE = 10  # steps of the simulation between two samples
STEP_S = 0.005  # of the recording


def actuated(
    acts: Callable[[Array, Array], Array],
    seed: int,
    noise: float = 0.003,
    duration: float = 15.0,
    size: float = 8.0,
) -> Recording:
    """Position at 200 Hz of a mass under a multisine of ``size`` N (RMS), which ``acts`` as made of
    the command (K,) at fine times (K,), s, in the middle of steps of half a millisecond."""
    random = np.random.default_rng(seed)
    lines, phases = np.linspace(0.3, 5, 14), random.uniform(0, 2 * np.pi, 14)

    def command(t: Array) -> Array:
        waves = np.sin(2 * np.pi * np.outer(t, lines) + phases)
        return np.asarray(size * np.sqrt(2 / 14) * waves.sum(axis=1))

    h = STEP_S / FINE
    t = np.arange(round(duration / h)) * h
    middle = t + 0.5 * h
    x = _moved(acts(middle, command(middle)), h)[::FINE]
    measured = x + noise * x.std() * random.standard_normal(x.size)
    f = command(t[::FINE])
    return Recording("rig.csv", t[::FINE], {"f": f}, {"laser": measured}, (), "")


def _moved(force: Array, h: float) -> Array:
    """The position (K,), m, of the mass from rest under a ``force`` (K,) that is constant over each
    step ``h``, exactly."""
    from scipy.linalg import expm

    rates = np.zeros((3, 3))
    rates[0, 1] = 1.0
    rates[1] = -STIFFNESS / MASS, -DAMPING / MASS, 1 / MASS
    step = expm(rates * h)
    (a, b, c), (d, e, f) = step[0].tolist(), step[1].tolist()
    x = v = 0.0
    found = []
    for one in force.tolist():
        found.append(x)
        x, v = a * x + b * v + c * one, d * x + e * v + f * one
    return np.array(found)


def behind_play(width: float) -> Callable[[Array, Array], Array]:
    """A command behind a play of this width, N."""

    def acts(t: Array, command: Array) -> Array:
        y, made = float(command[0]), []
        for u in command.tolist():
            if y < u - width / 2:
                y = u - width / 2
            elif y > u + width / 2:
                y = u + width / 2
            made.append(y)
        return np.array(made)

    return acts


def in_steps(size: float) -> Callable[[Array, Array], Array]:
    """A command that a converter puts out in steps of this size, N."""
    return lambda t, command: size * np.floor(command / size + 0.5)


def slewing(rate: float) -> Callable[[Array, Array], Array]:
    """A command that is followed by no more than this rate, N/s."""

    def acts(t: Array, command: Array) -> Array:
        y, made = float(command[0]), []
        most = rate * float(t[1] - t[0])
        for u in command.tolist():
            y += min(max(u - y, -most), most)
            made.append(y)
        return np.array(made)

    return acts
