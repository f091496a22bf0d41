"""States that a model declares: of first order (currents, filters, pressures), or sampled.

i' = (u − R i − k x')/L        i goes on as its rate says; forces and sensors may contain it
u(t) = next at t_k, t_k ≤ t < t_k + every       a digital controller: held in between
"""

from dataclasses import dataclass

from symhyb.model.expression import Expression, Number
from symhyb.units import Unit

STILL = Expression("0", Number(0.0))  # the rate of what is held


@dataclass(frozen=True, slots=True)
class State:
    """A quantity that follows from its ``rate`` (in ``unit`` per s), an expression in positions,
    speeds, states, inputs, parameters and time; ``start`` is where simulations begin, in ``unit``.

    One that is sampled takes the value of ``next``, an expression of the same in ``unit``, at the
    times ``first`` + k·``every``, s, k = 0, 1, …, and is held in between."""

    name: str
    unit: Unit
    rate: Expression
    start: float = 0.0
    about: str = ""
    every: float = 0.0
    first: float = 0.0
    next: Expression | None = None

    @property
    def words(self) -> str:
        """How it goes on, in one line."""
        if self.next is None:
            return f"{self.name}' = {self.rate} [{self.unit}/s]"
        return f"every {self.every:g} s {self.next} [{self.unit}]"

    @property
    def si_start(self) -> float:
        """The start in coherent SI units."""
        return self.start * self.unit.factor
