"""Clock jitter: a sensor whose samples are not taken exactly at the times that stand beside them.

A sample that is taken δ late shows y + y'·δ, so that its noise grows with its own rate y':

    var e = a·(S + τ² y'²)          S: variance of the innovation, τ: jitter, one standard deviation

τ is that of maximum likelihood, a the scale that goes with it. It is worth a word where it is more
likely than steady noise beyond its price and its rival: noise that grows with the size of what the
sensor shows, as that of many sensors does. It names no physics and withdraws none.
"""

from dataclasses import dataclass

import numpy as np

from symhyb.correction.adequacy.channel_noise import innovations
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, tracks_of
from symhyb.judgement import CERTAIN
from symhyb.numeric.kernels.buffers import Array

GRID = np.geomspace(0.03, 30, 121)  # of the noise, that jitter makes at the largest rate


@dataclass(frozen=True, slots=True)
class Jitter:
    """A ``sensor`` and one standard deviation of the times at which it was sampled, s."""

    sensor: str
    time_s: float


def jittering(recorded: Recorded, trial: Fitted) -> tuple[Jitter, ...]:
    """The sensors whose noise is that of their clock, beside a structure that is adequate."""
    tracks, found = tracks_of(recorded, trial), []
    white = innovations(trial.fit.noise, tracks)
    outputs = [(one.linear.output[0], one.item.block.t[0]) for one in tracks]
    shown = np.concatenate([y for y, _ in outputs])
    rate = np.concatenate([np.gradient(y, t, axis=0) for y, t in outputs])
    for j, sensor in enumerate(recorded.windows.machine.model.sensors):
        seen, noise = np.isfinite(white[:, j]), float(trial.fit.noise.white[j])
        if not seen.any() or noise <= 0:
            continue
        away = shown[seen, j] - shown[seen, j].mean()
        growth, gain = growing(white[seen, j], rate[seen, j] / noise)
        rival = growing(white[seen, j], away / noise)[1]
        if gain - 0.5 * np.log(seen.sum()) > CERTAIN and gain > max(rival, 0.0) + CERTAIN:
            found.append(Jitter(sensor.name, growth))
    return tuple(found)


def growing(white: Array, signal: Array) -> tuple[float, float]:
    """By how much dimensionless residuals (N,) grow with a ``signal`` (N,), as the root of their
    variance for each of its squares (in 1/its unit, SI), and ln of how much likelier that is than
    that they do not."""
    size = float(np.abs(signal).max(initial=0.0))
    if size == 0:
        return 0.0, 0.0
    shares = (GRID[:, None] * signal / size) ** 2
    spread = 1 + shares
    scale = np.mean(white**2 / spread, axis=1)
    logs = -0.5 * (np.log(spread).sum(axis=1) + white.size * np.log(scale))
    best = int(np.argmax(logs))
    steady = -0.5 * white.size * float(np.log(np.mean(white**2)))
    return float(GRID[best] / size * np.sqrt(scale[best])), float(logs[best] - steady)
