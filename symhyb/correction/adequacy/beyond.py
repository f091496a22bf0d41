"""What acts beyond the named causes: the unknown force that the likelihood asks for.

Two noise models are held against each other for the same structure: sensors alone, white or
coloured, and an unknown force beside them. The ratio of their likelihoods says whether anything
acts; the smoothed force says where, when and how much.
Sizes: n coordinates, N samples.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, tracks_of
from symhyb.discrepancy.likelihood.horizon import maximised
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import smoothed, still
from symhyb.judgement import CERTAIN, NEGLIGIBLE
from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True, eq=False)
class Beyond:
    """The unknown force (RMS, ``force`` (n,), SI), its ``share`` (n,) of what moves the coordinate,
    its correlation time, and ``evidence``: ln of the odds against sensors ``alone``, of which this
    is the likeliest noise."""

    force: Array
    share: Array
    memory_s: float
    evidence: float
    alone: NoiseModel | None = None

    @property
    def acts(self) -> bool:
        """Whether a force acts that no cause explains."""
        return self.evidence > CERTAIN and bool(np.any(self.share > NEGLIGIBLE))

    @property
    def probability(self) -> float:
        """Posterior probability that a force acts, at even odds."""
        return float(expit(self.evidence))

    def below(self, frequency: float, step_s: float) -> "Beyond":
        """The part of it below a ``frequency``, Hz, where samples are ``step_s`` s apart. Of a
        force that keeps the share α from one to the next (2/π)·atan(tan(ω/2)·(1 + α)/(1 − α)) of
        the power is below ω per sample."""
        keeps = np.exp(-step_s / self.memory_s)
        turn = np.pi * min(frequency * step_s, 0.5)  # half of ω, up to half of the rate of samples
        power = 2 / np.pi * np.arctan2((1 + keeps) * np.sin(turn), (1 - keeps) * np.cos(turn))
        return replace(self, force=np.sqrt(power) * self.force, share=np.sqrt(power) * self.share)


NOTHING = Beyond(np.zeros(0), np.zeros(0), 1.0, 0.0)


def beyond(recorded: Recorded, final: Fitted) -> Beyond:
    """The unknown force beside a fitted structure."""
    noise = final.fit.noise
    none = np.zeros_like(recorded.scale)
    if (final.extra is None and not np.any(noise.force > 0)) or final.fit.reason:
        return Beyond(none, none, noise.memory_s, 0.0)
    tracks = tracks_of(recorded, final)
    alone, without = maximised(
        tracks, recorded.revived(noise.without_force()).without_force(), recorded.sd * 1e-2
    )
    price = noise.price(final.fit.count) - alone.price(final.fit.count)
    squares = np.zeros_like(none)
    for i, one in enumerate(tracks):
        force = smoothed(one, noise, still(one)).force
        if final.extra is not None:
            more = final.extra.spread.size
            force = force + final.extra.each[i].force @ final.fit.values[-more:]
        squares += np.sum(force**2, axis=0)
    size = np.sqrt(squares / sum(len(one.residual) for one in tracks))
    share = np.where(recorded.scale > 0, size / recorded.scale_or_inf[:, 0], 0.0)
    evidence = float(final.fit.logl - without - price)
    return Beyond(size, share, noise.memory_s, evidence, alone)
