"""The run of a machine without any change, from which the sizes of changes are drawn."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from shared import Array, System, Values

SHARES = (0.03, 0.3)  # of the drive, or of the largest known force at the place


@dataclass(frozen=True, slots=True, eq=False)
class Bare:
    """t (N,), q and v (n, N), inputs u (k, N) of the unchanged machine, and ``known`` (n,): the
    RMS of the largest known force along each coordinate."""

    system: System
    values: Values
    t: Array
    q: Array
    v: Array
    u: Array
    known: Array

    @property
    def speed(self) -> Array:
        """The middle frequency of each coordinate in rad/s (n,)."""
        return np.asarray(self.v.std(axis=1) / self.q.std(axis=1))

    @property
    def inertia(self) -> Array:
        """The mass matrix at the first sample (n, n)."""
        return np.asarray(self.system.mass(self.values, self.q[:, 0]))


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A place along the bare run: stretch s and rate w (N,), ``known`` force there (RMS)."""

    name: str
    s: Array
    w: Array
    known: float


def known_of(system: System, values: Values, q: Array, v: Array, u: Array) -> Array:
    """RMS of the largest known force along each coordinate (n,)."""
    forces = system.forces(values, q, v, u)
    return np.asarray(np.sqrt(np.mean(forces**2, axis=2)).max(axis=0))


def rms(x: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(x**2)))


def log_uniform(random: Generator, low: float, high: float) -> float:
    """A draw whose logarithm is uniform."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def share(random: Generator) -> float:
    """The size of a change, relative to the drive."""
    return log_uniform(random, *SHARES)


def draw_place(bare: Bare, random: Generator, between: bool = True) -> Place:
    """A coordinate of the machine, or a pair of points, by chance."""
    system = bare.system
    names = system.places if between else system.coordinates
    name = str(random.choice(names))
    s, direction = system.path(bare.values, bare.q, name)
    touched = np.abs(direction).max(axis=-1) > 0
    return Place(name, s, (direction * bare.v).sum(axis=0), float(bare.known[touched].max()))


def index_of(bare: Bare, place: Place) -> int:
    """The number of the coordinate of a place on one."""
    return bare.system.coordinates.index(place.name)


def lines(
    random: Generator, low: float, high: float, count: int = 40
) -> tuple[Array, Array, Array]:
    """Amplitude, frequency in rad/s and phase (count,) of a random signal with RMS 1."""
    amplitude = random.rayleigh(1.0, count)
    amplitude *= np.sqrt(2 / np.sum(amplitude**2))
    frequency = 2 * np.pi * np.sort(random.uniform(low, high, count))
    return amplitude, frequency, random.uniform(0, 2 * np.pi, count)


def wave(parts: tuple[Array, Array, Array], t: float, derivative: int = 0) -> float:
    """The signal of ``lines`` at t, or its derivative."""
    amplitude, frequency, phase = parts
    angle = frequency * t + phase + derivative * np.pi / 2
    return float(np.sum(amplitude * frequency**derivative * np.sin(angle)))
