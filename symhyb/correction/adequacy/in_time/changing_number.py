"""What changes along recordings: a number of the model, or the factor of an input.

Sizes: N samples, n coordinates, G points of a fine line.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.classes.changing import slopes_of
from symhyb.correction.adequacy.classes.columns import SIZE, pushes
from symhyb.correction.adequacy.curves.products import Products, products_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.numeric.kernels.buffers import Array


@dataclass(frozen=True, slots=True, eq=False)
class Number:
    """A number of the model, an input or a sensor, by its ``path``; the generalized force (N, n),
    SI, of 1 more of its factor along every stretch (``slopes``), the change of the factor that
    makes 0.3 of what moves the coordinates (``size``), and a frequency in Hz, or NaN, at which it
    may change."""

    path: str
    is_input: bool
    slopes: tuple[Array, ...]
    size: float
    frequency: float
    is_sensor: bool = False

    @property
    def is_channel(self) -> bool:
        """Whether it is the factor of an input or of a sensor."""
        return self.is_input or self.is_sensor


@dataclass(frozen=True, slots=True, eq=False)
class TimeLine:
    """A factor as a broken line through values at the times ``x`` (G,), s, or at values of the
    channel that it runs ``over``, SI: the ``products`` of these values for every size of the
    unknown force; ``size`` is their prior deviation."""

    x: Array
    products: tuple[Products, ...]
    size: float
    over: str = ""


def number_of(ground: Recorded, generic: Generic) -> Number | None:
    """What a class says to change; None of a class of another kind, or a number that is 0."""
    path = generic.where
    if isinstance(path, str) and generic.kind == "time-varying":
        return number_at(ground, path, generic.figure)
    if isinstance(path, str) and generic.kind == "input" and generic.does == "fades":
        return input_at(ground, path)
    return None


def number_at(ground: Recorded, path: str, frequency: float = float("nan")) -> Number | None:
    """A number of the model by its path, which may change at a frequency in Hz; None where it is 0
    or moves nothing."""
    machine = ground.windows.machine
    value = float(machine.values[machine.column(path)])
    slopes = tuple(value * slope for slope in slopes_of(ground, path))
    return _number(ground, Number(path, False, slopes, 0.0, frequency))


def input_at(ground: Recorded, name: str) -> Number | None:
    """The factor of an input by its name; None where it moves nothing."""
    slopes = tuple(push * u[:, None] for u, push in pushes(ground, _which(ground, name)))
    return _number(ground, Number(name, True, slopes, 0.0, float("nan")))


def sensors_of(ground: Recorded) -> tuple[Number, ...]:
    """The factors by which the sensors may show what they measure; of a sensor that gives an
    imposed motion, none."""
    model = ground.windows.machine.model
    given = {item.name for item in model.coordinates if item.imposed}
    shown = [item.name for item in model.sensors if item.measures.text not in given]
    return tuple(Number(name, False, (), SIZE, float("nan"), is_sensor=True) for name in shown)


def _number(ground: Recorded, one: Number) -> Number | None:
    power = np.mean([np.mean(slope**2, axis=0) for slope in one.slopes], axis=0)
    share = float(np.max(np.sqrt(power) / ground.scale_or_inf[:, 0]))
    return replace(one, size=SIZE / share) if share > 0 else None


def line_through(
    ground: Recorded,
    trial: Fitted,
    number: Number,
    x: Array,
    held: Sequence[str] = (),
    over: str = "",
) -> TimeLine:
    """The fine line through these times (G,), s, or values of the channel that it runs ``over``,
    SI, around a fitted structure, of which some numbers are ``held``, by path."""
    shapes = [hats(at, x) for at in abscissae(ground, over)]
    return TimeLine(x, _products(ground, trial, number, shapes, held), number.size, over)


def abscissae(ground: Recorded, over: str) -> tuple[Array, ...]:
    """The times (N,), s, of every stretch, or what the channel that a course runs ``over`` shows
    there, SI."""
    if not over:
        return tuple(item.block.t[0] for item in ground.items)
    return tuple(u for u, _ in pushes(ground, _which(ground, over)))


def channels(ground: Recorded) -> tuple[str, ...]:
    """The inputs that move nothing, and change: what was recorded beside the machine, as a
    temperature."""
    model = ground.windows.machine.model
    inputs = [item.name for item in model.recorded_inputs]
    given = {item.name for item in model.coordinates if item.imposed}
    beside = [name for name in inputs if name not in given and input_at(ground, name) is None]
    return tuple(name for name in beside if any(np.ptp(at) > 0 for at in abscissae(ground, name)))


def _which(ground: Recorded, name: str) -> int:
    return [item.name for item in ground.windows.machine.model.inputs].index(name)


def beyond(line: TimeLine, factors: Array) -> TimeLine:
    """A line around a structure in which the number has these factors (G,), without a unit,
    already, for the whole factor: without them is left what the structure leaves, and what they
    did."""
    size = factors.size + 1
    whole = np.eye(size)
    whole[:-1, -1] = 1 - factors
    products = tuple((whole.T @ gram @ whole, likely) for gram, likely in line.products)
    return replace(line, products=products)


def _products(
    ground: Recorded,
    trial: Fitted,
    number: Number,
    shapes: Sequence[Array],
    held: Sequence[str] = (),
) -> tuple[Products, ...]:
    pairs = zip(number.slopes, shapes, strict=True)
    forces = [slope[:, :, None] * s[:, None] for slope, s in pairs]
    return products_of(ground, trial, forces, held)


def waves_at(ground: Recorded, trial: Fitted, number: Number, frequency: float) -> TimeLine:
    """A factor 1 + a·sin(2π·frequency·t) + b·cos(2π·frequency·t) + c: its three coefficients as
    those of a line, for the same linear problem."""
    shapes = []
    for item in ground.items:
        turn = 2 * np.pi * frequency * item.block.t[0]
        shapes.append(np.stack([np.sin(turn), np.cos(turn), np.ones_like(turn)], axis=1))
    return TimeLine(np.arange(3.0), _products(ground, trial, number, shapes), number.size)


def hats(t: Array, x: Array) -> Array:
    """Piecewise linear functions (N, G), without a unit, of the times t (N,), s, or of what a
    channel shows: 1 at one of the values x (G,) each, constant beyond the ends."""
    return np.stack([np.interp(t, x, row) for row in np.eye(x.size)], axis=1)
