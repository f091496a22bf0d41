"""Parquet: columns of numbers, flags and dates; the rest is said and left out."""

from collections.abc import Iterator
from os import SEEK_END
from typing import Any

from symhyb.data.files.cells import column_of, twice
from symhyb.data.files.extras import needed
from symhyb.data.files.table import Column, Table, headed, refusal
from symhyb.errors import InputError

_MAGIC, _LOCKED = b"PAR1", b"PARE"
_ROW_NAMES = "__index_level_"  # what pandas calls the names of its rows


def read_parquet(content: bytes, file: str) -> Table:
    """Read the columns (N,) of a Parquet file; a field may state its ``unit`` in its metadata.

    Raises:
        InputError: pyarrow is not installed, the file is encrypted, damaged, cut off or empty.
    """
    _require_whole(content[: len(_MAGIC)], content[-len(_MAGIC) :], file)
    arrow = needed("pyarrow", "parquet", file)
    parquet = needed("pyarrow.parquet", "parquet", file)
    try:
        table = parquet.ParquetFile(arrow.BufferReader(content)).read()
        columns, notes = _columns(table, arrow, file)
    except Exception as error:  # damaged bytes make Arrow raise errors of many kinds
        raise _damaged(file, error) from error
    if table.num_rows == 0:
        raise refusal(file, "has columns but no row")
    return Table(file, tuple(columns), tuple(notes))


def parquet_pieces(path: str, file: str, rows: int) -> Iterator[Table]:
    """Read the columns (N,) of a Parquet file, about so many ``rows`` at a time.

    Raises:
        InputError: as :func:`read_parquet`.
    """
    with open(path, "rb") as stream:
        begin = stream.read(len(_MAGIC))
        stream.seek(-min(stream.seek(0, SEEK_END), len(_MAGIC)), SEEK_END)
        _require_whole(begin, stream.read(), file)
    arrow = needed("pyarrow", "parquet", file)
    parquet = needed("pyarrow.parquet", "parquet", file)
    first = 0
    try:
        opened = parquet.ParquetFile(path, pre_buffer=False)
        batches = opened.iter_batches(batch_size=rows, use_threads=False)
        for batch in batches:
            table = arrow.Table.from_batches([batch])
            columns, notes = _columns(table, arrow, file)
            yield Table(file, tuple(columns), tuple(notes), first=first)
            first += table.num_rows
    except Exception as error:  # damaged bytes make Arrow raise errors of many kinds
        raise _damaged(file, error) from error
    if first == 0:
        raise refusal(file, "has columns but no row")


def _require_whole(begin: bytes, end: bytes, file: str) -> None:
    if end.endswith(_LOCKED):
        raise refusal(file, "is encrypted; save it without a key")
    if begin != _MAGIC:
        raise refusal(file, "is not a Parquet file, although its name ends in .parquet")
    if end != _MAGIC:
        raise refusal(file, "is cut off: the end of a Parquet file is missing")


def _damaged(file: str, error: Exception) -> InputError:
    return refusal(file, f"is a damaged Parquet file: {str(error).splitlines()[0]}")


def _columns(table: Any, arrow: Any, file: str) -> tuple[list[Column], list[str]]:
    columns: list[Column] = []
    notes: list[str] = []
    doubled = twice(table.column_names, file)
    for field, values in zip(table.schema, table.columns, strict=True):
        name = field.name
        if name.startswith(_ROW_NAMES):
            continue
        if not _is_numeric(field.type, arrow):
            notes.append(f"column {name} is {field.type}, not numbers: left out")
            continue
        header = headed(name, (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace"))
        column, note = column_of(header, values.to_pandas(), file, 1)
        problem = doubled.get(name, column.problem)
        columns.append(Column(column.header, column.values, problem))
        notes += [note] if note else []
    return columns, notes


def _is_numeric(kind: Any, arrow: Any) -> bool:
    types = arrow.types
    return any(
        test(kind)
        for test in (
            types.is_integer,
            types.is_floating,
            types.is_boolean,
            types.is_decimal,
            types.is_timestamp,
            types.is_duration,
            types.is_null,
        )
    )
