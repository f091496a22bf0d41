"""What is not explained: an unknown force at every coordinate, white and coloured sensor noise.

Sizes: n coordinates, m sensors.
"""

from dataclasses import dataclass, replace

import numpy as np

from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True, eq=False)
class NoiseModel:
    """Standard deviations, SI: of the unknown ``force`` (n,) with its correlation time
    ``memory_s``, of the ``white`` (m,) and of the ``colour`` (m,) of the sensors with its
    correlation time ``colour_s``."""

    force: Array
    memory_s: float
    white: Array
    colour: Array
    colour_s: float

    @property
    def coloured(self) -> bool:
        """Whether any sensor has coloured noise."""
        return bool(np.any(self.colour > 0))

    @property
    def numbers(self) -> int:
        """How many numbers the model has: each size that is not zero, and the times that go with
        them."""
        return (
            int(np.count_nonzero(self.force))
            + int(np.any(self.force > 0))
            + self.white.size
            + int(np.count_nonzero(self.colour))
            + int(self.coloured)
        )

    def price(self, count: int) -> float:
        """What these numbers cost in ln evidence where ``count`` values were measured, ½ ln N each
        (Schwarz 1978)."""
        return float(0.5 * self.numbers * np.log(max(count, 2)))

    def without_force(self) -> "NoiseModel":
        """The same without an unknown force."""
        return replace(self, force=np.zeros_like(self.force))

    def without_colour(self) -> "NoiseModel":
        """The same with the sensors' noise white."""
        return replace(self, colour=np.zeros_like(self.colour))
