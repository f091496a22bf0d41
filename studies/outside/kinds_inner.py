"""What has a motion of its own, what changes with time, what couples two coordinates."""

from collections.abc import Mapping

import numpy as np
from bare import Bare, draw_place, index_of, log_uniform, share
from numpy.random import Generator
from shared import Array
from simulate import Change


def _load(bare: Bare, sizes: Generator) -> tuple[int, float, float, float]:
    """Coordinate, mass, angular frequency and damping of what hangs on a machine unseen."""
    i = index_of(bare, draw_place(bare, sizes, between=False))
    mass = sizes.uniform(0.05, 0.3) * float(bare.inertia[i, i])
    w = log_uniform(sizes, 0.5, 3.0) * float(bare.speed[i])
    return i, mass, w, log_uniform(sizes, 0.01, 0.08)


def load(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A mass on a spring that the model does not have."""
    i, mass, w, zeta = _load(bare, sizes)
    k, c = mass * w**2, 2 * zeta * mass * w
    e = np.eye(bare.system.n)[i]

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return (k * (z[0] - q[i]) + c * (z[1] - v[i])) * e

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.array([z[1], -(k * (z[0] - q[i]) + c * (z[1] - v[i])) / mass])

    return Change(
        push=push,
        flow=flow,
        begin=lambda q, v, u: np.array([q[i], v[i]]),
        place=bare.system.coordinates[i],
        facts={"mass": mass, "frequency": w / (2 * np.pi), "zeta": zeta},
    )


def link(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """Drive and sensor sit on two parts of the body with a flexible link between them."""
    i, _, _, zeta = _load(bare, sizes)
    mass = sizes.uniform(0.2, 0.5) * float(bare.inertia[i, i])
    w = log_uniform(sizes, 4.0, 10.0) * float(bare.speed[i])  # of the sensor's part alone
    k, c = mass * w**2, 2 * zeta * mass * w
    e = np.eye(bare.system.n)[i]

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return (k * (z[0] - q[i]) + c * (z[1] - v[i])) * e

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.array([z[1], -(k * (z[0] - q[i]) + c * (z[1] - v[i])) / mass])

    def show(t: Array, q: Array, z: Array) -> Array:
        read = q.copy()
        read[i] = z[0]
        return read

    return Change(
        push=push,
        flow=flow,
        begin=lambda q, v, u: np.array([q[i], v[i]]),
        mass=-mass * np.outer(e, e),
        show=show,
        place=bare.system.coordinates[i],
        facts={"mass": mass, "frequency": w / (2 * np.pi), "zeta": zeta},
    )


def loose(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A mass that lies loose in a play and knocks against both ends."""
    i, mass, _, _ = _load(bare, sizes)
    k = mass * (sizes.uniform(5.0, 10.0) * float(bare.speed[i])) ** 2
    play = sizes.uniform(0.1, 0.4) * float(bare.q[i].std())
    c = 0.3 * np.sqrt(k * mass) / play  # grows with depth, so that it never jumps
    rub = 0.05 * mass * float(bare.speed[i])
    e = np.eye(bare.system.n)[i]

    def pull(q: Array, v: Array, z: Array) -> float:
        apart, rate = z[0] - q[i], z[1] - v[i]
        deep = apart - np.clip(apart, -play, play)
        return float(k * deep + c * np.abs(deep) * rate + rub * rate)

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return pull(q, v, z) * e

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.array([z[1], -pull(q, v, z) / mass])

    return Change(
        push=push,
        flow=flow,
        begin=lambda q, v, u: np.array([q[i], v[i]]),
        step=1 / bare.system.rate,
        place=bare.system.coordinates[i],
        facts={"mass": mass, "play": play, "stiffness": k},
    )


def ground(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The wall of spring and damper is itself a mass on a spring."""
    k, d, m = (bare.values[name] for name in ("k", "d", "m"))
    stiffness = k * sizes.uniform(3.0, 10.0)
    w = log_uniform(sizes, 0.8, 4.0) * np.sqrt(k / m)
    mass = (stiffness + k) / w**2
    loss = 0.04 * mass * w

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return np.array([k * z[0] + d * z[1]])

    def flow(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        pull = k * (q[0] - z[0]) + d * (v[0] - z[1]) - stiffness * z[0] - loss * z[1]
        return np.array([z[1], pull / mass])

    return Change(
        push=push,
        flow=flow,
        begin=lambda q, v, u: np.zeros(2),
        place="x",
        facts={"mass": mass, "frequency": w / (2 * np.pi), "stiffness": stiffness},
    )


def _number(bare: Bare, sizes: Generator, stiff: bool) -> tuple[str, float]:
    """An uncertain parameter that is no inertia, by chance; its value."""
    entries = bare.system.parameters()
    names = [
        name
        for name, entry in entries.items()
        if "sd" in entry and "kg" not in entry["unit"] and not (stiff and "*s" in entry["unit"])
    ]
    name = str(sizes.choice(names))
    return name, bare.values[name]


def pulsating(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A stiffness that pulsates with time."""
    name, value = _number(bare, sizes, True)
    size, w = share(sizes), log_uniform(sizes, 0.3, 2.0) * float(bare.speed[0])
    phase = fresh.uniform(0, 2 * np.pi)

    def numbers(t: float) -> Mapping[str, float]:
        return {name: value * (1 + size * np.sin(w * t + phase))}

    return Change(numbers=numbers, place=name, facts={"share": size, "frequency": w / (2 * np.pi)})


def drifting(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A stiffness or damping that grows along each recording, by twice the share to the end."""
    name, value = _number(bare, sizes, False)
    slow = 2.0 * (3.0 if "*s" in bare.system.parameters()[name]["unit"] else 1.0)
    rate = slow * share(sizes) / bare.system.duration
    return Change(
        numbers=lambda t: {name: value * (1 + rate * t)}, place=name, facts={"rate": rate}
    )


def stepping(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A stiffness that falls at once while the machine runs."""
    name, value = _number(bare, sizes, True)
    size, at = share(sizes), fresh.uniform(0.2, 0.5) * bare.system.duration

    def numbers(t: float) -> Mapping[str, float]:
        return {name: value * (1 - size * (1 + np.tanh((t - at) / 0.03)) / 2)}

    return Change(
        numbers=numbers,
        step=0.01,
        place=name,
        facts={"share": size, "at": at, "after": value * (1 - size)},
    )


def _coupled(bare: Bare, size: float, matrix: Array, rates: bool) -> Change:
    """The force amount·matrix·q (or q'), with ``size`` of the known forces at its strongest; its
    entry on the first coordinate by the second is a fact of the seal."""
    motion = bare.v if rates else bare.q
    strong = np.sqrt(np.mean((matrix @ motion) ** 2, axis=1)) / bare.known
    amount = size / float(strong.max())

    def push(t: float, q: Array, v: Array, z: Array, u: Array) -> Array:
        return amount * matrix @ (v if rates else q)

    place = "-".join(bare.system.coordinates)
    facts = {"amount": amount, "share": size, "across": amount * float(matrix[0, 1])}
    return Change(push=push, place=place, facts=facts)


TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


def gyroscopic(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A rotor on the plate: each rate turns into a moment about the other axis."""
    way = float(sizes.choice([-1.0, 1.0]))
    return _coupled(bare, share(sizes), way * TURN, True)


def circulatory(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A seal or tool that follows: each angle turns into a moment about the other axis."""
    way = float(sizes.choice([-1.0, 1.0]))
    return _coupled(bare, share(sizes), way * TURN, False)


def skew(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """The axes of the springs are not those of the coordinates."""
    way = float(sizes.choice([-1.0, 1.0]))
    return _coupled(bare, share(sizes), way * np.abs(TURN), False)
