"""Forces that no listed law is, and forces that nobody measured."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from bare import Bare, Place, draw_place, lines, rms, share, wave
from numpy.random import Generator
from shared import Array, UnboundedError
from simulate import Change

TURN = 1e-3  # of the RMS of the rate: how narrow dry friction turns

Law = Callable[[Array | float, Array | float], Array | float]  # s, s' -> force that resists


def law_at(bare: Bare, place: Place, law: Law, size: float, step: float = 0.05) -> Change:
    """The force −A·law(s, s') at a place, A so large that its RMS along the bare run is ``size``
    of the known force there."""
    system, values = bare.system, bare.values
    amount = size * place.known / rms(np.asarray(law(place.s, place.w)))

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        s, direction = system.path(values, q, place.name)
        return -amount * np.asarray(law(s, direction @ v)) * direction

    return Change(push=push, step=step, place=place.name, facts={"amount": amount, "share": size})


def digressive(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A shock absorber: steep at first, flat when fast."""
    place = draw_place(bare, sizes)
    knee, power = sizes.uniform(0.1, 0.5) * rms(place.w), sizes.uniform(0.2, 0.5)
    return law_at(
        bare,
        place,
        lambda s, w: np.sign(w) * ((1 + np.abs(w) / knee) ** power - 1),
        share(sizes),
    )


def eddy(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """An eddy-current brake: strongest at its critical speed, weaker beyond."""
    place = draw_place(bare, sizes)
    critical = sizes.uniform(0.4, 1.0) * rms(place.w)
    change = law_at(
        bare, place, lambda s, w: 2 * (w / critical) / (1 + (w / critical) ** 2), share(sizes)
    )
    return replace(change, facts={**(change.facts or {}), "critical": critical})


def power(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A loss that grows with speed to the power of 1.5."""
    place = draw_place(bare, sizes)
    change = law_at(bare, place, lambda s, w: np.sqrt(np.abs(w)) * w, share(sizes))
    return replace(change, facts={**(change.facts or {}), "exponent": 1.5})


def guide(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A guide that is tight at one end: dry friction whose level changes along the travel."""
    place = draw_place(bare, sizes)
    middle, turn = float(np.mean(place.s)), TURN * rms(place.w)
    far = float(np.abs(place.s - middle).max())
    tilt = float(sizes.choice([-1.0, 1.0])) * sizes.uniform(0.4, 0.9)
    change = law_at(
        bare,
        place,
        lambda s, w: np.maximum(1 + tilt * (s - middle) / far, 0) * np.tanh(w / turn),
        share(sizes),
        step=1 / bare.system.rate,
    )
    known = dict(change.facts or {})
    return replace(change, facts={**known, "slope": known["amount"] * tilt / far})


def magnet(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A magnet beside the machine that pulls with 1/distance², more than twice as strong when
    near."""
    place = draw_place(bare, sizes, between=False)
    distance = sizes.uniform(1.5, 2.5) * float(np.abs(place.s).max())

    def law(s: Array | float, w: Array | float) -> Array | float:
        if np.any(np.asarray(s) > 0.95 * distance):
            raise UnboundedError("the machine hit the magnet")
        return -((1 - s / distance) ** -2)

    return law_at(bare, place, law, share(sizes))


def saturating(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A spring that gives no more than a certain force."""
    place = draw_place(bare, sizes)
    knee = sizes.uniform(0.3, 1.0) * rms(place.s)
    return law_at(bare, place, lambda s, w: np.tanh(s / knee), share(sizes))


def exponential(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A foam that stiffens exponentially in one direction."""
    place = draw_place(bare, sizes)
    knee = sizes.uniform(0.4, 1.0) * rms(place.s)
    return law_at(bare, place, lambda s, w: np.exp(s / knee) - 1, share(sizes))


def hertz(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A ball that is met beyond a clearance and pushes back with depth to the power of 1.5."""
    place = draw_place(bare, sizes)
    clearance = sizes.uniform(0.3, 1.2) * rms(place.s)
    return law_at(
        bare,
        place,
        lambda s, w: np.maximum(s - clearance, 0) ** 1.5,
        share(sizes),
        step=1 / bare.system.rate,
    )


def detent(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A notch: a spring that acts near one position alone."""
    place = draw_place(bare, sizes)
    at, width = sizes.uniform(-0.7, 0.7) * rms(place.s), sizes.uniform(0.3, 0.7) * rms(place.s)
    return law_at(
        bare,
        place,
        lambda s, w: (s - at) / width * np.exp(-(((s - at) / width) ** 2)),
        share(sizes),
    )


def brake_zone(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A viscous brake that acts near one position alone."""
    place = draw_place(bare, sizes)
    at, width = sizes.uniform(0.3, 1.2) * rms(place.s), sizes.uniform(0.2, 0.5) * rms(place.s)
    return law_at(bare, place, lambda s, w: w * np.exp(-(((s - at) / width) ** 2)), share(sizes))


def pinch(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A damper that grows with the square of the stretch."""
    place = draw_place(bare, sizes)
    return law_at(bare, place, lambda s, w: s * s * w, share(sizes))


def _timed(
    bare: Bare, place: Place, force: Callable[[float], float], size: float, step: float
) -> Change:
    """A force of time at a place; ``force`` has RMS 1."""
    system, values, amount = bare.system, bare.values, size * place.known

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return amount * force(t) * system.path(values, q, place.name)[1]

    return Change(push=push, step=step, place=place.name, facts={"rms": amount, "share": size})


def disturbance(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A random force in the band of the drive."""
    place, size = draw_place(bare, sizes, between=False), share(sizes)
    spectrum = lines(fresh, *bare.system.drive.band, count=60)
    return _timed(bare, place, lambda t: wave(spectrum, t), size, 0.05)


def rumble(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A random force that is slower than the machine."""
    place, size = draw_place(bare, sizes, between=False), share(sizes)
    spectrum = lines(fresh, 0.05, 0.2 * bare.system.drive.band[1], count=20)
    return _timed(bare, place, lambda t: wave(spectrum, t), size, 0.05)


def knocks(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A few short pushes at times of their own."""
    place, size = draw_place(bare, sizes, between=False), share(sizes)
    count, width = int(sizes.integers(4, 10)), sizes.uniform(0.03, 0.1)
    at = np.sort(fresh.uniform(0.5, bare.system.duration - 0.5, count))
    way = fresh.choice([-1.0, 1.0], count) * fresh.uniform(0.5, 1.0, count)

    def force(t: float) -> Array:
        return np.asarray(way @ np.exp(-(((t - at[:, None]) / width) ** 2)))

    whole = rms(force(bare.t))  # type: ignore[arg-type]
    return _timed(bare, place, lambda t: float(force(t).item()) / whole, size, step=width / 4)


def gust(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A push that comes, stays for a few seconds and goes."""
    place, size = draw_place(bare, sizes, between=False), share(sizes)
    T = 0.6 * bare.system.duration  # the unseen recording is as long
    begin, last = fresh.uniform(0.1, 0.4) * T, fresh.uniform(0.2, 0.4) * T
    way = float(fresh.choice([-1.0, 1.0])) * np.sqrt(bare.system.duration / last)

    def force(t: float) -> float:
        return float(way * (np.tanh((t - begin) / 0.1) - np.tanh((t - begin - last) / 0.1)) / 2)

    change = _timed(bare, place, force, size, 0.05)
    return replace(change, facts={**(change.facts or {}), "at": begin})


def moving_ground(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The wall of spring and damper moves: k·x_g + d·x_g' acts."""
    k, d = bare.values["k"], bare.values["d"]
    way = share(sizes) * float(bare.known[0]) / k
    spectrum = lines(fresh, *bare.system.drive.band)

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.array([way * (k * wave(spectrum, t) + d * wave(spectrum, t, 1))])

    return Change(push=push, place="x", facts={"rms": way})
