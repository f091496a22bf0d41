"""Which kinds are concealed where, and how their numbers are drawn from what the place does.

The strength of a force follows from its ``share``: RMS of the concealed force over the largest RMS
of a known force at that place, along the motion without it. What is nonlinear in a number (a
clearance, a Stribeck speed) is drawn relative to the motion of the place.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from hidden import Fault, Hidden
from laws import Array, Effect, drift, force
from plant import Motion, Plant
from systems import System

FORCES = (
    "spring.stiffness",
    "spring.quadratic",
    "spring.cubic",
    "damper",
    "damper.asymmetry",
    "drag",
    "friction",
    "friction.stribeck",
    "gap.upper",
    "gap.lower",
    "gap.both",
    "hysteresis",
    "friction_dynamic",
    "relaxation",
    "constant",
    "harmonic",
    "ripple",
    "added_mass",
)
DULL = (
    "parameter",
    "gain.input",
    "gain.sensor",
    "offset.input",
    "offset.sensor",
    "delay.input",
    "delay.sensor",
)
NULLS = ("null.white", "null.coloured")
ON_ONLY = ("ripple", "added_mass", "harmonic")
STRENGTH = {
    "spring.stiffness": "stiffness",
    "spring.quadratic": "quadratic",
    "spring.cubic": "cubic",
    "drag": "drag",
    "constant": "constant",
    "harmonic": "amplitude",
    "ripple": "amplitude",
    "added_mass": "mass",
}


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """What a place does in a motion: stretch, rate, s'' (N,), times, and the ``known`` force N."""

    name: str
    s: Array
    r: Array
    a: Array
    t: Array
    known: float

    @property
    def amplitude(self) -> float:
        """Half of the travel."""
        return float(np.ptp(self.s)) / 2

    @property
    def pace(self) -> float:
        """A typical angular frequency, rad/s."""
        return float(np.sqrt(np.mean(self.r**2)) / max(np.std(self.s), 1e-12))


def place_of(plant: Plant, motion: Motion, inputs: Array, name: str) -> Place:
    """A place along a motion."""
    p, system = plant.values, plant.system
    s, J = system.path(p, motion.q, name)
    r = np.einsum("in,in->n", J, motion.v)
    acting = plant.gain[:, None] * inputs + plant.offset[:, None]
    Q = system.forces(p, motion.q, motion.v, acting)
    across = np.einsum("in,kin->kn", J, Q) / np.einsum("in,in->n", J, J)
    known = float(np.sqrt(np.mean(across**2, axis=1)).max())
    if system.imposed:
        known = max(known, float(np.sqrt(np.mean((p["m"] * motion.a[0]) ** 2))))
    return Place(name, s, r, np.gradient(r, motion.t), motion.t, known)


def sensible(kind: str, system: System) -> tuple[str, ...]:
    """The places where a kind may be concealed."""
    if kind.startswith(ON_ONLY):
        return system.coordinates
    return system.places


def draw_effect(kind: str, place: Place, share: float, random: np.random.Generator) -> Effect:
    """One concealed force of that share of the known one."""
    shape = _shape(kind, place, random)
    name, _, side = kind.partition(".")
    words = {"side": side} if name == "gap" else {}
    wanted = share * place.known
    if name in ("friction", "friction_dynamic"):
        keys = {"coulomb": wanted}
        if side == "stribeck":
            keys |= {"static": wanted * random.uniform(1.3, 1.9), **shape}
        if name == "friction_dynamic":
            keys["stiffness"] = wanted / shape["slip"]
        return Effect(name, place.name, keys)
    if name == "relaxation":
        unit = Effect(name, place.name, {"stiffness": 1.0, "damping": shape["time"]})
        strength = wanted / _rms(unit, place)
        return Effect(
            name,
            place.name,
            {
                "stiffness": strength,
                "damping": strength * shape["time"],
            },
        )
    key = STRENGTH.get(kind, "damping" if name == "damper" else "stiffness")
    unit = Effect(name, place.name, {key: 1.0, **shape}, **words)
    sign = 1.0
    if kind in ("spring.quadratic", "spring.cubic", "constant") and random.random() < 0.4:
        sign = -1.0
    size = _rms(unit, place)
    return Effect(name, place.name, {key: sign * wanted / max(size, 1e-12), **shape}, **words)


def _shape(kind: str, place: Place, random: np.random.Generator) -> dict[str, float]:
    speed, amplitude = float(np.sqrt(np.mean(place.r**2))), place.amplitude
    match kind:
        case "friction.stribeck":
            return {"stribeck": speed * random.uniform(0.08, 0.4)}
        case "damper.asymmetry":
            return {"asymmetry": random.choice([-1.0, 1.0]) * random.uniform(0.3, 0.8)}
        case "gap.upper" | "gap.lower" | "gap.both":
            side = kind.split(".")[1]
            travel = {"upper": place.s, "lower": -place.s, "both": np.abs(place.s)}[side]
            inside = travel[travel > 0]
            if inside.size < 20:
                return {"clearance": amplitude}
            return {"clearance": float(np.quantile(inside, random.uniform(0.45, 0.8)))}
        case "hysteresis":
            turn = 1 / (amplitude * random.uniform(0.08, 0.4))
            beta = turn * random.uniform(0.5, 0.9)
            return {"beta": beta, "gamma": turn - beta}
        case "friction_dynamic":
            return {"slip": amplitude * random.uniform(0.015, 0.08)}
        case "relaxation":
            return {"time": random.uniform(0.2, 3.0) / place.pace}
        case "harmonic":
            frequency = place.pace / (2 * np.pi) * random.uniform(0.4, 2.5)
            return {"frequency": frequency, "phase": random.uniform(-np.pi, np.pi)}
        case "ripple":
            period = amplitude * random.uniform(0.25, 0.9)
            return {"period": period, "phase": random.uniform(-np.pi, np.pi)}
    return {}


def _rms(effect: Effect, place: Place) -> float:
    """RMS of F along the motion; an inner state is stepped from sample to sample."""
    if effect.kind == "added_mass":
        return effect.keys["mass"] * float(np.sqrt(np.mean(place.a**2)))
    return float(np.sqrt(np.mean(along(effect, place) ** 2)))


def along(effect: Effect, place: Place) -> Array:
    """F (N,) along a motion, coarsely: good enough for a size."""
    z = np.zeros(place.s.size)
    if effect.remembers:
        parts, value = 8, 0.0
        for i in range(1, z.size):
            h = (place.t[i] - place.t[i - 1]) / parts
            for part in range(parts):
                w = part / parts
                s = (1 - w) * place.s[i - 1] + w * place.s[i]
                r = (1 - w) * place.r[i - 1] + w * place.r[i]
                value += h * float(drift(effect, s, r, value))
            z[i] = value
    return np.asarray(force(effect, place.s, place.r, z, place.t, np.sign(place.r)))


def draw_dull(
    kind: str,
    system: System,
    sizes: dict[str, float],
    names: tuple[str, ...],
    random: np.random.Generator,
) -> Hidden:
    """One dull cause; ``sizes`` are the standard deviations of the channels.

    Raises:
        LookupError: the system has no such channel or parameter.
    """
    if kind == "parameter":
        able = [(k, e) for k, e in system.parameters().items() if "sd" in e]
        if not able:
            raise LookupError(f"{system.name} has no parameter with sd")
        name, entry = able[random.integers(len(able))]
        off: Any = random.choice([-1.0, 1.0]) * random.uniform(0.7, 2.0)
        return Hidden(parameters={name: entry["value"] + off * entry["sd"]})
    what, _, where = kind.partition(".")
    channels = system.inputs if where == "input" else names
    if not channels:
        raise LookupError(f"{system.name} has no input")
    if (what, where) == ("delay", "input") and (system.drive.closed or len(channels) > 1):
        raise LookupError("one delay serves all inputs, and none in a closed loop")
    channel = str(channels[random.integers(len(channels))])
    side = random.choice([-1.0, 1.0])
    if what == "gain":
        return Hidden(faults=(Fault(channel, what, 1 + side * random.uniform(0.03, 0.2)),))
    if what == "offset":
        value = side * random.uniform(0.05, 0.4) * sizes[channel]
        return Hidden(faults=(Fault(channel, what, float(value)),))
    return Hidden(faults=(Fault(channel, what, random.uniform(2.0, 7.0) / system.rate),))
