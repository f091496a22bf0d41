"""Delays of channels: that of each by itself, and one that all of a side share.

    u(t − τ_own − τ_all inputs),   y(t − τ_own − τ_all sensors)

The sensors of one logger are late together, and so are the commands of one controller: one cause
with one number. A model file states delays of single channels alone; what is shared stands in a
model while it is fitted to recordings.
"""

from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

from symhyb.model.types import Input, Model, Parameter, Sensor
from symhyb.units import parse_unit

SIDES = ("all inputs", "all sensors")  # no name of a channel: it holds a space

Channel = TypeVar("Channel", Input, Sensor)


def channels_of(model: Model) -> tuple[Input | Sensor, ...]:
    """The recorded inputs and the sensors."""
    return (*model.recorded_inputs, *model.sensors)


def delay_paths(channel: Input | Sensor) -> tuple[str, ...]:
    """The paths of the parameters whose sum is the delay of a channel."""
    both = (channel.delay, channel.shared_delay)
    return tuple(item.path for item in both if item is not None)


def delayed_by(model: Model, path: str) -> tuple[str, ...]:
    """The channels that the parameter of this path delays."""
    return tuple(item.name for item in channels_of(model) if path in delay_paths(item))


def shared_delays(model: Model) -> dict[str, tuple[str, ...]]:
    """The channels that share each delay, by the path of that."""
    shared = (channel.shared_delay for channel in channels_of(model))
    paths = dict.fromkeys(item.path for item in shared if item is not None)
    return {path: delayed_by(model, path) for path in paths}


def with_shared_delays(model: Model, recorded: Collection[str]) -> Model:
    """The model in which all inputs share a delay, or all sensors that were ``recorded``, by name,
    where a side has two channels and no other delay says the same.

    A machine whose laws do not run by the clock, and without motion that is given, answers late
    inputs by the same motion, later. So late inputs stand for late sensors, the delay of its only
    sensor is that of all inputs, and the other way around; without an input nothing shows that all
    sensors are late. Else both sides may be. A sensor that gives the motion of an imposed
    coordinate is late against none.
    """
    given = {item.name for item in model.coordinates if item.imposed}
    inputs = [item.name for item in model.recorded_inputs]
    sensors = [
        item.name
        for item in model.sensors
        if item.name in recorded and item.measures.text not in given
    ]
    apart = bool(given) or runs_by_clock(model)
    late = inputs if len(inputs) > 1 and (apart or len(sensors) > 1) else []
    shown = sensors if len(sensors) > 1 and apart else []
    return replace(
        model,
        inputs=tuple(_shared(item, late, SIDES[0]) for item in model.inputs),
        sensors=tuple(_shared(item, shown, SIDES[1]) for item in model.sensors),
    )


def runs_by_clock(model: Model) -> bool:
    """Whether a law of the model runs by the clock."""
    return any(element.kind == "harmonic" for element in model.elements)


def _shared(channel: Channel, late: Collection[str], side: str) -> Channel:
    if channel.name not in late:
        return channel
    return replace(channel, shared_delay=Parameter("delay", 0.0, parse_unit("s"), owner=side))
