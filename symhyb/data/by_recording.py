"""Tables with a row for each recording: how their rows are read and found."""

import csv
import os
from collections.abc import Sequence
from io import StringIO
from pathlib import Path, PurePath
from typing import TypeVar

from symhyb.errors import InputError, Problem
from symhyb.limits import text_of

NAMES = "recording"
"""The column that names the recordings."""

Row = TypeVar("Row")


def cells_of(file: Path) -> list[tuple[int, list[str]]]:
    """The rows of a table with the numbers of their lines, without those that are empty.

    Raises:
        InputError: the file cannot be read, or is no table.
    """
    text = text_of(file)
    lines = [line for line in text.splitlines() if line.strip()]
    delimiter = max(",;\t", key=lines[0].count) if lines else ","
    reader = csv.reader(StringIO(text), delimiter=delimiter, skipinitialspace=True)
    try:
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise InputError(Problem(f"is no table: {error}", file=str(file))) from None
    return [(number, row) for number, row in rows if any(row)]


def row_of(rows: Sequence[tuple[str, Row]], recording: str | os.PathLike[str], file: str) -> Row:
    """What a table says of the recording at a path, which ends with the name in the table; where
    two names fit, that of the longer one.

    Raises:
        InputError: no row for it.
    """
    path = PurePath(recording).parts
    fitting = [
        (len(parts), values)
        for name, values in rows
        if path[-len(parts := PurePath(name).parts) :] == parts
    ]
    if not fitting:
        text = f"has no row for the recording '{recording}'"
        raise InputError(Problem(text, NAMES, file))
    return max(fitting, key=lambda row: row[0])[1]
