"""Characteristic curves that a model file gives by points: what is declared, in its own units."""

import hashlib
from dataclasses import dataclass
from functools import lru_cache

from symhyb.laws.characteristic import Characteristic, Extrapolation, Interpolation, through
from symhyb.units import Unit

INTERPOLATIONS: tuple[Interpolation, ...] = ("monotone", "linear")
EXTRAPOLATIONS: tuple[Extrapolation, ...] = ("line", "hold")


@dataclass(frozen=True, slots=True)
class Curve:
    """Points (x, y) in ``units``, with increasing x, and how the curve runs through them.

    ``name`` is that of the file's ``[curves]``, or ``elements.<name>`` of an element's own. Points
    from a ``file`` beside the model file stand in its ``columns``; ``content`` is its text.
    """

    name: str
    points: tuple[tuple[float, float], ...]
    units: tuple[Unit, Unit]
    interpolation: Interpolation = "monotone"
    extrapolation: Extrapolation = "line"
    file: str = ""
    columns: tuple[str, ...] = ()
    content: str = ""
    about: str = ""

    @property
    def owned(self) -> bool:
        """Whether it is an element's own."""
        return "." in self.name

    @property
    def sha256(self) -> str:
        """The hash of its file."""
        return hashlib.sha256(self.content.encode()).hexdigest()

    @property
    def smooth(self) -> bool:
        """Whether its slope is continuous everywhere."""
        return self.interpolation == "monotone" and self.extrapolation == "line"

    @property
    def characteristic(self) -> Characteristic:
        """The curve in coherent SI."""
        return _characteristic(self)


@lru_cache(maxsize=256)
def _characteristic(curve: Curve) -> Characteristic:
    along, up = (unit.factor for unit in curve.units)
    x, y = [along * point[0] for point in curve.points], [up * point[1] for point in curve.points]
    return through(curve.name, x, y, curve.interpolation, curve.extrapolation)
