"""Columns of numbers out of the columns of a pandas frame: dates in seconds, words a problem."""

from collections import Counter
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.table import Column, headed
from symhyb.errors import Problem

if TYPE_CHECKING:
    import pandas as pd


def column_of(header: str, cells: "pd.Series[Any]", file: str, first: int) -> tuple[Column, str]:
    """Return ``cells`` (N,) as a column in the unit of the file, and a note, empty if none.

    Dates are counted in s from the first one. ``first`` is the number of the row, as the file
    counts, that the first cell stands in; a cell that is no number makes the column unusable.
    """
    import pandas as pd

    if not pd.api.types.is_numeric_dtype(cells.dtype):
        cells = cells.infer_objects()
    if pd.api.types.is_datetime64_any_dtype(cells.dtype):
        since = cells.dropna().iloc[0] if cells.notna().any() else None
        note = f"column {header} holds dates: counted in s from the first, {since}"
        return Column(headed(header, "s"), _seconds(cells - since)), note
    if pd.api.types.is_timedelta64_dtype(cells.dtype):
        return Column(headed(header, "s"), _seconds(cells)), ""
    if pd.api.types.is_complex_dtype(cells.dtype):
        values = np.full(cells.size, np.nan)
        return Column(header, values, Problem("is complex", f"column '{header}'", file)), ""
    values = numbers_in(cells)
    bad = np.flatnonzero(np.isnan(values) & cells.notna().to_numpy())
    bad = np.array([k for k in bad if not _is_nan(cells.iloc[k])], dtype=np.intp)
    if not bad.size:
        return Column(header, values), ""
    more = f" ({bad.size} such cells)" if bad.size > 1 else ""
    text = f"'{str(cells.iloc[bad[0]])[:40]}' is not a number, in row {first + bad[0]}{more}"
    return Column(header, values, Problem(text, f"column '{header}'", file)), ""


def numbers_in(cells: "pd.Series[Any]") -> NDArray[np.float64]:
    """The numbers (N,) of cells in the unit of the file, NaN where one is none; a number beyond any
    float is infinite."""
    import pandas as pd

    try:
        found = pd.to_numeric(cells, errors="coerce")
    except OverflowError:
        found = pd.to_numeric(cells.map(_as_float), errors="coerce")
    return np.asarray(found.to_numpy(dtype=np.float64, na_value=np.nan))


def _as_float(cell: object) -> object:
    if not isinstance(cell, int):
        return cell
    try:
        return float(cell)
    except OverflowError:
        return inf if cell > 0 else -inf


def twice(headers: list[str], file: str) -> dict[str, Problem]:
    """Return a problem for every header that stands more than once."""
    return {
        name: Problem("stands more than once in the header", f"column '{name}'", file)
        for name, often in Counter(headers).items()
        if often > 1
    }


def _seconds(durations: "pd.Series[Any]") -> NDArray[np.float64]:
    return np.asarray(durations.dt.total_seconds(), dtype=np.float64)


def _is_nan(cell: object) -> bool:
    return isinstance(cell, float) and cell != cell
