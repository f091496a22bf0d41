"""A table of what is known of parameters in each recording.

recording,   m [kg], l [m]
fall-1.csv,  0.535,  0.1
fall-2.csv,  1.168,  0.15

A column a parameter, in the unit of its header, else in that of the model; a row belongs to the
recording whose path ends with its name.
"""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from symhyb.data.by_recording import NAMES, cells_of, row_of
from symhyb.data.files.table import split_unit
from symhyb.data.known import unit_text, unusable
from symhyb.errors import InputError, Problem
from symhyb.model.types import Model, Parameter
from symhyb.units import UnitError, parse_unit


@dataclass(frozen=True, slots=True)
class KnownTable:
    """The ``rows`` of a table: the name of a recording with the values of parameters by path, in
    the units of the model."""

    file: str
    rows: tuple[tuple[str, Mapping[str, float]], ...]

    def of(self, recording: str | os.PathLike[str]) -> Mapping[str, float]:
        """The values of the recording at a path, which ends with the name in the table; where two
        names fit, those of the longer one.

        Raises:
            InputError: no row for it.
        """
        return row_of(self.rows, recording, self.file)


def read_known(path: str | os.PathLike[str], model: Model) -> KnownTable:
    """Read a table of known values: CSV with a column ``recording`` and one a parameter.

    Raises:
        InputError: no table, columns that are no parameters, units of another dimension, cells that
            hold no finite number, or recordings that are named twice: all problems at once.
    """
    file = Path(path)
    rows = cells_of(file)
    if not rows:
        raise InputError(Problem("the file is empty", file=str(file)))
    (line, head), *body = rows
    problems: list[Problem] = []
    columns = _columns(head, model, file, line, problems)
    found: list[tuple[str, dict[str, float]]] = []
    lines: dict[str, int] = {}
    for number, cells in body:
        if len(cells) != len(head):
            text = f"has {len(cells)} cells below a header of {len(head)}"
            problems.append(Problem(text, file=str(file), line=number))
            continue
        name = cells[head.index(NAMES)] if NAMES in head else ""
        if NAMES in head and not name:
            problems.append(Problem("names no recording", NAMES, str(file), number))
        if name and lines.setdefault(name, number) != number:
            text = f"'{name}' stands in line {lines[name]} already"
            problems.append(Problem(text, NAMES, str(file), number))
        values = {}
        for i, (known, factor) in columns.items():
            value = _number(cells[i])
            if value is None:
                text = f"must be a finite number, not '{cells[i]}'"
                problems.append(Problem(text, known, str(file), number))
            else:
                values[known] = value * factor
        found.append((name, values))
    if not body:
        problems.append(Problem("there is a header but no row below it", file=str(file)))
    if problems:
        raise InputError(problems)
    return KnownTable(str(file), tuple(found))


def table_of_known(path: Path | None, model: Model) -> KnownTable | None:
    """The table at a path, None without one.

    Raises:
        InputError: as :func:`read_known`.
    """
    return None if path is None else read_known(path, model)


def values_in(
    table: KnownTable | None, recording: str | os.PathLike[str]
) -> Mapping[str, float] | None:
    """The values of a recording in a table, in the units of the model; None without a table.

    Raises:
        InputError: the table has no row for it.
    """
    return None if table is None else table.of(recording)


def _columns(
    head: Sequence[str], model: Model, file: Path, line: int, problems: list[Problem]
) -> dict[int, tuple[str, float]]:
    """Which columns are which parameters, with what makes the unit of the model of their values;
    what is wrong with them becomes a problem."""
    declared = {item.path: item for item in model.all_parameters()}
    found: dict[int, tuple[str, float]] = {}
    if NAMES not in head:
        text = f"a column '{NAMES}' with the names of the recordings is missing"
        problems.append(Problem(text, file=str(file), line=line))
    for i, cell in enumerate(head):
        if cell == NAMES and head.index(NAMES) == i:
            continue
        name, unit = split_unit(cell)
        wrong = unusable(name, declared)
        if not wrong and name in {known for known, _ in found.values()}:
            wrong = "has two columns"
        if wrong:
            problems.append(Problem(wrong, name or f"column {i + 1}", str(file), line))
            continue
        factor, wrong = _factor(unit, declared[name])
        if wrong:
            problems.append(Problem(wrong, name, str(file), line))
        found[i] = (name, factor)
    if not found and not problems:
        problems.append(Problem("has no column of a parameter", file=str(file), line=line))
    return found


def _factor(unit: str | None, item: Parameter) -> tuple[float, str]:
    """What turns values of a column into the unit of the model, and what is wrong with its unit."""
    if unit is None:
        return 1.0, ""
    try:
        stated = parse_unit(unit)
    except UnitError as error:
        return 1.0, str(error)
    if not stated.same_dimension(item.unit):
        return 1.0, f"is given in {unit}, but the model has it in {unit_text(item)}"
    return stated.factor / item.unit.factor, ""


def _number(cell: str) -> float | None:
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
