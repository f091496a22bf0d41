"""Named columns of numbers, as a file of any format has them."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem
from symhyb.units import UnitError, parse_unit

PART = "#"
"""Behind the name of a file: which part of it is wanted."""
_BRACKETED = re.compile(r"(.*?)\s*\[([^\[\]]*)\]\s*", re.DOTALL)
_IN_PARENTHESES = re.compile(r"(.*?)\s+\(([^()]*)\)\s*", re.DOTALL)
NO_UNIT = ("-", "–", "—", "none")  # what stands for the unit of a plain number


@dataclass(frozen=True, slots=True)
class Column:
    """A column as the file has it.

    ``header`` is the name as written (``laser [mm]``), ``values`` (N,) or, for a single number of
    a MAT file, (); in the unit of the file, NaN where a cell is empty. ``problem`` says why the
    column cannot be used, which matters only if somebody wants it. ``part`` is the sheet,
    structure, cell or group that the column stands in (empty: none), ``inside`` its header there.
    """

    header: str
    values: NDArray[np.float64]
    problem: Problem | None = None
    part: str = ""
    inside: str = ""

    @property
    def name(self) -> str:
        """The name without its unit."""
        return split_unit(self.header)[0]

    @property
    def unit(self) -> str | None:
        """The unit in brackets behind the name, None if there is none."""
        return split_unit(self.header)[1]

    @property
    def local(self) -> str:
        """The name inside its part, without its unit."""
        return split_unit(self.inside or self.header)[0]


@dataclass(frozen=True, slots=True)
class Table:
    """The columns of one file. ``lines`` (N,) are the line numbers of the rows in a text file.

    ``notes`` are sentences on what was left out; ``file`` is the path as given, for messages.
    ``run`` is the number, from 1, of the run that is wanted where time starts anew; 0: the file
    holds one run. Where the file is read in pieces, this one is ``partial``: a channel may lack all
    samples in it; ``first`` is the row of the file, from 0, that is the first one here.
    """

    file: str
    columns: tuple[Column, ...]
    notes: tuple[str, ...] = ()
    lines: NDArray[np.intp] | None = None
    sha256: str = ""
    run: int = 0
    first: int = 0
    partial: bool = False

    def find(self, name: str, part: str = "") -> tuple[Column, ...]:
        """Return the columns that ``name`` may mean: none, one, or one each of several parts.

        A column of ``part`` goes first, then the full header, the full name, and the name inside
        any part.
        """
        in_part = tuple(c for c in self.columns if part and c.part == part and c.local == name)
        if in_part:
            return in_part[:1]
        for exact in (
            [c for c in self.columns if c.header == name],
            [c for c in self.columns if c.name == name],
        ):
            if exact:
                return (exact[0],)
        return tuple(c for c in self.columns if c.part and name in (c.inside, c.local))

    def names(self) -> list[str]:
        """The names of the columns without their units, in the order of the file."""
        return [column.name for column in self.columns]

    def row(self, number: int) -> str:
        """Say where row ``number`` (from 0) stands: ``line 14`` of a text, else ``row 13``."""
        if self.lines is None:
            return f"row {self.first + number + 1}"
        return f"line {self.lines[number]}"


def split_unit(text: str) -> tuple[str, str | None]:
    """Split ``laser [mm]`` into ``laser`` and ``mm``, and ``laser (mm)`` where that is a unit that
    we know; without one the unit is None."""
    found = _BRACKETED.fullmatch(text)
    if found is None:
        found = _IN_PARENTHESES.fullmatch(text)
        if found is not None and not is_unit(found[2]):
            found = None
    if found is None:
        return text.strip(), None
    unit = found[2].strip()
    return found[1].strip(), "1" if unit in NO_UNIT else unit


def is_unit(text: str) -> bool:
    """Whether a text is a unit that we know, or stands for none."""
    try:
        parse_unit(text.strip())
    except UnitError:
        return text.strip() in NO_UNIT
    return True


def headed(name: str, unit: str) -> str:
    """Return ``name [unit]``, or the name alone where ``unit`` is empty or not one we know."""
    try:
        parse_unit(unit)
    except UnitError:
        return name
    return f"{name} [{unit}]" if unit.strip() else name


def in_part(
    header: str, values: NDArray[np.float64], part: str, problem: Problem | None = None
) -> Column:
    """A column of values (N,) or (), in the unit of its ``header``, in a ``part`` of a file; empty:
    in none."""
    if not part:
        return Column(header, values, problem)
    return Column(f"{part}.{header}", values, problem, part, header)


def choose(table: Table, part: str) -> Table | None:
    """Return ``table`` with the columns of ``part``, named as inside it, and those of no part.

    None: no column stands in such a part.
    """
    chosen = []
    for column in table.columns:
        beyond = column.part[len(part) + 1 :]
        if column.part == part:
            chosen.append(replace(column, header=column.inside, part="", inside=""))
        elif column.part.startswith(f"{part}."):
            header = f"{beyond}.{column.inside}"
            chosen.append(replace(column, header=header, part=beyond))
    if not chosen:
        return None
    shared = [column for column in table.columns if not column.part]
    own = {column.name for column in chosen}
    return replace(table, columns=(*(c for c in shared if c.name not in own), *chosen))


def following(parts: Sequence[Table]) -> Table:
    """Return one table of the vectors that all ``parts`` have, each after that of the part before.

    What the parts share (columns of no part) and what is no vector stays as the first has it.
    """
    first, *others = parts
    columns = []
    for column in first.columns:
        same = [[c for c in other.columns if c.header == column.header] for other in others]
        if not all(same):
            continue
        run = [column, *(found[0] for found in same)]
        if column.values.ndim and any(one is not column for one in run):
            values = np.concatenate([np.atleast_1d(one.values) for one in run])
            problem = next((one.problem for one in run if one.problem is not None), None)
            column = replace(column, values=values, problem=problem)
        columns.append(column)
    return replace(first, columns=tuple(columns))


def refusal(file: str, text: str, line: int = 0) -> InputError:
    """Return the error for a file that cannot be used as a whole."""
    return InputError(Problem(text, file=file, line=line))
