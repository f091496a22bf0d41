"""What a sceptic asks of a correction, as values: what is left, what it is worth, what trades off.

None of it decides anything. Arrays are in coherent SI with time on axis 0.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

WITHIN = 0.99
CONFIDENCE = NormalDist().inv_cdf((1.0 + WITHIN) / 2.0)  # standard deviations that hold 99 %


def correlation_of(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """How the errors of numbers with a covariance (K, K), in any units, go together (K, K),
    dimensionless, −1 to 1; of a number without an error, or with an unknown one, 0 with all
    others."""
    spread = np.sqrt(np.diag(covariance))
    known = (spread > 0) & np.isfinite(spread)
    sizes = np.outer(spread, spread)
    both = np.outer(known, known)
    found = np.divide(covariance, sizes, out=np.zeros_like(sizes), where=both).clip(-1.0, 1.0)
    np.fill_diagonal(found, 1.0)
    return np.asarray(found)


@dataclass(frozen=True, slots=True, eq=False)
class Correlations:
    """How fitted numbers trade off: their ``names`` (F) as the corrected model file has them
    (``found_drag.b``, ``k``, ``laser.gain``) and the correlation ``matrix`` (F, F), dimensionless.
    """

    names: tuple[str, ...]
    matrix: NDArray[np.float64]

    def spread(self, moves: NDArray[np.float64]) -> NDArray[np.float64]:
        """One standard deviation (N, m) of a quantity that ``moves`` (F, N, m) by so much where
        each number is one of its deviations off; in the unit of ``moves``."""
        total = np.einsum("inm,ij,jnm->nm", moves, self.matrix, moves)
        return np.asarray(np.sqrt(np.maximum(total, 0.0)))


@dataclass(frozen=True, slots=True)
class Worth:
    """What an effect amounts to along the training recordings, as shares: ``energy`` of what all
    elements dissipate (None where it dissipates nothing), ``force`` of the largest force that any
    element exerts on the coordinate where it acts most, peak over peak."""

    energy: float | None
    force: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """What a simulation leaves of one recording, in windows with fitted initial states: ``left``
    (W, L, m) measured less simulated, SI, NaN where missing, the inputs ``driven`` (W, L, k) and
    the time between two samples, ``step`` in s."""

    left: NDArray[np.float64]
    driven: NDArray[np.float64]
    step: float


@dataclass(frozen=True, slots=True, eq=False)
class Whiteness:
    """Whether what is left of a sensor is noise: at ``lags`` (K,) in s, of which the negative ones
    come before, its ``auto`` correlation (K,) and that with each input (``cross``), dimensionless;
    ``bounds`` (K,) hold 99 % of noise, by the name of the input, of itself under "".
    """

    recording: str
    sensor: str
    lags: NDArray[np.float64]
    auto: NDArray[np.float64]
    cross: Mapping[str, NDArray[np.float64]]
    bounds: Mapping[str, NDArray[np.float64]]

    def of(self, name: str) -> NDArray[np.float64]:
        """The correlation (K,) with an input, with itself under "", dimensionless."""
        return self.cross[name] if name else self.auto

    def chosen(self, name: str = "") -> NDArray[np.bool_]:
        """The lags (K,) that count: with itself the positive ones alone."""
        return self.lags > 0 if not name else np.ones(self.lags.size, dtype=bool)

    def largest(self, name: str = "") -> float:
        """The correlation that stands out of its bound most, with its sign."""
        values, bound = self.of(name)[self.chosen(name)], self.bounds[name][self.chosen(name)]
        return float(values[np.argmax(np.abs(values) / bound)])

    def noise(self, name: str = "") -> bool:
        """Whether all lags together are what noise alone shows in 99 of 100 cases (Bonferroni)."""
        kept = self.chosen(name)
        ratio = float(np.max(np.abs(self.of(name)[kept]) / self.bounds[name][kept]))
        chance = (1.0 - WITHIN) / 2.0 / np.count_nonzero(kept)
        return ratio * CONFIDENCE <= NormalDist().inv_cdf(1.0 - chance)


@dataclass(frozen=True, slots=True)
class Without:
    """Errors of free runs, by sensor in its unit, of the corrected model less one ``element``."""

    element: str
    free_run_rmse: Mapping[str, float | None] = field(default_factory=dict)
