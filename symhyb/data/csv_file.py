"""Delimited text: comma, semicolon or tab, with a header line of column names."""

import csv
import io
import re

import numpy as np
from numpy.typing import NDArray

from symhyb.data.table import Column, Table, refusal
from symhyb.errors import Problem

_DELIMITERS = (",", ";", "\t")
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
    number, first = lines[0]
    delimiter = max(_DELIMITERS, key=first.count)
    header = [cell.strip() for cell in _cells(first, delimiter)]
    rows = lines[1:]
    if not any(header) or all(_is_number(cell) for cell in header if cell):
        raise refusal(file, "a first line with the names of the columns is required", number)
    if len(header) == 1 and rows and len(rows[0][1].split()) > 1:
        raise refusal(file, "no comma, semicolon or tab separates the names of the columns", number)
    if not rows:
        raise refusal(file, "there is a header but no row below it")
    _refuse_ragged(rows, delimiter, len(header), file)
    body = "\n".join(line for _, line in rows)
    commas = delimiter != "," and any(map(_DECIMAL_COMMA.fullmatch, _cells(rows[0][1], delimiter)))
    numbers = np.array([number for number, _ in rows])
    columns = _columns(body, header, delimiter, "," if commas else ".", numbers, file)
    notes = ("numbers are written with a decimal comma",) if commas else ()
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


def _cells(line: str, delimiter: str) -> list[str]:
    if '"' not in line:
        return line.split(delimiter)
    return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _refuse_ragged(rows: list[tuple[int, str]], delimiter: str, width: int, file: str) -> None:
    """Refuse rows that are longer or shorter than the header: pandas would shift or fill them."""
    wrong = [
        (number, count) for number, line in rows if (count := len(_cells(line, delimiter))) != width
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
    columns = []
    for place, name in enumerate(header):
        cells = frame[place]
        if not name and cells.isna().all():
            continue  # a delimiter at the end of every line
        values = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=np.float64)
        bad = np.flatnonzero(np.isnan(values) & cells.notna().to_numpy())
        problem = None
        if header.count(name) > 1 and name:
            problem = Problem("stands more than once in the header", f"column '{name}'", file)
        elif bad.size:
            cell = str(cells.iloc[bad[0]])
            text = f"'{cell[:40]}' is not a number"
            more = f" ({bad.size} such cells)" if bad.size > 1 else ""
            problem = Problem(text + more, f"column '{name}'", file, int(lines[bad[0]]))
        columns.append(Column(name or f"column {place + 1}", values, problem))
    return tuple(columns)
