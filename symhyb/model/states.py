"""States of first order that a model declares: currents, filters, controllers, pressures.

i' = (u − R i − k x')/L        i goes on as its rate says; forces and sensors may contain it
"""

from dataclasses import dataclass

from symhyb.model.expression import Expression
from symhyb.units import Unit


@dataclass(frozen=True, slots=True)
class State:
    """A quantity that follows from its ``rate`` (in ``unit`` per s), an expression in positions,
    speeds, states, inputs, parameters and time; ``start`` is where simulations begin, in
    ``unit``."""

    name: str
    unit: Unit
    rate: Expression
    start: float = 0.0
    about: str = ""

    @property
    def si_start(self) -> float:
        """The start in coherent SI units."""
        return self.start * self.unit.factor
