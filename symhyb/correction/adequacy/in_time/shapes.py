"""How a number may run over the time, or over a channel, and how that stands in a model file.

All shapes are factors of the number. A broken line holds its end values:

    step     before, after       two points close to each other
    drift    begin, end          two points far from each other
    free     points              as many as the data ask for
    period   level + amplitude·sin(2π·frequency·t + phase)
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from symhyb.model.curves import Curve
from symhyb.model.types import Model, Parameter
from symhyb.numeric.kernels.buffers import Array
from symhyb.units import ONE, Unit, parse_unit

ShapeName = Literal["step", "drift", "period", "free"]
SECONDS, HERTZ, RADIANS = parse_unit("s"), parse_unit("1/s"), parse_unit("rad")
KEYS = ("level", "amplitude", "frequency", "phase")


@dataclass(frozen=True, slots=True)
class Shape:
    """A course of a factor, without a unit: of a broken line its ``times`` (P,) in s, or the values
    of the channel that it runs ``over``, SI, and ``values`` (P,) there; of a period ``level``,
    ``amplitude``, ``frequency`` in Hz and ``phase`` in rad, at t = 0, as its values. The ``time``
    of a step is a number to fit, too, and its ``duration`` unless that is ``held``."""

    name: ShapeName
    times: tuple[float, ...]
    values: tuple[float, ...]
    held: bool = False
    over: str = ""

    @property
    def middle(self) -> float:
        """The time of a step, s."""
        return 0.5 * (self.times[0] + self.times[-1])

    @property
    def duration(self) -> float:
        """How long a step takes, s."""
        return self.times[-1] - self.times[0]

    def at(self, t: Array) -> Array:
        """The factor (N,) at times (N,), s, or values of the channel, SI."""
        if self.name == "period":
            level, amplitude, frequency, phase = self.values
            return np.asarray(level + amplitude * np.sin(2 * np.pi * frequency * t + phase))
        return np.asarray(np.interp(t, self.times, self.values))

    def moved(self, numbers: Array) -> "Shape":
        """The same shape with other numbers (F,), as :func:`numbers_of` has them."""
        values = tuple(map(float, numbers[: len(self.values)]))
        if self.name != "step":
            return replace(self, values=values)
        middle = float(numbers[2])
        half = 0.5 * (self.duration if self.held else float(numbers[3]))
        return replace(self, values=values, times=(middle - half, middle + half))


def numbers_of(shape: Shape) -> tuple[tuple[str, float], ...]:
    """The numbers of a shape by name, SI: its values, then those of a step in time."""
    keys = KEYS if shape.name == "period" else tuple(f"at{i + 1}" for i in range(len(shape.times)))
    found = tuple(zip(keys, shape.values, strict=True))
    if shape.name != "step":
        return found
    lasts = () if shape.held else (("duration", shape.duration),)
    return (*found, ("time", shape.middle), *lasts)


def free_factor(shape: Shape, name: str) -> str:
    """The factor as an expression in its numbers, which are parameters ``<name>_<number>``."""
    if shape.name == "period":
        level, amplitude, frequency, phase = (f"{name}_{key}" for key in KEYS)
        return f"({level} + {amplitude}*sin(2*pi*{frequency}*t + {phase}))"
    parts = [f"{name}_at1"]
    for i in range(len(shape.times) - 1):
        share = (
            f"({shape.over or 't'} - {shape.times[i]!r})/{shape.times[i + 1] - shape.times[i]!r}"
        )
        if shape.name == "step":
            takes = repr(shape.duration) if shape.held else f"{name}_duration"
            share = f"((t - {name}_time)/{takes} + 0.5)"
        parts.append(f"({name}_at{i + 2} - {name}_at{i + 1})*min(max({share}, 0), 1)")
    return f"({' + '.join(parts)})"


@dataclass(frozen=True, slots=True)
class Stated:
    """A factor as a model file states it: the expression, and the parameters and curves in it."""

    factor: str
    parameters: tuple[Parameter, ...] = ()
    curves: tuple[Curve, ...] = ()


def stated(shape: Shape, model: Model, path: str, about: str = "") -> Stated:
    """A shape with constants: a curve over the time, or over a channel in its unit, or a sine of
    four parameters."""
    name = _free_name(model, path.replace(".", "_"))
    if shape.name == "period":
        units = (ONE, ONE, HERTZ, RADIANS)
        declared = tuple(
            Parameter(f"{name}_{key}", value, unit, about=about)
            for key, value, unit in zip(KEYS, shape.values, units, strict=True)
        )
        return Stated(free_factor(shape, name), declared)
    points = tuple(zip(shape.times, shape.values, strict=True))
    curve = Curve(name, points, (unit_along(shape, model), ONE), "linear", "hold", about=about)
    return Stated(f"curve({name}, {shape.over or 't'})", (), (curve,))


def unit_along(shape: Shape, model: Model) -> Unit:
    """The unit of what a broken line runs over in a model file: s, or that of its channel."""
    return model.inputs[shape.over].unit if shape.over else SECONDS


def _free_name(model: Model, name: str) -> str:
    """A name that the model does not have yet."""
    taken = {item.name for items in (model.curves, model.points, model.inputs) for item in items}
    taken |= {item.path for item in model.all_parameters()}
    taken |= {item.name for item in model.coordinates}
    found = f"{name[:40]}_course"
    while any(one == found or one.startswith(f"{found}_") for one in taken):
        found += "_"
    return found
