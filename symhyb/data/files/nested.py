"""Columns out of nested values: the structures, cells and matrices of MAT and JSON files.

A part is named with dots: ``run.laser`` is the field laser of the structure run, ``runs.2.laser``
that of the second one, ``both.2`` the second column of a matrix (the second row, where rows are
fewer), ``angles.3`` the third cell. Everything is counted from 1.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.table import Column
from symhyb.limits import STRUCTURES_DEEP

WIDEST = 64  # columns of a matrix that are vectors; above that it is a map or a picture
MOST_NOTES = 12


@dataclass(frozen=True, slots=True)
class Unfit:
    """A value that is no number or vector; ``why`` completes "variable x is …"."""

    why: str


@dataclass(frozen=True, slots=True)
class _Spot:
    """Where a value stands: its full name, its part, and its name inside that part."""

    full: str
    part: str = ""
    inside: str = ""

    def field(self, key: str) -> "_Spot":
        """The field ``key`` of a structure, which is a part."""
        return _Spot(f"{self.full}.{key}", self.full, key) if self.full else _Spot(key, "", key)

    def cell(self, number: int) -> "_Spot":
        """The cell ``number``: a part of the whole file, or of the structure it stands in."""
        full = f"{self.full}.{number}"
        if self.part:
            return _Spot(full, self.part, f"{self.inside}.{number}")
        return _Spot(full, str(number), self.inside)

    def vector(self, number: int) -> "_Spot":
        """The column ``number`` of a matrix."""
        return _Spot(f"{self.full}.{number}", self.part, f"{self.inside}.{number}")


def columns_of(tree: Mapping[str, object]) -> tuple[tuple[Column, ...], tuple[str, ...]]:
    """Return all real vectors (N,) and numbers () in ``tree``, and notes on what else there is.

    Values are arrays, :class:`Unfit`, mappings (structures) or lists (cells) of them; columns are
    in the unit of the file.
    """
    columns: list[Column] = []
    notes: list[str] = []
    for item in _walk(tree, _Spot(""), 0):
        if isinstance(item, Column):
            columns.append(item)
        else:
            notes.append(item)
    if len(notes) > MOST_NOTES:
        more = f"{len(notes) - MOST_NOTES} more variables are no vectors of numbers: left out"
        notes = [*notes[:MOST_NOTES], more]
    return tuple(columns), tuple(notes)


def _walk(value: object, spot: _Spot, depth: int) -> Iterator[Column | str]:
    if depth > STRUCTURES_DEEP:
        yield f"variable {spot.full} is nested too deeply: left out"
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from _walk(item, spot.field(str(key)), depth + 1)
    elif isinstance(value, list):
        for number, item in enumerate(value, start=1):
            yield from _walk(item, spot.cell(number), depth + 1)
    elif isinstance(value, Unfit):
        yield f"variable {spot.full} is {value.why}: left out"
    elif isinstance(value, np.ndarray):
        yield from _vectors(value, spot)


def _vectors(value: NDArray[np.generic], spot: _Spot) -> Iterator[Column | str]:
    why = _unfit(value)
    if why:
        yield f"variable {spot.full} is {why}: left out"
        return
    numbers = np.asarray(value, dtype=np.float64)
    inside = spot.inside if spot.part else ""
    if numbers.ndim < 2 or min(numbers.shape) == 1:
        shape = () if numbers.size == 1 else (numbers.size,)
        yield Column(spot.full, numbers.reshape(shape), None, spot.part, inside)
        return
    upright = numbers if numbers.shape[0] >= numbers.shape[1] else numbers.T
    for number, vector in enumerate(upright.T, start=1):
        one = spot.vector(number)
        inside = one.inside if one.part else ""
        yield Column(one.full, np.ascontiguousarray(vector), None, one.part, inside)


def _unfit(value: NDArray[np.generic]) -> str:
    """Say what an array is if it is no real vector, number or narrow matrix, else nothing."""
    if value.dtype.kind not in "buif":
        return "complex" if value.dtype.kind == "c" else "text"
    if value.size == 0:
        return "empty"
    if value.ndim > 2 or (value.ndim == 2 and min(value.shape) > WIDEST):
        size = " x ".join(str(length) for length in value.shape)
        return f"a matrix ({size}), not a vector"
    return ""
