"""What happens between a recorded input and the force that acts."""

from collections.abc import Callable

import numpy as np
from bare import Bare, log_uniform, rms, share
from numpy.random import Generator
from shared import Array
from simulate import Change


def _input(bare: Bare, sizes: Generator) -> tuple[int, str, float]:
    """Number, name and RMS of an input, by chance."""
    k = int(sizes.integers(len(bare.system.inputs)))
    return k, bare.system.inputs[k], rms(bare.u[k])


def _step(bare: Bare) -> float:
    return 1 / bare.system.rate


def _static(k: int, curve: Callable[[Array], Array]) -> Callable[[float, Array, Array], Array]:
    """The k-th input acts through a curve, the others as they are."""

    def act(t: float, u: Array, z: Array) -> Array:
        acting = np.array(u)
        acting[k] = curve(u[k])
        return acting

    return act


def dead_band(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """Nothing acts below a threshold, and the threshold is missing above it."""
    k, name, size = _input(bare, sizes)
    band = share(sizes) * size

    act = _static(k, lambda f: f - np.clip(f, -band, band))
    return Change(act=act, step=_step(bare), place=name, facts={"band": band})


def saturation(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The actuator gives no more than it can."""
    k, name, size = _input(bare, sizes)
    most = sizes.uniform(1.2, 2.0) * size

    act = _static(k, lambda f: np.clip(f, -most, most))
    return Change(act=act, step=_step(bare), place=name, facts={"most": most})


def soft_saturation(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The actuator gives less than in proportion, without a corner."""
    k, name, size = _input(bare, sizes)
    most = sizes.uniform(1.5, 3.0) * size

    act = _static(k, lambda f: most * np.tanh(f / most))
    return Change(act=act, place=name, facts={"most": most})


def uneven(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The actuator pushes more than it pulls, or less."""
    k, name, _ = _input(bare, sizes)
    more = share(sizes) * float(sizes.choice([-1.0, 1.0]))

    act = _static(k, lambda f: f + more * np.abs(f))
    return Change(act=act, step=_step(bare), place=name, facts={"more": more})


def slew(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The acting force changes no faster than it can; it follows by a lag of one sample."""
    k, name, _ = _input(bare, sizes)
    quickest = float(np.abs(np.gradient(bare.u[k], bare.t)).max())
    rate, late = sizes.uniform(0.3, 0.7) * quickest, 1 / bare.system.rate

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.clip((u[k : k + 1] - z) / late, -rate, rate)

    def act(t: float, u: Array, z: Array) -> Array:
        acting = np.array(u)
        acting[k] = z[0]
        return acting

    return Change(
        flow=flow,
        begin=lambda q, v, u: u[k : k + 1],
        act=act,
        step=_step(bare),
        place=name,
        facts={"rate": rate, "tau": late},
    )


def held(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A digital output that stays as it is for one to four samples of the recording."""
    hold = int(sizes.choice([1, 1, 2, 4]))
    seconds = hold / bare.system.rate
    return Change(hold=hold, place=bare.system.inputs[0], facts={"hold": seconds})


def noisy(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The force is measured with noise; another one, without it, acts."""
    k, name, size = _input(bare, sizes)
    sd = share(sizes) * size

    def record(random: Generator, t: Array, u: Array) -> Array:
        read = u.copy()
        read[k] += sd * random.standard_normal(t.size)
        return read

    return Change(record=record, place=name, facts={"sd": sd})


def cross_talk(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """One actuator acts a little along the other coordinate too."""
    k, name, _ = _input(bare, sizes)
    leak = share(sizes) * float(sizes.choice([-1.0, 1.0]))

    def act(t: float, u: Array, z: Array) -> Array:
        acting = np.array(u)
        acting[1 - k] += leak * u[k]
        return acting

    return Change(act=act, place=name, facts={"leak": leak})


def fading(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The actuator gets weaker along the recording."""
    k, name, _ = _input(bare, sizes)
    loss = share(sizes) / bare.system.duration

    def act(t: float, u: Array, z: Array) -> Array:
        acting = np.array(u)
        acting[k] *= 1 - loss * t
        return acting

    return Change(act=act, place=name, facts={"loss": loss})


def lag(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A first-order lag: τ·z' = u − z, and z acts."""
    k, name, _ = _input(bare, sizes)
    fast = rms(np.gradient(bare.u[k], bare.t)) / rms(bare.u[k])
    tau = log_uniform(sizes, 0.05, 0.4) / fast

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return (u[k : k + 1] - z) / tau

    def act(t: float, u: Array, z: Array) -> Array:
        acting = np.array(u)
        acting[k] = z[0]
        return acting

    return Change(
        flow=flow, begin=lambda q, v, u: u[k : k + 1], act=act, place=name, facts={"tau": tau}
    )


def resonant(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """An actuator with a resonance of its own above the band of the drive."""
    k, name, _ = _input(bare, sizes)
    w = 2 * np.pi * bare.system.drive.band[1] * sizes.uniform(1.3, 3.0)
    zeta = sizes.uniform(0.15, 0.6)

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.array([z[1], w * w * (u[k] - z[0]) - 2 * zeta * w * z[1]])

    def act(t: float, u: Array, z: Array) -> Array:
        acting = np.array(u)
        acting[k] = z[0]
        return acting

    return Change(
        flow=flow,
        begin=lambda q, v, u: np.array([u[k], 0.0]),
        act=act,
        place=name,
        facts={"frequency": w / (2 * np.pi), "zeta": zeta},
    )
