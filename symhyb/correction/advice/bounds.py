"""What a manoeuvre may ask of a machine: what it did in the recordings, or what its file permits.

A coordinate stays within the travel, the speed and the acceleration that it had in the recordings,
an input within what `offers` asks of it; limits that the model file states take their place.
Sizes: n coordinates, k inputs, N samples.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from symhyb.correction.advice.offers import resting
from symhyb.correction.search.preparing import Prepared
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.model.limits import Limit
from symhyb.model.types import Coordinate, Input
from symhyb.numeric.kernels.buffers import Array

DUST = 1e-9  # SI: a coordinate that was never seen to move does not move if it moves less


@dataclass(frozen=True, slots=True)
class Bound:
    """What one coordinate or input may do, SI: values from ``low`` to ``high``, counted from the
    ``level`` at which it rests, and sizes of its ``rate`` and ``acceleration``."""

    name: str
    level: float
    low: float
    high: float
    rate: float
    acceleration: float
    words: tuple[str, str] = ("travel", "speed")

    def excess(self, values: Array, rates: Array, pulls: Array) -> Iterator[tuple[float, str]]:
        """How many times too far and too fast a motion goes (values, rates and accelerations, (N,)
        each, SI), and what that exceeds."""
        away = values - self.level
        with np.errstate(invalid="ignore", over="ignore"):
            over = np.max(away / max(self.high - self.level, DUST), initial=0.0)
            under = np.max(-away / max(self.level - self.low, DUST), initial=0.0)
            yield float(np.maximum(over, under)), f"the {self.words[0]} of {self.name}"
            fast = np.abs(rates).max(initial=0.0) / max(self.rate, DUST)
            yield float(fast), f"the {self.words[1]} of {self.name}"
            pull = np.abs(pulls).max(initial=0.0) / max(self.acceleration, DUST)
            yield float(pull), f"the acceleration of {self.name}"


@dataclass(frozen=True, slots=True)
class Bounds:
    """The bounds of all coordinates (n) and inputs (k); ``stated`` are the names of those for which
    the model file states how far they may go."""

    coordinates: tuple[Bound, ...]
    inputs: tuple[Bound, ...]
    stated: tuple[str, ...]

    def excess(self, recording: Recording, motion: Motion) -> tuple[float, str]:
        """How many times too much of anything a manoeuvre asks, inf where it was not computed to
        the end, and of what."""
        if not all(np.isfinite(part).all() for part in (motion.q, motion.v, motion.a)):
            return np.inf, "what the model can be simulated for"
        found: list[tuple[float, str]] = []
        for i, bound in enumerate(self.coordinates):
            found += bound.excess(motion.q[:, i], motion.v[:, i], motion.a[:, i])
        for bound in self.inputs:
            signal = recording.inputs[bound.name]
            rate = np.diff(signal) / np.diff(recording.t)
            found += bound.excess(signal, rate, np.zeros(1))
        return max(found, default=(0.0, ""))


def bounds_of(prepared: Prepared) -> Bounds:
    """What the model file permits, else what was recorded."""
    model = prepared.model
    limits = {limit.name: limit for limit in model.limits}
    moved = [(run.motion.q, run.motion.v, run.motion.a) for run in prepared.runs]
    q, v, a = (np.concatenate(parts) for parts in zip(*moved, strict=True))
    coordinates = tuple(
        _bound(
            item,
            limits.get(item.name),
            float(np.median(q[:, i])),
            (float(q[:, i].min()), float(q[:, i].max())),
            (float(np.abs(v[:, i]).max()), float(np.abs(a[:, i]).max())),
        )
        for i, item in enumerate(model.coordinates)
    )
    free = (-np.inf, np.inf), (np.inf, np.inf)
    inputs = tuple(
        _bound(item, limits.get(item.name), resting(prepared, item.name), *free)
        for item in model.inputs
    )
    stated = tuple(limit.name for limit in model.limits if limit.between is not None)
    return Bounds(coordinates, inputs, stated)


def _bound(
    item: Coordinate | Input,
    limit: Limit | None,
    level: float,
    between: tuple[float, float],
    sizes: tuple[float, float],
) -> Bound:
    """The limits of the file where it states them, else what was recorded, all SI."""
    low, high, rate, pull = *between, *sizes
    if limit is not None:
        factor = limit.unit.factor
        low, high = (side * factor for side in limit.between) if limit.between else (low, high)
        rate = rate if limit.rate is None else limit.rate * factor
        pull = pull if limit.acceleration is None else limit.acceleration * factor
    words = ("travel", "speed") if isinstance(item, Coordinate) else ("range", "rate")
    return Bound(item.name, level, low, high, rate, pull, words)
