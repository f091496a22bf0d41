"""Delimited text: comma, semicolon or tab, with a header line of column names."""

import csv
import io
import re
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.cells import numbers_in
from symhyb.data.files.table import NO_UNIT, Column, Table, is_unit, refusal, split_unit
from symhyb.errors import Problem
from symhyb.limits import COLUMNS

Line = tuple[int, str]
"""The number of a line, from 1, and its text."""

DASHES = re.compile(r"\s*[-–—]+\s*")  # what loggers write where nothing was measured
PREAMBLE_MOST = 100  # lines above the names of the columns
TABLE_LEAST = 0.9  # of the lines from there on that have as many cells
_DELIMITERS = (",", ";", "\t")
_DATE = re.compile(r"\d{4}-\d\d-\d\d([T ]\d\d:\d\d.*)?")
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d+,\d+([eE][-+]?\d+)?\s*")


def read_csv(content: bytes, file: str) -> Table:
    """Read the bytes of a delimited text; empty cells are NaN, a column of empty cells is dropped.

    Raises:
        InputError: no text, no header, no rows, or rows of different length.
    """
    lines = [
        (number, line)
        for number, line in enumerate(_text(content, file).splitlines(), start=1)
        if line.strip()
    ]
    if not lines:
        raise refusal(file, "the file is empty")
    lines, notes = _without_preamble(lines)
    number, first = lines[0]
    delimiter = max(_DELIMITERS, key=first.count)
    header = [cell.strip() for cell in _cells(first, delimiter)]
    if len(header) > COLUMNS:
        raise refusal(file, f"has {len(header)} columns; at most {COLUMNS} are read", number)
    rows = lines[1:]
    if not any(header) or all(_is_number(cell) for cell in header if cell):
        raise refusal(file, "a first line with the names of the columns is required", number)
    if len(header) == 1 and rows and len(rows[0][1].split()) > 1:
        raise refusal(file, "no comma, semicolon or tab separates the names of the columns", number)
    units = _units_below(rows, delimiter, len(header))
    if units:
        header, rows = [_headed(*pair) for pair in zip(header, units, strict=True)], rows[1:]
        notes = (*notes, "the units of the columns stand in the line below their names")
    if not rows:
        raise refusal(file, "there is a header but no row below it")
    _refuse_ragged(rows, delimiter, len(header), file)
    body = "\n".join(line for _, line in rows)
    commas = delimiter != "," and any(map(_DECIMAL_COMMA.fullmatch, _cells(rows[0][1], delimiter)))
    numbers = np.array([number for number, _ in rows])
    columns = _columns(body, header, delimiter, "," if commas else ".", numbers, file)
    notes = (*notes, "numbers are written with a decimal comma") if commas else notes
    return Table(file, columns, notes, numbers)


def _text(content: bytes, file: str) -> str:
    """Decode UTF-8 (or what spreadsheets write instead) and refuse what is not text."""
    encodings = ["utf-8-sig", "cp1252", "latin-1"]
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encodings = ["utf-16", *encodings]
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        break
    if _CONTROL.search(text):
        raise refusal(file, "is not a text file, although its name ends in .csv")
    return text


def _without_preamble(lines: list[Line]) -> tuple[list[Line], tuple[str, ...]]:
    """The lines from the names of the columns on: the first with as many cells as nearly all have,
    if it names something and numbers stand below it; and a note on what stands above."""
    among = lines[len(lines) // 2][1]  # where there are others a comma may be a decimal one
    delimiter = next((one for one in (";", "\t") if one in among), ",")
    counts = [_width(line, delimiter) for _, line in lines]
    width, often = Counter(counts).most_common(1)[0]
    first = counts.index(width)
    if first == 0 or first > PREAMBLE_MOST or often < TABLE_LEAST * (len(lines) - first):
        return lines, ()
    names = [cell.strip() for cell in _cells(lines[first][1], delimiter)]
    if width < 2 or any(_is_number(cell.replace(",", ".")) for cell in names):
        return lines, ()
    above = f"{first} line{'s' * (first > 1)} above the names of the columns"
    return lines[first:], (f"{above} {'are' if first > 1 else 'is'} not read",)


def _units_below(rows: list[Line], delimiter: str, width: int) -> list[str]:
    """The cells of a line of units below the names, empty if there is none: no numbers but 1, at
    least one unit that we know, and numbers in that column below it."""
    if len(rows) < 2:
        return []
    cells, below = ([c.strip() for c in _cells(line, delimiter)] for _, line in rows[:2])
    if len(cells) != width or len(below) != width:
        return []
    if any(_is_number(cell.replace(",", ".")) and cell != "1" for cell in cells):
        return []
    units = [i for i, cell in enumerate(cells) if cell not in ("", "1") and is_unit(cell)]
    numbers = [i for i in units if _is_number(below[i].replace(",", "."))]
    return cells if any(cells[i] not in NO_UNIT for i in numbers) else []


def _headed(name: str, unit: str) -> str:
    """The name with its unit in brackets, unless it states one already."""
    stated = split_unit(name)[1] is not None or not unit
    return name if stated else f"{name} [{unit.strip('[]()')}]"


def _cells(line: str, delimiter: str) -> list[str]:
    if '"' not in line:
        return line.split(delimiter)
    return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))


def _width(line: str, delimiter: str) -> int:
    """How many cells a line has."""
    return line.count(delimiter) + 1 if '"' not in line else len(_cells(line, delimiter))


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _refuse_ragged(rows: list[tuple[int, str]], delimiter: str, width: int, file: str) -> None:
    """Refuse rows that are longer or shorter than the header: pandas would shift or fill them."""
    wrong = [
        (number, count) for number, line in rows if (count := _width(line, delimiter)) != width
    ]
    if not wrong:
        return
    number, count = wrong[0]
    text = f"has {count} cell{'s' * (count != 1)}, the header has {width}"
    if number == rows[-1][0]:
        text += "; it is the last line, perhaps cut off: delete it"
    elif len(wrong) > 1:
        text += f"; {len(wrong) - 1} more line{'s' * (len(wrong) > 2)} like this"
    raise refusal(file, text, number)


def _columns(
    body: str,
    header: list[str],
    delimiter: str,
    decimal: str,
    lines: NDArray[np.intp],
    file: str,
) -> tuple[Column, ...]:
    import pandas as pd

    try:
        frame = pd.read_csv(
            io.StringIO(body),
            sep=delimiter,
            decimal=decimal,
            header=None,
            names=list(range(len(header))),
            index_col=False,
            engine="c",
            skipinitialspace=True,
            low_memory=False,
        )
    except pd.errors.ParserError as error:
        raise refusal(file, f"cannot be read as a table: {error}") from error
    columns, often = [], Counter(header)
    for place, name in enumerate(header):
        cells = frame[place]
        if not name and cells.isna().all():
            continue  # a delimiter at the end of every line
        numeric = pd.api.types.is_numeric_dtype(cells)  # neither dates nor dashes
        values = None if numeric else _dates(cells)
        if values is None:
            values = numbers_in(cells)
            if not numeric:
                cells = cells.mask(cells.map(_is_dash).astype(bool))
        bad = np.flatnonzero(np.isnan(values) & cells.notna().to_numpy())
        problem = None
        if often[name] > 1 and name:
            problem = Problem("stands more than once in the header", f"column '{name}'", file)
        elif bad.size:
            cell = str(cells.iloc[bad[0]])
            text = f"'{cell[:40]}' is not a number"
            more = f" ({bad.size} such cells)" if bad.size > 1 else ""
            problem = Problem(text + more, f"column '{name}'", file, int(lines[bad[0]]))
        columns.append(Column(name or f"column {place + 1}", values, problem))
    return tuple(columns)


def _is_dash(cell: object) -> bool:
    return isinstance(cell, str) and DASHES.fullmatch(cell) is not None


def _dates(cells: Any) -> NDArray[np.float64] | None:
    """Seconds (N,) since the first of a column of dates as ISO 8601 writes them, NaN where a cell
    is empty; None if the column holds anything else."""
    import pandas as pd

    there = cells.dropna()
    if there.empty or not isinstance(there.iloc[0], str) or not _DATE.fullmatch(there.iloc[0]):
        return None
    try:
        dates = pd.to_datetime(cells, format="ISO8601", utc=True)
    except ValueError:
        return None
    return np.asarray((dates - dates.dropna().iloc[0]).dt.total_seconds(), dtype=np.float64)
