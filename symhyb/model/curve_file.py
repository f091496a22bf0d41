"""Points of a characteristic curve from a CSV file: a line of names, below it lines of numbers.

    speed [m/s], force [N]        comma, semicolon or tab; units in brackets; # begins a remark
    -0.5, -610

Strict: whatever is no number, and every line that has another number of cells, is a fault.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from symhyb.errors import did_you_mean
from symhyb.model.tables import shorten

DELIMITERS = (",", ";", "\t")
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_HEADED = re.compile(r"([^\[\]]*?)\s*\[([^\[\]]*)\]")


@dataclass(frozen=True, slots=True)
class Points:
    """What a file says: points with the line of each, the text of both units where the header
    states them, and every fault as (line, sentence)."""

    points: tuple[tuple[float, float], ...] = ()
    lines: tuple[int, ...] = ()
    units: tuple[str | None, str | None] = (None, None)
    faults: tuple[tuple[int, str], ...] = field(default=())


def points_in(content: str, columns: Sequence[str] = ()) -> Points:
    """Read two columns: those named in ``columns``, else the only two that there are."""
    lines = lines_of(content)
    if not lines:
        return Points(faults=((0, "holds no line of numbers"),))
    (at, first), *rest = lines
    delimiter = max(DELIMITERS, key=first.count)
    header = [_named(cell) for cell in first.split(delimiter)]
    names = [name for name, _ in header]
    if all(NUMBER.fullmatch(name) for name in names):
        return Points(faults=((at, "the first line must name the columns"),))
    where, faults = _columns(names, columns)
    if len(where) != 2:
        return Points(faults=tuple((at, fault) for fault in faults))
    units = (header[where[0]][1], header[where[1]][1])
    points, numbers, wrong = [], [], []
    for line, text in rest:
        cells = [cell.strip() for cell in text.split(delimiter)]
        if len(cells) != len(names):
            wrong.append((line, f"has {len(cells)} cells; the first line has {len(names)}"))
            continue
        said = [number_fault(cells[i]) for i in where]
        wrong += [(line, fault) for fault in said if fault]
        if not any(said):
            points.append((float(cells[where[0]]), float(cells[where[1]])))
            numbers.append(line)
    return Points(tuple(points), tuple(numbers), units, tuple(wrong))


def lines_of(content: str) -> list[tuple[int, str]]:
    """The lines that hold something, with their numbers: neither blank ones nor remarks."""
    numbered = enumerate(content.split("\n"), 1)
    return [(i, line) for i, line in numbered if line.strip() and line.lstrip()[0] != "#"]


def _named(cell: str) -> tuple[str, str | None]:
    """The name of a column, and the unit in brackets behind it."""
    found = _HEADED.fullmatch(cell.strip())
    return (found[1].strip(), found[2].strip()) if found else (cell.strip(), None)


def _columns(names: Sequence[str], wanted: Sequence[str]) -> tuple[list[int], list[str]]:
    """Which two columns are meant, or what is wrong."""
    if not wanted:
        if len(names) == 2:
            return [0, 1], []
        return [], [f"has {len(names)} columns; 'columns' must name the two that are meant"]
    return [names.index(one) for one in wanted if names.count(one) == 1], list(
        _unclear(names, wanted)
    )


def _unclear(names: Sequence[str], wanted: Sequence[str]) -> Iterator[str]:
    for one in wanted:
        if one not in names:
            yield f"has no column '{shorten(one)}'{did_you_mean(one, names)}"
        elif names.count(one) > 1:
            yield f"has {names.count(one)} columns '{shorten(one)}'"


def number_fault(cell: str) -> str:
    """What keeps a cell from being a finite number; empty of one."""
    if not NUMBER.fullmatch(cell):
        cure = "; write a decimal point" if re.fullmatch(r"[-+]?\d+,\d+", cell) else ""
        return f"'{shorten(cell)}' is not a number{cure}" if cell else "a cell is empty"
    return "" if math.isfinite(float(cell)) else f"'{shorten(cell)}' is not finite"
