"""What is concealed in a case: forces, parameters off, faults of channels; and its plant."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from laws import Array, Effect
from plant import Motion, Plant, Signal, reaction
from systems import System


@dataclass(frozen=True, slots=True)
class Fault:
    """A ``gain``, ``offset`` or ``delay`` of a channel: recorded = gain·true(t − delay) + offset
    for a sensor, acting = gain·recorded(t − delay) + offset for an input; SI."""

    channel: str
    kind: str
    value: float

    @property
    def neutral(self) -> float:
        """The value of a sound channel."""
        return 1.0 if self.kind == "gain" else 0.0


@dataclass(frozen=True, slots=True)
class Hidden:
    """All that the model file does not say; ``parameters`` are the true values of those off."""

    effects: tuple[Effect, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)
    faults: tuple[Fault, ...] = ()

    def fault(self, channel: str, kind: str) -> float:
        """The gain, offset or delay of a channel."""
        known = [f.value for f in self.faults if (f.channel, f.kind) == (channel, kind)]
        return known[0] if known else float(kind == "gain")


@dataclass(frozen=True, slots=True)
class Target:
    """One concealed number: of an effect (``index``, ``key``), of a parameter or of a fault."""

    sort: str
    index: int = 0
    key: str = ""

    def value(self, hidden: Hidden) -> float:
        """Its value, SI."""
        if self.sort == "effect":
            return hidden.effects[self.index].keys[self.key]
        if self.sort == "parameter":
            return hidden.parameters[self.key]
        return hidden.faults[self.index].value

    def scale(self, hidden: Hidden, stated: Mapping[str, float]) -> float:
        """The size against which its standard deviation counts: the deviation that is concealed."""
        value = self.value(hidden)
        if self.sort == "parameter":
            return abs(value - stated[self.key])
        if self.sort == "fault":
            return abs(value - hidden.faults[self.index].neutral)
        return 1.0 if self.key == "phase" else abs(value)

    def at(self, hidden: Hidden, value: float) -> Hidden:
        """The same with another value of this number."""
        if self.sort == "parameter":
            return replace(hidden, parameters={**hidden.parameters, self.key: value})
        if self.sort == "fault":
            faults = list(hidden.faults)
            faults[self.index] = replace(faults[self.index], value=value)
            return replace(hidden, faults=tuple(faults))
        effects = list(hidden.effects)
        old = effects[self.index]
        effects[self.index] = replace(old, keys={**old.keys, self.key: value})
        return replace(hidden, effects=tuple(effects))


def targets(hidden: Hidden) -> tuple[Target, ...]:
    """Every concealed number."""
    forces = [Target("effect", i, key) for i, e in enumerate(hidden.effects) for key in e.keys]
    values = [Target("parameter", key=name) for name in hidden.parameters]
    faults = [Target("fault", i) for i in range(len(hidden.faults))]
    return (*forces, *values, *faults)


def plant_of(system: System, hidden: Hidden, signal: Signal) -> Plant:
    """The machine with what is concealed in it. One delay serves all inputs."""
    names = system.inputs or ("",)
    gain = np.array([hidden.fault(name, "gain") for name in names])
    offset = np.array([hidden.fault(name, "offset") for name in names])
    delay = max(hidden.fault(name, "delay") for name in names)
    values = {**system.values(), **hidden.parameters}
    return Plant(system, values, hidden.effects, signal, gain, offset, delay)


def channels(system: System, complete: bool) -> tuple[str, ...]:
    """The sensors of a case: positions, with complete sensing rates too; on a rig the cell."""
    if system.imposed:
        return ("cell",)
    places = tuple(f"pos_{name}" for name in system.coordinates)
    return places + tuple(f"rate_{name}" for name in system.coordinates if complete)


def seen(plant: Plant, motion: Motion, hidden: Hidden, names: tuple[str, ...]) -> Array:
    """What the sensors show (m, N), without noise and without delays."""
    rows = []
    for name in names:
        if name == "cell":
            row = reaction(plant, motion)
        else:
            kind, coordinate = name.split("_", 1)
            source = motion.q if kind == "pos" else motion.v
            row = source[plant.system.coordinates.index(coordinate)]
        rows.append(hidden.fault(name, "gain") * row + hidden.fault(name, "offset"))
    return np.array(rows)
