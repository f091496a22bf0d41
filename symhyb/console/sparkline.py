"""A signal as a small picture of letters: dots of braille, one block of eight a cell."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

EMPTY = 0x2800
DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))  # of a cell: columns, from the top
TALL = len(DOTS[0])


def sparkline(values: NDArray[np.float64], width: int, rows: int = 2) -> list[str]:
    """Draw a signal (N,), in any unit, over ``width`` letters and as many ``rows``, from its lowest
    to its highest value: each column of dots from the least to the greatest of its samples, so that
    no peak is lost. Nothing where no sample is finite."""
    known = values[np.isfinite(values)]
    height = TALL * rows
    dots = np.zeros((height, 2 * width), bool)
    if known.size:
        low, span = float(known.min()), float(np.ptp(known))
        levels = (values - low) / span if span else np.where(np.isfinite(values), 0.5, np.nan)
        edges = np.linspace(0, values.size, 2 * width + 1).astype(int)
        before: tuple[int, int] | None = None
        for column, (first, last) in enumerate(pairwise(edges)):
            part = levels[first : max(last, first + 1)]
            part = part[np.isfinite(part)]
            if not part.size:
                before = None
                continue
            ends = [round(float(level) * (height - 1)) for level in (part.min(), part.max())]
            below, above = _joined(ends, before)
            dots[height - 1 - above : height - below, column] = True
            before = ends[0], ends[1]
    return ["".join(_letters(dots[TALL * row : TALL * (row + 1)])) for row in range(rows)]


def _joined(ends: list[int], before: tuple[int, int] | None) -> tuple[int, int]:
    """From where to where a column goes so that it touches the one before."""
    below, above = ends
    if before is not None and below > before[1]:
        below = before[1] + 1
    if before is not None and above < before[0]:
        above = before[0] - 1
    return min(below, ends[0]), max(above, ends[1])


def _letters(dots: NDArray[np.bool_]) -> list[str]:
    """The letters of a row of cells, whose dots are (4, 2·width)."""
    letters = []
    for column in range(0, dots.shape[1], 2):
        code = EMPTY
        for side in range(2):
            for row in range(TALL):
                code |= DOTS[side][row] * int(dots[row, column + side])
        letters.append(chr(code))
    return letters
