"""Maps that a model file gives by a grid of values: what is declared, in its own units."""

import hashlib
from dataclasses import dataclass
from functools import lru_cache

from symhyb.laws.characteristic import Extrapolation
from symhyb.laws.surface import Grid, Surface, bilinear
from symhyb.units import Unit


@dataclass(frozen=True, slots=True)
class Map:
    """Values at the points of a grid, a row for each ``x`` and in it one for each ``y``, in
    ``units`` of x, y and value.

    ``name`` is that of the file's ``[maps]``, or ``elements.<name>`` of an element's own. A grid
    from a ``file`` beside the model file has its text in ``content``.
    """

    name: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    values: Grid
    units: tuple[Unit, Unit, Unit]
    extrapolation: Extrapolation = "line"
    file: str = ""
    content: str = ""
    about: str = ""

    @property
    def owned(self) -> bool:
        """Whether it is an element's own."""
        return "." in self.name

    @property
    def smooth(self) -> bool:
        """Whether its slopes are continuous everywhere, which they are not at places of its
        grid."""
        return False

    @property
    def sha256(self) -> str:
        """The hash of its file."""
        return hashlib.sha256(self.content.encode()).hexdigest()

    @property
    def surface(self) -> Surface:
        """The map in coherent SI."""
        return _surface(self)


@lru_cache(maxsize=64)
def _surface(item: Map) -> Surface:
    over_x, over_y, up = (unit.factor for unit in item.units)
    values = [[up * value for value in row] for row in item.values]
    x, y = [over_x * one for one in item.x], [over_y * one for one in item.y]
    return bilinear(item.name, x, y, values, item.extrapolation)
