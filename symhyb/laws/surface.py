"""A map: a function of two variables, bilinear between the points of a grid.

    f(x, y) = Σᵢ Σⱼ zᵢⱼ hᵢ(x) gⱼ(y)      hᵢ  1 ┤   ●          a hat: 1 at its own place, 0 at all
                                               │  ╱ ╲         others, straight lines between;
                                             0 ┼─●───●──▶ x   beyond the last places the line goes
                                                              on, or the last value holds

As a sum over hats it costs as many of them as the grid has places, and not as it has points.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symhyb.laws.characteristic import Array, Characteristic, Extrapolation, through

Grid = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class Surface:
    """A function of x and y, SI: ``values`` has a row for each hat of ``over_x`` and in it a number
    for each of ``over_y``. ``name`` is what it is called in equations, ``slope_by`` has a letter,
    x or y, for each variable by which it was differentiated."""

    name: str
    over_x: tuple[Characteristic, ...]
    over_y: tuple[Characteristic, ...]
    values: Grid
    slope_by: str = ""

    def __call__(self, x: Any, y: Any) -> Array:
        """The values at ``x`` and ``y``, in the shape that they have together."""
        x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        along = np.stack([hat(x) for hat in self.over_x], axis=-1)
        across = np.stack([hat(y) for hat in self.over_y], axis=-1)
        total: Array = np.sum((along @ np.array(self.values)) * across, axis=-1)
        return total

    def slope(self, variable: str) -> "Surface":
        """The derivative by x or by y; at a place of the grid that of the cell behind it."""
        over_x, over_y = self.over_x, self.over_y
        if variable == "x":
            over_x = tuple(hat.slope() for hat in over_x)
        else:
            over_y = tuple(hat.slope() for hat in over_y)
        by = "".join(sorted(self.slope_by + variable))
        return Surface(self.name, over_x, over_y, self.values, by)


def bilinear(
    name: str,
    x: Sequence[float],
    y: Sequence[float],
    values: Sequence[Sequence[float]],
    extrapolation: Extrapolation = "line",
) -> Surface:
    """The map through ``values`` at places ``x`` and ``y``, SI, both increasing, two of them at
    least; a row of values for each x.

    Its coefficients are not finite where neighbours lie so close that their slope is not.
    """
    rows = tuple(tuple(map(float, row)) for row in values)
    over_x, over_y = hats(f"{name} x", x, extrapolation), hats(f"{name} y", y, extrapolation)
    return Surface(name, over_x, over_y, rows)


def hats(
    name: str, x: Sequence[float], extrapolation: Extrapolation = "line"
) -> tuple[Characteristic, ...]:
    """A function without a unit for each of the places ``x``, increasing, two at least: 1 there, 0
    at all others, straight between them, and beyond on along the line or held."""
    return tuple(
        _joined(through(f"{name} {i}", x, row, "linear", extrapolation))
        for i, row in enumerate(np.eye(len(x)).tolist())
    )


def _joined(hat: Characteristic) -> Characteristic:
    """The same function without breaks between pieces that are alike, as those that are 0."""
    pairs = zip(hat.pieces[:-1], hat.pieces[1:], strict=True)
    kept = [i for i, (a, b) in enumerate(pairs) if a != b and any((*a[1:], *b[1:]))]
    pieces = (hat.pieces[kept[0]], *(hat.pieces[i + 1] for i in kept))
    return Characteristic(hat.name, tuple(hat.breaks[i] for i in kept), pieces)
