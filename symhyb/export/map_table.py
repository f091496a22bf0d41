"""Laws of stretch and rate together as a grid of values, in the form of the file of a map.

m \\ m/s: N │ rates      F > 0 resists, as in a table of two columns; between the places of
───────────┼──────      the grid bilinear: places are added along each axis where a straight
stretches  │ forces     line misses the law most, as long as that is worth it and there is room
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symhyb.limits import MAP_PLACES
from symhyb.model.types import Place, place_text
from symhyb.numeric.kernels.buffers import Array

ACCURACY = 1e-3  # of the largest force: what a straight line between two rows or places may miss
PLACES_FIRST = 9  # along each axis

Law = Callable[[Array, Array], Array]
"""The force over stretch and rate, SI, of arrays that fit each other."""


@dataclass(frozen=True, slots=True, eq=False)
class MapTable:
    """The ``force`` (X, Y) over the stretch ``x`` (X,) and the rate ``y`` (Y,) at a place, in their
    units, of some ``elements`` together; it misses them by a part ``missed`` of the largest
    force."""

    place: Place
    elements: tuple[str, ...]
    x: Array
    y: Array
    force: Array
    units: tuple[str, str, str]
    missed: float

    @property
    def file(self) -> str:
        """The name of its file: ``on-x-map.csv``."""
        return file_of(self.place, "map")

    def text(self) -> str:
        """The rates in the first line, and below each stretch with its row, with commas."""
        along, across, up = self.units
        rows = [f"{along} \\ {across}: {up}", *map(_cell, self.y)]
        lines = [
            rows,
            *([*map(_cell, (x, *row))] for x, row in zip(self.x, self.force, strict=True)),
        ]
        return "\n".join(map(",".join, lines)) + "\n"

    def said(self) -> str:
        """What it holds, for a person."""
        along, across, up = self.units
        units = f'units = ["{along}", "{across}", "{up}"]'
        far = f"; misses the law by {self.missed:.1%}" if self.missed > ACCURACY else ""
        return (
            f"{self.file}: force over stretch and rate {place_text(self.place)} of "
            f"{' and '.join(self.elements)}, {self.x.size} by {self.y.size} places from "
            f"{self.x[0]:.4g} to {self.x[-1]:.4g} {along} and from {self.y[0]:.4g} to "
            f"{self.y[-1]:.4g} {across}{far}; F > 0 resists, {units}"
        )


def file_of(place: Place, of: str) -> str:
    """The name of the file of a table: the place, and what the force is a function of."""
    words = "".join(c if c.isalnum() or c in "_" else " " for c in place_text(place))
    return "-".join((*words.split(), of)) + ".csv"


def gridded(law: Law, x: Array, y: Array) -> tuple[Array, Array, Array, float]:
    """Places x (X,) and y (Y,), SI, with more between them where the law asks for it, its force
    (X, Y) there, and by which part of the largest it is missed between them."""
    while True:
        force = law(x[:, None], y[None, :])
        largest = float(np.abs(force).max(initial=0.0)) or 1.0
        between_x, between_y = 0.5 * (x[:-1] + x[1:]), 0.5 * (y[:-1] + y[1:])
        in_x = law(between_x[:, None], y[None, :]) - 0.5 * (force[:-1] + force[1:])
        in_y = law(x[:, None], between_y[None, :]) - 0.5 * (force[:, :-1] + force[:, 1:])
        missed_x = np.abs(in_x).max(axis=1) / largest
        missed_y = np.abs(in_y).max(axis=0) / largest
        more_x = _worst(between_x, missed_x, MAP_PLACES - x.size)
        more_y = _worst(between_y, missed_y, MAP_PLACES - y.size)
        if not (more_x.size or more_y.size):
            return x, y, force, float(max(missed_x.max(), missed_y.max()))
        x, y = np.union1d(x, more_x), np.union1d(y, more_y)


def _worst(between: Array, missed: Array, room: int) -> Array:
    """The places at which most is missed, a quarter of the room at once, so that what is left goes
    where it is needed then."""
    order = np.argsort(-missed, kind="stable")[: max(room // 4, min(room, 1))]
    return between[order[missed[order] > ACCURACY]]


def _cell(value: float) -> str:
    return f"{value:.9g}"
