"""What a program that has the equations of a machine is asked along a motion, and what it says.

Sizes: N samples, n coordinates, k inputs, P parameters, S sets of them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.table import Column, Table

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

    @classmethod
    def of(cls, arrays: Mapping[str, Array]) -> "Question":
        """The question out of arrays, (N, n) and so on as its fields, SI, by their names."""
        return cls(*(arrays[one.name] for one in fields(cls)))

    @property
    def arrays(self) -> dict[str, Array]:
        """Its fields by name, (N, n) and so on, SI."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

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

    def table(self, file: str) -> Table:
        """Its fields as columns, by which a process apart hands them over."""
        columns = (Column(one.name, getattr(self, one.name)) for one in fields(self))
        return Table(file, tuple(columns))
