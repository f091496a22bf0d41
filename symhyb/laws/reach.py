"""What a place moves through, and which shapes of a law are worth trying there.

A law that is nonlinear in a key (a clearance, a frequency, a relaxation time) is tried at a few
values spread over what the recordings move through; the value is refined by simulation afterwards.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Shape = tuple[tuple[str, float], ...]

TRANSITION_SHARE = 1e-3  # of the largest rate; narrower, sticking makes the cost too rugged to fit
FIRST, POLYNOMIAL, LOSS, SHAPED, LOPSIDED, INERTIA, CURVED, PERIODIC = range(8)


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """What a place moves through, SI: ``stretch`` and ``rate`` (N,) of all recordings, and the
    ``force`` (N,) that the model lacks there, at times ``t`` (N,); the natural ``length`` between
    two points, None on a coordinate, how ``narrow`` friction turns, over the largest rate, the
    ``flows``: channels beside the machine that show a speed in the unit of the rate, and the linear
    ``stiffness`` of the springs that the model has there."""

    stretch: Array
    rate: Array
    force: Array
    t: Array
    length: float | None = None
    narrow: float = TRANSITION_SHARE
    flows: tuple[str, ...] = ()
    stiffness: float = 0.0

    @property
    def speed(self) -> float:
        """Largest rate (99 % of the samples are slower)."""
        return float(np.quantile(np.abs(self.rate), 0.99)) if self.rate.size else 0.0

    @property
    def amplitude(self) -> float:
        """Half of the travel."""
        return float(np.ptp(self.stretch)) / 2 if self.stretch.size else 0.0

    @property
    def slack(self) -> Shape:
        """The natural length as a key of a law, none on a coordinate."""
        return () if self.length is None else (("length", self.length),)


@dataclass(frozen=True, slots=True)
class Candidate:
    """One shape of a law that is tried at a place.

    ``terms`` are unknown coefficients in which the force is linear, ``positive`` says which of them
    physics forbids to be negative; ``shape`` are keys that are set beforehand (SI), ``refined``
    those of them that are fitted afterwards, ``tied`` those that grow with the first coefficient.
    ``options`` are words, ``own`` fitted keys that every recording has its own value of. ``bounds``
    (key, lower, upper), SI, hold at this place where those of the key are too wide. ``order`` is
    where it stands in the list of all: the simplest come first.
    """

    terms: tuple[str, ...]
    positive: tuple[bool, ...]
    shape: Shape = ()
    refined: tuple[str, ...] = ()
    tied: tuple[str, ...] = ()
    options: tuple[tuple[str, str], ...] = ()
    own: tuple[str, ...] = ()
    bounds: tuple[tuple[str, float, float], ...] = ()
    order: int = CURVED
