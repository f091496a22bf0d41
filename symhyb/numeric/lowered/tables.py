"""Curves and maps as CasADi SX: polynomials whose coefficients are picked by comparisons."""

from collections.abc import Callable
from itertools import pairwise

import casadi as ca

from symhyb.laws.characteristic import Characteristic
from symhyb.laws.surface import Surface


def picked(curve: Characteristic, x: ca.SX) -> ca.SX:
    """The piece in which x lies: its coefficients are picked by comparisons, which have no slope,
    so that derivatives cost no more than those of one polynomial."""
    steps: list[ca.SX] = [ca.SX(1), *(x >= at for at in curve.breaks), ca.SX(0)]
    here = [begun - over for begun, over in pairwise(steps)]
    columns = zip(*curve.pieces, strict=True)
    origin, *coefficients = (
        fold([mark * c for mark, c in zip(here, column, strict=True)], lambda a, b: a + b)
        for column in columns
    )
    total = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        total = total * (x - origin) + c
    return total


def on_surface(surface: Surface, x: ca.SX, y: ca.SX) -> ca.SX:
    """The value at x and y: each hat once, whatever the number of points."""
    along = [picked(hat, x) for hat in surface.over_x]
    across = [picked(hat, y) for hat in surface.over_y]
    rows = (
        fold([z * one for z, one in zip(row, across, strict=True)], lambda a, b: a + b)
        for row in surface.values
    )
    terms = [one * row for one, row in zip(along, rows, strict=True)]
    return fold(terms, lambda a, b: a + b)


def fold(parts: list[ca.SX], join: Callable[[ca.SX, ca.SX], ca.SX]) -> ca.SX:
    """The parts joined from the first to the last."""
    total = parts[0]
    for part in parts[1:]:
        total = join(total, part)
    return total
