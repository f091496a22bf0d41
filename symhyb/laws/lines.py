"""Waves, in time and in position: where lines stand out, and amplitude and phase of a found one."""

from collections.abc import Mapping
from math import atan2, hypot

import numpy as np

from symhyb.judgement import PEAK_LEAST
from symhyb.laws.base import Key, Terms
from symhyb.laws.reach import Array, Reach

PEAKS = 2  # frequencies and periods that are tried at a place
NARROW = 1.2  # a line is refined within this factor: beyond, it is another line

PHASE = Key(
    "phase",
    0,
    0,
    0,
    "0",
    "rad; of a found one, for each recording",
    exact=True,
    symbol="phi_0",
    spoken=("1", "rad"),
)


def _amplitude_and_phase(terms: Mapping[str, float]) -> dict[str, float]:
    """a·sin + b·cos = amplitude·sin(… + phase)."""
    sine, cosine = terms["sine"], terms["cosine"]
    return {"amplitude": hypot(sine, cosine), "phase": atan2(cosine, sine)}


WAVE = Terms({"sine": "amplitude", "cosine": "phase"}, _amplitude_and_phase)


def unexplained(reach: Reach) -> Array:
    """The lacking force (N,), SI, without what smooth laws of stretch and rate would take."""
    s, r = (x / (np.std(x) or 1.0) for x in (reach.stretch - reach.stretch.mean(), reach.rate))
    columns = np.stack([np.ones_like(s), s, s**2, s**3, r, np.abs(r) * r, np.sign(r)], axis=1)
    values, *_ = np.linalg.lstsq(columns, reach.force, rcond=None)
    return np.asarray(reach.force - columns @ values)


def peaks(lines: Array, power: Array, width: int) -> tuple[float, ...]:
    """Local maxima of ``power`` (L,) that stand out of the median, at most ``PEAKS``, by their
    place in ``lines`` (L,), SI; ``width`` is how many entries apart two of them are."""
    if power.size < 8:
        return ()
    floor = float(np.median(power))
    inner = np.arange(1, power.size - 1)
    top = inner[(power[inner] > power[inner - 1]) & (power[inner] >= power[inner + 1])]
    chosen: list[int] = []
    for i in sorted(top, key=lambda i: -power[i]):
        if power[i] < PEAK_LEAST * floor or len(chosen) == PEAKS:
            break
        if all(abs(i - other) > width for other in chosen):
            chosen.append(int(i))
    return tuple(float(lines[i]) for i in chosen)
