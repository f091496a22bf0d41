"""A characteristic curve as polynomials between breaks: interpolated points, slope and area.

       F ^          . ● . . . beyond: the line of the end slope, or the last value
         |      ●'
         |   ●          between the points a cubic that overshoots no point, or straight lines
      ───┼──●──────────────▶ x

Sources: Fritsch & Carlson, SIAM J. Numer. Anal. 17, 1980 (monotone piecewise cubics); Fritsch &
Butland, SIAM J. Sci. Stat. Comput. 5, 1984 (the slopes, as in SciPy's ``PchipInterpolator``).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Interpolation = Literal["monotone", "linear"]
Extrapolation = Literal["line", "hold"]
Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Characteristic:
    """A function of one variable x, SI: piece i holds from break i − 1 up to break i, where the
    next begins. A piece is (origin, c0, c1, …) for c0 + c1·(x − origin) + …; with m breaks there
    are m + 1 pieces. ``name`` is what it is called in equations."""

    name: str
    breaks: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]

    def __call__(self, x: Any) -> Array:
        """The values at ``x``, in its shape."""
        x = np.asarray(x, dtype=np.float64)
        table = np.array(self.pieces)[np.searchsorted(self.breaks, x, side="right")]
        total: Array = np.zeros_like(x)
        for k in range(table.shape[-1] - 1, 0, -1):
            total = total * (x - table[..., 0]) + table[..., k]
        return total

    def slope(self) -> "Characteristic":
        """The derivative; at a break that of the piece behind it."""
        pieces = tuple(
            (origin, *(k * c for k, c in enumerate(rest[1:], 1))) for origin, *rest in self.pieces
        )
        return Characteristic(f"{self.name}'", self.breaks, pieces)

    def area(self) -> "Characteristic":
        """The integral from 0 to x."""
        pieces: list[tuple[float, ...]] = []
        for i, (origin, *rest) in enumerate(self.pieces):
            grown = (origin, 0.0, *(c / k for k, c in enumerate(rest, 1)))
            if i:  # it begins where the piece before ends
                at = self.breaks[i - 1]
                gap = _value(pieces[-1], at) - _value(grown, at)
                grown = (origin, gap, *grown[2:])
            pieces.append(grown)
        whole = Characteristic(f"area of {self.name}", self.breaks, tuple(pieces))
        start = float(whole(0.0))
        moved = tuple((origin, c0 - start, *rest) for origin, c0, *rest in pieces)
        return Characteristic(whole.name, self.breaks, moved)


def _value(piece: Sequence[float], x: float) -> float:
    origin, *coefficients = piece
    total = 0.0
    for c in reversed(coefficients):
        total = total * (x - origin) + c
    return total


def through(
    name: str,
    x: Sequence[float],
    y: Sequence[float],
    interpolation: Interpolation = "monotone",
    extrapolation: Extrapolation = "line",
) -> Characteristic:
    """The curve through points (x, y), SI, with increasing x, two of them at least.

    Its coefficients are not finite where neighbours lie so close that their slope is not.
    """
    places, values = np.array(x, dtype=np.float64), np.array(y, dtype=np.float64)
    with np.errstate(all="ignore"):
        h = np.diff(places)
        secants = np.diff(values) / h
        if interpolation == "linear":
            first, last, zero = secants[0], secants[-1], np.zeros_like(h)
            inner = np.stack([places[:-1], values[:-1], secants, zero, zero], axis=1)
        else:
            slopes = monotone_slopes(h, secants)
            first, last = slopes[0], slopes[-1]
            second = (3 * secants - 2 * slopes[:-1] - slopes[1:]) / h
            third = (slopes[:-1] + slopes[1:] - 2 * secants) / h**2
            inner = np.stack([places[:-1], values[:-1], slopes[:-1], second, third], axis=1)
    if extrapolation == "hold":
        first = last = 0.0
    before = (places[0], values[0], first, 0.0, 0.0)
    behind = (places[-1], values[-1], last, 0.0, 0.0)
    size = 3 if interpolation == "linear" else 5
    pieces = [before, *inner, behind]
    return Characteristic(
        name,
        tuple(map(float, places)),
        tuple(tuple(map(float, piece[:size])) for piece in pieces),
    )


def monotone_slopes(h: Array, secants: Array) -> Array:
    """The slopes (P,) at points that lie ``h`` (P − 1,) apart, in the unit of the ``secants``
    (P − 1,) between them: inside the weighted harmonic mean of both secants, 0 at an extreme point;
    at the ends by three points, held so that the curve stays monotone."""
    if h.size == 1:
        return np.array([secants[0], secants[0]])
    left, right = secants[:-1], secants[1:]
    w1, w2 = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    mean = (w1 + w2) / (w1 / left + w2 / right)
    inside = np.where(np.sign(left) * np.sign(right) > 0, mean, 0.0)
    ends = (
        _end_slope(h[0], h[1], left[0], right[0]),
        _end_slope(h[-1], h[-2], right[-1], left[-1]),
    )
    return np.concatenate([[ends[0]], inside, [ends[1]]])


def _end_slope(h0: float, h1: float, near: float, far: float) -> float:
    slope = ((2 * h0 + h1) * near - h0 * far) / (h0 + h1)
    if np.sign(slope) != np.sign(near):
        return 0.0
    if np.sign(near) != np.sign(far) and abs(slope) > 3 * abs(near):
        return float(3 * near)
    return float(slope)
