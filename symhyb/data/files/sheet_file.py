"""Excel files: .xlsx and the older .xls; the first row of a sheet that is not empty names the
columns. Every sheet is a part of the file if there are several."""

import io
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING
from zipfile import BadZipFile, ZipFile

from symhyb.data.files.cells import column_of, twice
from symhyb.data.files.extras import needed
from symhyb.data.files.table import Column, Table, refusal
from symhyb.limits import PACKED_LEAST, PACKED_TIMES

if TYPE_CHECKING:
    import pandas as pd

_ZIP, _OLE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_ANCIENT = (b"\x09\x00\x04\x00", b"\x09\x02\x06\x00", b"\x09\x04\x06\x00")  # before 1995
_LOCKED = "EncryptedPackage".encode("utf-16-le")


def read_excel(content: bytes, file: str) -> Table:
    """Read the sheets of an Excel file, old or new; formulas give the values saved with them.

    The content says which of the two it is, whatever the name ends in.

    Raises:
        InputError: openpyxl (xlrd for old files) is not installed, the file is encrypted, damaged
            or another format, or no sheet holds a table.
    """
    if content.startswith(_ZIP):
        needed("openpyxl", "excel", file)
        _refuse_bomb(content, file)
        return _read(content, file, "openpyxl")
    if not content.startswith((_OLE, *_ANCIENT)):
        ending = file.rpartition(".")[2]
        text = f"is not an Excel file, although its name ends in .{ending}"
        raise refusal(file, text + "; if it is text, let it end in .csv")
    if _LOCKED in content:
        raise refusal(file, "is encrypted; save it without a password")
    needed("xlrd", "excel", file)
    return _read(content, file, "xlrd")


def _refuse_bomb(content: bytes, file: str) -> None:
    """Refuse an archive whose directory says that it unpacks to far more than a table does."""
    try:
        with ZipFile(io.BytesIO(content)) as archive:
            size = sum(item.file_size for item in archive.infolist())
    except (BadZipFile, ValueError, OverflowError, NotImplementedError):
        return  # what is damaged is complained of when it is read
    if size > max(PACKED_LEAST, PACKED_TIMES * len(content)):
        text = f"unpacks to {size / 1e6:.0f} MB, more than {PACKED_TIMES} times its own size"
        raise refusal(file, text)


def _read(content: bytes, file: str, engine: str) -> Table:
    import pandas as pd

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # openpyxl warns of styles and pictures
            frames = pd.read_excel(
                io.BytesIO(content),
                sheet_name=None,
                header=None,
                engine=engine,  # type: ignore[call-overload]
            )
    except ImportError as error:
        cure = 'pip install --upgrade "symhyb[excel]"'
        raise refusal(file, f"cannot be read: {error}; {cure}") from None
    except Exception as error:  # damaged bytes make the readers raise errors of a dozen kinds
        if "encrypted" in str(error).lower():
            raise refusal(file, "is encrypted; save it without a password") from error
        text = f"is a damaged or cut off Excel file: {type(error).__name__}: {error}"
        raise refusal(file, text) from error
    sheets = {str(name): frame for name, frame in frames.items() if not frame.empty}
    if not sheets:
        raise refusal(file, "all sheets are empty")
    columns: list[Column] = []
    notes: list[str] = []
    for name, frame in sheets.items():
        found, said = _sheet(frame, file)
        if not found:
            notes.append(f"sheet {name} holds no table with a header: left out")
        part = name if len(sheets) > 1 else ""
        columns += [_placed(column, part) for column in found]
        notes += said
    if not columns:
        text = "no sheet has a row with the names of the columns and numbers below it"
        raise refusal(file, text)
    return Table(file, tuple(columns), tuple(notes))


def _sheet(frame: "pd.DataFrame", file: str) -> tuple[list[Column], list[str]]:
    """Read one sheet; without a row of names, or without a row below it, it holds no columns."""
    filled = frame.notna().any(axis=1).to_numpy()
    if filled.sum() < 2:
        return [], []
    top = int(filled.argmax())
    headers = ["" if cell != cell else str(cell).strip() for cell in frame.iloc[top]]
    if not any(isinstance(cell, str) for cell in frame.iloc[top]):
        return [], []
    last = frame.shape[0] - int(filled[::-1].argmax())
    body = frame.iloc[top + 1 : last]
    doubled = twice([header for header in headers if header], file)
    columns, notes = [], []
    for place, header in enumerate(headers):
        cells = body.iloc[:, place]
        if not header and cells.isna().all():
            continue
        column, note = column_of(header or f"column {place + 1}", cells, file, top + 2)
        columns.append(replace(column, problem=doubled.get(header, column.problem)))
        notes += [note] if note else []
    return columns, notes


def _placed(column: Column, part: str) -> Column:
    if not part:
        return column
    return replace(column, header=f"{part}.{column.header}", part=part, inside=column.header)
