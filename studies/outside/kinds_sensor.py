"""What sensors make of a motion, and noise that is not white."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from bare import Bare, draw_place, index_of, log_uniform, share
from kinds_force import law_at
from numpy.random import Generator
from scipy.signal import lfilter
from shared import Array
from simulate import Change

Taint = Callable[[Generator, Array, Array, Array], Array]


def _sensor(bare: Bare, sizes: Generator) -> tuple[int, str]:
    i = index_of(bare, draw_place(bare, sizes, between=False))
    return i, f"pos_{bare.system.coordinates[i]}"


def _shown(i: int, name: str, of: Callable[[Array, Array], Array], **facts: float) -> Change:
    """Sensor i reads of(t, y) where y is its coordinate (N,)."""

    def show(t: Array, q: Array, z: Array) -> Array:
        read = q.copy()
        read[i] = of(t, q[i])
        return read

    return Change(show=show, place=name, facts=facts)


def drift(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The zero of a sensor wanders."""
    i, name = _sensor(bare, sizes)
    size = share(sizes) * float(bare.q[i].std())
    ramp, phase = fresh.uniform(-2.0, 2.0), fresh.uniform(0, 2 * np.pi)
    T = bare.system.duration
    return _shown(
        i,
        name,
        lambda t, y: y + size * (ramp * t / T + np.sin(2 * np.pi * 1.3 * t / T + phase)),
        size=size,
    )


def clips(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A sensor reads no more than its range."""
    i, name = _sensor(bare, sizes)
    most = sizes.uniform(0.5, 0.85) * float(np.abs(bare.q[i]).max())
    return _shown(i, name, lambda t, y: np.clip(y, -most, most), most=most)


def curved(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The gain of a sensor falls or grows with the square of what it reads."""
    i, name = _sensor(bare, sizes)
    bend = share(sizes) * float(sizes.choice([-1.0, 1.0]))
    far = float(np.abs(bare.q[i]).max())
    return _shown(i, name, lambda t, y: y * (1 + bend * (y / far) ** 2), bend=bend / far**2)


def gain_drifts(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The gain of a sensor changes along each recording."""
    i, name = _sensor(bare, sizes)
    rate = share(sizes) / bare.system.duration
    return _shown(i, name, lambda t, y: y * (1 + rate * t), rate=rate)


def lag(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A first-order lag of a sensor: τ·z' = q − z, and z is read."""
    i, name = _sensor(bare, sizes)
    tau = log_uniform(sizes, 0.05, 0.4) / float(bare.speed[i])

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return (q[i : i + 1] - z) / tau

    def show(t: Array, q: Array, z: Array) -> Array:
        read = q.copy()
        read[i] = z[0]
        return read

    return Change(
        flow=flow,
        begin=lambda q, v, u: q[i : i + 1],
        show=show,
        place=name,
        facts={"tau": tau},
    )


def freezes(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A sensor repeats its last value now and then."""
    i, name = _sensor(bare, sizes)
    length, every = sizes.uniform(0.05, 0.2), sizes.uniform(0.8, 2.0)
    first = fresh.uniform(0.3, 0.8)

    def frozen(t: Array, y: Array) -> Array:
        since = np.mod(t - first, every)
        stuck = np.where((since < length) & (t > first), t - since, t)
        return np.asarray(np.interp(stuck, t, y))

    return _shown(i, name, frozen, length=length, every=every)


def _colour(sizes: Generator) -> tuple[Taint, dict[str, float]]:
    keep = float(np.exp(-1 / sizes.uniform(2, 15)))

    def taint(random: Generator, t: Array, y: Array, sd: Array) -> Array:
        white = random.standard_normal((y.shape[0], t.size + 200))
        noise = lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], white, axis=1)[:, 200:]
        return np.asarray(y + sd[:, None] * noise)

    return taint, {"keep": keep}


def _growth(sizes: Generator) -> tuple[Taint, dict[str, float]]:
    times = sizes.uniform(3.0, 8.0)

    def taint(random: Generator, t: Array, y: Array, sd: Array) -> Array:
        grown = np.exp(np.log(times) * (t / t[-1] - 0.5))
        return y + sd[:, None] * grown * random.standard_normal(y.shape)

    return taint, {"times": times}


def _steps(sizes: Generator) -> tuple[Taint, dict[str, float]]:
    white = sizes.uniform(0.1, 0.5)  # the rest is rounding, an error of step/sqrt(12)

    def taint(random: Generator, t: Array, y: Array, sd: Array) -> Array:
        step = np.sqrt(12 * (1 - white**2)) * sd[:, None]
        return np.asarray(
            step * np.round((y + white * sd[:, None] * random.standard_normal(y.shape)) / step)
        )

    return taint, {"white": white}


def _tails(sizes: Generator) -> tuple[Taint, dict[str, float]]:
    freedom = sizes.uniform(2.5, 4.0)

    def taint(random: Generator, t: Array, y: Array, sd: Array) -> Array:
        noise = random.standard_t(freedom, y.shape) * np.sqrt((freedom - 2) / freedom)
        return np.asarray(y + sd[:, None] * noise)

    return taint, {"freedom": freedom}


def coloured(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """Noise with a correlation time of 2 to 15 samples, and nothing else."""
    taint, facts = _colour(sizes)
    return Change(taint=taint, facts=facts)


def growing(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """Noise that grows three- to eightfold along a recording, and nothing else."""
    taint, facts = _growth(sizes)
    return Change(taint=taint, facts=facts)


def quantised(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """Noise that is mostly rounding, and nothing else."""
    taint, facts = _steps(sizes)
    return Change(taint=taint, facts=facts)


def heavy(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """Noise with heavy tails, and nothing else."""
    taint, facts = _tails(sizes)
    return Change(taint=taint, facts=facts)


def _listed(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A drag or a cubic spring: a law of the vocabulary."""
    place = draw_place(bare, sizes)
    size = share(sizes)
    kind, key = "spring", "cubic"
    if "c" in bare.values or sizes.random() < 0.5:  # a cubic stiffness that is there is a number
        kind = key = "drag"
    law = (lambda s, w: np.abs(w) * w) if kind == "drag" else (lambda s, w: s**3)
    change = law_at(bare, place, law, size)
    return replace(change, law=(kind, place.name, key, (change.facts or {})["amount"]))


def law_coloured(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A listed law under coloured noise."""
    taint, facts = _colour(sizes)
    return replace(_listed(bare, sizes, fresh), taint=taint, facts=facts)


def law_growing(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A listed law under growing noise."""
    taint, facts = _growth(sizes)
    return replace(_listed(bare, sizes, fresh), taint=taint, facts=facts)


def law_quantised(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A listed law under rounding."""
    taint, facts = _steps(sizes)
    return replace(_listed(bare, sizes, fresh), taint=taint, facts=facts)


def law_heavy(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A listed law under noise with heavy tails."""
    taint, facts = _tails(sizes)
    return replace(_listed(bare, sizes, fresh), taint=taint, facts=facts)
