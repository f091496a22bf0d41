"""What a program that has the equations of a machine is asked along a motion, and what it says.

Sizes: N samples, n coordinates, k inputs, P parameters, S sets of them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Question:
    """A motion to ask about, SI: ``q``, ``v``, ``a`` (N, n) and the inputs ``u`` (N, k) at ``t``
    (N,); ``steps`` (2n + k,) of q, v and u and ``pulls`` (n,) of a for differences, and sets of
    ``values`` (S, P) of the parameters."""

    t: Array
    q: Array
    v: Array
    a: Array
    u: Array
    steps: Array
    pulls: Array
    values: Array

    @property
    def calls(self) -> int:
        """How often the program has to answer, at most."""
        n = self.q.shape[1]
        return int(self.t.size) * len(self.values) * (1 + 2 * int(n) + 2 * int(self.steps.size))


@dataclass(frozen=True, slots=True)
class Answer:
    """What a program says, SI: ``mass`` M (S, N, n, n), the ``force`` M·a_free (S, N, n), and the
    slopes M·∂a/∂(q, v, u) (S, N, n, 2n + k) at the measured acceleration."""

    mass: Array
    force: Array
    slopes: Array
