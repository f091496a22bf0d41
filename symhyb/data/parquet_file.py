"""Parquet: columns of numbers, flags and dates; the rest is said and left out."""

from typing import Any

from symhyb.data.cells import column_of, twice
from symhyb.data.extras import needed
from symhyb.data.table import Column, Table, headed, refusal

_MAGIC, _LOCKED = b"PAR1", b"PARE"
_ROW_NAMES = "__index_level_"  # what pandas calls the names of its rows


def read_parquet(content: bytes, file: str) -> Table:
    """Read the columns (N,) of a Parquet file; a field may state its ``unit`` in its metadata.

    Raises:
        InputError: pyarrow is not installed, the file is encrypted, damaged, cut off or empty.
    """
    if content.endswith(_LOCKED):
        raise refusal(file, "is encrypted; save it without a key")
    if not content.startswith(_MAGIC):
        raise refusal(file, "is not a Parquet file, although its name ends in .parquet")
    if not content.endswith(_MAGIC):
        raise refusal(file, "is cut off: the end of a Parquet file is missing")
    arrow = needed("pyarrow", "parquet", file)
    parquet = needed("pyarrow.parquet", "parquet", file)
    try:
        table = parquet.ParquetFile(arrow.BufferReader(content)).read()
        columns, notes = _columns(table, arrow, file)
    except Exception as error:  # damaged bytes make Arrow raise errors of many kinds
        text = f"is a damaged Parquet file: {str(error).splitlines()[0]}"
        raise refusal(file, text) from error
    if table.num_rows == 0:
        raise refusal(file, "has columns but no row")
    return Table(file, tuple(columns), tuple(notes))


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
