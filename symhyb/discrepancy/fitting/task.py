"""What trajectory matching is asked and what it answers.

Sizes: F free parameters, W windows, m sensors, X states, P parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array

DECREASE = 1e-5  # of the cost, predicted: stop
ITERATIONS = 15


@dataclass(frozen=True, slots=True)
class Fit:
    """Fitted parameters and how well the windows are met.

    ``values`` (F,) SI; ``covariance`` (F, F), widened for coloured residuals; ``chi2`` of each
    window (W,) in the order of the recordings, ``count`` (W,) its samples less its initial states,
    ``held`` (W,); ``correlation`` c ≥ 1 of the fitted windows; ``starts`` the fitted initial
    states of each recording (W, X); ``prior`` the χ² of the values against what was known of them
    before. ``reason`` is empty, or says why the fit failed. ``floor`` is
    the χ² per sample by which repeated runs differ: a smaller difference proves nothing.
    """

    values: Array
    covariance: Array
    chi2: Array
    count: NDArray[np.int64]
    held: NDArray[np.bool_]
    correlation: float
    starts: tuple[Array, ...]
    reason: str = ""
    prior: float = 0.0
    floor: float = 0.0

    @property
    def train(self) -> float:
        """χ² of the windows that were fitted."""
        return float(self.chi2[~self.held].sum())

    @property
    def validation(self) -> float:
        """χ² of the windows that were held out."""
        return float(self.chi2[self.held].sum())

    @property
    def scale(self) -> float:
        """χ² per sample of the fitted windows; below 1 where the noise was measured too large, but
        never below what repeated runs differ by."""
        return max(self.train / max(float(self.count[~self.held].sum()), 1.0), self.floor, 1e-30)

    @property
    def left(self) -> float:
        """χ² of all windows."""
        return self.train + self.validation

    @property
    def samples(self) -> float:
        """How many samples the windows have."""
        return max(float(self.count.sum()), 2.0)

    @property
    def unit(self) -> float:
        """χ² of one independent sample: residual variance times its correlation."""
        return self.scale * self.correlation


@dataclass(frozen=True, slots=True)
class Task:
    """What to fit, SI: windows, noise ``sd`` (m,), bounds ``lower`` and ``upper`` (F,), priors
    ``mean`` and ``spread`` (F,; one sd, inf for none).

    With ``everything`` the held windows are fitted too. Steps end where one is predicted to lower
    the cost by less than ``decrease`` of it, or after ``iterations``; while it is far above the
    noise, of a ``rough`` task sooner.

    Where recordings have numbers of their own, ``own`` says for each of them which of the fitted
    numbers its free parameters are; ``first`` is then where all these numbers begin.
    """

    cuts: tuple[Cut, ...]
    sd: Array
    lower: Array
    upper: Array
    mean: Array
    spread: Array
    everything: bool = False
    decrease: float = DECREASE
    iterations: int = ITERATIONS
    rough: bool = False
    own: tuple[tuple[int, ...], ...] = ()
    first: Array | None = None

    def used(self, item: Cut) -> NDArray[np.bool_]:
        """Which windows (W,) of a recording determine the parameters."""
        return np.ones(len(item.start), bool) if self.everything else ~item.held

    def filled(self, which: int, p: Array, free: Sequence[int], values: Array) -> Array:
        """The parameters (P,) of one recording."""
        full = p.copy()
        full[list(free)] = values[list(self.own[which])] if self.own else values
        return full


def starts_only(cuts: Cut, sd: Array) -> Task:
    """The task for windows of one recording, noise ``sd`` (m,) in SI, in which nothing but initial
    states is to be fitted."""
    none = np.zeros(0)
    return Task((cuts,), sd, none, none, none, none)
