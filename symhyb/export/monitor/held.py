"""Which machines a monitor in C can be made of."""

from collections.abc import Sequence

from symhyb.discrepancy.recorded.watching import length_gauges
from symhyb.errors import InputError, Problem
from symhyb.model.types import Input, Model, Sensor

CURE = "watch it with symhyb watch"


def require_monitored(model: Model, blind: Sequence[str] = ()) -> None:
    """Refuse what the C code does not do; ``blind`` are coordinates whose place no sensor shows.

    Raises:
        InputError: everything of the model that stands in the way, with the cure.
    """
    problems = [Problem(text, where, model.file) for where, text in _in_the_way(model)]
    for name in blind:
        text = f"no sensor shows its place, which a monitor in C needs; {CURE}"
        problems.append(Problem(text, f"coordinates.{name}", model.file))
    if problems:
        raise InputError(problems)


def _in_the_way(model: Model) -> list[tuple[str, str]]:
    """What of a model a monitor in C does not hold, by its place in the file."""
    found = []
    if model.engine is not None:
        found.append(("model", f"a model of another program has no monitor in C; {CURE}"))
    if model.constraints or length_gauges(model):
        text = f"a machine with constraints or quaternions has no monitor in C; {CURE}"
        found.append(("constraints", text))
    for coordinate in model.coordinates:
        if coordinate.imposed:
            text = f"is imposed, and a monitor in C holds free coordinates alone; {CURE}"
            found.append((f"coordinates.{coordinate.name}", text))
    found += [
        (f"states.{one.name}", f"declared states have no monitor in C; {CURE}")
        for one in model.states
    ]
    found += [
        (f"elements.{one.name}", f"a network has no monitor in C; {CURE}")
        for one in model.elements
        if one.network is not None
    ]
    for item in model.inputs:
        if item.between == "held":
            text = f"is held between its samples, which a monitor in C does not do; {CURE}"
            found.append((f"inputs.{item.name}", text))
        if any(number.si != 0 for number in item.actuator):
            found.append((f"inputs.{item.name}", f"has an actuator; {CURE}"))
    channels: tuple[tuple[str, Input | Sensor], ...] = (
        *(("inputs", one) for one in model.inputs),
        *(("sensors", one) for one in model.sensors),
    )
    for group, one in channels:
        if one.delay is not None and one.delay.si != 0:
            text = "has a delay; shift the signal before it is given, and leave the delay out"
            found.append((f"{group}.{one.name}", text))
    return found
