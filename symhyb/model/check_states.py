"""Check the declared states of a model: names in their rates, and units."""

from collections.abc import Iterator

from symhyb.model.scope import NEXT, RATE, Scope, expression_faults
from symhyb.model.states import State
from symhyb.model.tables import Fault
from symhyb.units import UnitError, parse_unit


def state_faults(state: State, scope: Scope) -> Iterator[Fault]:
    """Yield what is wrong with one state: its rate must be in its unit per s."""
    path = ("states", state.name)
    try:
        needed = state.unit / parse_unit("s")
    except UnitError as error:
        yield (*path, "unit"), f"has no readable rate: {error}"
        return
    yield from expression_faults((*path, "rate"), state.rate, scope, RATE, needed)
    if state.next is not None:
        yield from expression_faults((*path, "next"), state.next, scope, NEXT, state.unit)
