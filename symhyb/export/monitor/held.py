"""Which machines a monitor in C can be made of."""

from symhyb.discrepancy.recorded.watching import length_gauges
from symhyb.errors import InputError, Problem
from symhyb.model.types import Input, Model, Sensor
from symhyb.monitoring.begun import Begun

CURE = "watch it with symhyb watch"


def require_monitored(begun: Begun) -> None:
    """Refuse what the C code does not do.

    Raises:
        InputError: everything of the model that stands in the way, with the cure.
    """
    prepared = begun.gauge.prepared
    model, machine = prepared.model, prepared.machine
    problems = [Problem(text, where, model.file) for where, text in _in_the_way(model)]
    if machine.constraints or length_gauges(model):
        text = f"a machine with constraints or quaternions has no monitor in C; {CURE}"
        problems.append(Problem(text, "constraints", model.file))
    for name in prepared.runs[0].motion.blind:
        text = f"no sensor shows its place, which a monitor in C needs; {CURE}"
        problems.append(Problem(text, f"coordinates.{name}", model.file))
    if problems:
        raise InputError(problems)


def _in_the_way(model: Model) -> list[tuple[str, str]]:
    """What of a model a monitor in C does not hold, by its place in the file."""
    found = []
    if model.local is not None or any(item.local for item in model.inputs):
        found.append(("model", f"a model of another program has no monitor in C; {CURE}"))
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
