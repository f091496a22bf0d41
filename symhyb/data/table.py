"""Named columns of numbers, as a file of any format has them."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem

_BRACKETED = re.compile(r"(.*?)\s*\[([^\[\]]*)\]\s*", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Column:
    """A column as the file has it.

    ``header`` is the name as written (``laser [mm]``), ``values`` (N,) or, for a single number of
    a MAT file, (); in the unit of the file, NaN where a cell is empty. ``problem`` says why the
    column cannot be used, which matters only if somebody wants it.
    """

    header: str
    values: NDArray[np.float64]
    problem: Problem | None = None

    @property
    def name(self) -> str:
        """The name without its unit."""
        return split_unit(self.header)[0]

    @property
    def unit(self) -> str | None:
        """The unit in brackets behind the name, None if there is none."""
        return split_unit(self.header)[1]


@dataclass(frozen=True, slots=True)
class Table:
    """The columns of one file. ``lines`` (N,) are the line numbers of the rows in a text file.

    ``notes`` are sentences on what was left out; ``file`` is the path as given, for messages.
    """

    file: str
    columns: tuple[Column, ...]
    notes: tuple[str, ...] = ()
    lines: NDArray[np.intp] | None = None
    sha256: str = ""

    def names(self) -> list[str]:
        """The names of the columns without their units, in the order of the file."""
        return [column.name for column in self.columns]

    def row(self, number: int) -> str:
        """Say where row ``number`` (from 0) stands: ``line 14`` of a text, else ``row 13``."""
        return f"row {number + 1}" if self.lines is None else f"line {self.lines[number]}"


def split_unit(text: str) -> tuple[str, str | None]:
    """Split ``laser [mm]`` into ``laser`` and ``mm``; without brackets the unit is None."""
    found = _BRACKETED.fullmatch(text)
    return (found[1].strip(), found[2].strip()) if found else (text.strip(), None)


def refusal(file: str, text: str, line: int = 0) -> InputError:
    """Return the error for a file that cannot be used as a whole."""
    return InputError(Problem(text, file=file, line=line))
