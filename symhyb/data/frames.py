"""Frames of pandas and datasets of xarray as named columns, as a file has them.

Values are in the units that columns state, or in those of the model file; where
:mod:`symhyb.framed` wrote them, ``attrs["units"]`` says which.
"""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from symhyb.data.files.cells import column_of, twice
from symhyb.data.files.table import Column, Table, refusal, split_unit
from symhyb.errors import InputError, Problem, did_you_mean, visible
from symhyb.framed import SI, UNITS, the_xarray
from symhyb.units import UnitError, parse_unit

if TYPE_CHECKING:
    import pandas as pd


def table_of_frame(frame: object, units: Mapping[str, str] | None, name: str) -> Table:
    """The columns of a frame, or of a mapping of columns, each with its unit in its header.

    The unit of a column is that in ``units``, else that behind its name (``laser [mm]``), else that
    in ``attrs["units"]``. The index is a column too unless it only counts the rows: under its name,
    or as ``t``.

    Raises:
        InputError: no frame, several levels of rows or columns, or ``units`` of no column.
    """
    frame = _as_frame(frame, name)
    series = list(_series(frame, name))
    asked, stated = dict(units or {}), _stated(frame.attrs)
    _require_units(asked, [label for label, _ in series], name)
    doubled = twice([visible(str(label)) for label in frame.columns], name)
    columns, notes = [], []
    for label, cells in series:
        column, note = column_of(_header(label, asked, stated), cells, name, 1)
        problem = doubled.get(label, column.problem)
        columns.append(Column(column.header, column.values, problem))
        notes += [note] if note else []
    return Table(name, tuple(columns), tuple(notes))


def table_of_dataset(dataset: object, units: Mapping[str, str] | None, name: str) -> Table:
    """The variables of a dataset of xarray along its one dimension, with their ``units``.

    Raises:
        InputError: xarray is not installed, this is no dataset, or it has several dimensions.
    """
    xarray = the_xarray()
    if isinstance(dataset, xarray.DataArray):
        dataset = dataset.to_dataset(name=dataset.name or "values")
    if not isinstance(dataset, xarray.Dataset):
        text = f"must be a Dataset or a DataArray of xarray, not {type(dataset).__name__}"
        raise refusal(name, text)
    if len(dataset.dims) != 1:
        listed = ", ".join(map(str, dataset.dims)) or "none"
        text = f"must have one dimension, the time; it has {listed}: choose with .sel or .isel"
        raise refusal(name, text)
    along = [key for key, variable in dataset.variables.items() if variable.ndim == 1]
    frame = dataset[[key for key in along if key not in dataset.dims]].to_dataframe()
    frame.attrs[UNITS] = {
        str(key): text for key in along if (text := str(dataset[key].attrs.get(UNITS, "")).strip())
    }
    return table_of_frame(frame, units, name)


def _as_frame(frame: object, name: str) -> "pd.DataFrame":
    import pandas as pd

    if isinstance(frame, pd.DataFrame):
        return frame
    if not isinstance(frame, Mapping):
        text = (
            "must be a frame of pandas or a mapping of names to columns, "
            f"not {type(frame).__name__}; a file is read by read_recording"
        )
        raise refusal(name, text)
    try:
        return pd.DataFrame(dict(frame))
    except ValueError as error:
        raise refusal(name, f"is no table: {error}") from None


def _series(frame: "pd.DataFrame", name: str) -> Iterator[tuple[str, "pd.Series[Any]"]]:
    """The columns by name, the index first where it says something."""
    import pandas as pd

    for levels, what in ((frame.index.nlevels, "rows"), (frame.columns.nlevels, "columns")):
        if levels > 1:
            text = f"has {levels} levels of {what}; choose one, as in frame.xs(...)"
            raise refusal(name, text)
    if frame.empty:
        raise refusal(name, "has no row or no column")
    known = {split_unit(visible(str(label)))[0] for label in frame.columns}
    counts = isinstance(frame.index, pd.RangeIndex) and frame.index.name is None
    label = "t" if frame.index.name is None else visible(str(frame.index.name))
    if not counts and split_unit(label)[0] not in known:
        yield label, frame.index.to_series().reset_index(drop=True)
    for number, column in enumerate(frame.columns):
        yield visible(str(column)), frame.iloc[:, number].reset_index(drop=True)


def _stated(attrs: Mapping[Any, Any]) -> dict[str, str]:
    """The units that a frame carries, where it does."""
    found = attrs.get(UNITS)
    if not isinstance(found, Mapping):
        return {}
    return {str(key): str(text) for key, text in found.items()}


def _header(label: str, asked: Mapping[str, str], stated: Mapping[str, str]) -> str:
    """The header of a column with the unit that goes first."""
    bare, own = split_unit(label)
    for unit in (asked.get(label), asked.get(bare), own, stated.get(bare)):
        if unit is not None:
            return f"{bare} [{unit.strip() or '1'}]"
    return label


def _require_units(asked: Mapping[str, str], labels: list[str], name: str) -> None:
    """Refuse units of columns that are not there, and texts that are no unit."""
    known = [split_unit(label)[0] for label in labels]
    problems = []
    for key, text in asked.items():
        if key not in known and key not in labels:
            near = did_you_mean(key, known)
            problems.append(Problem(f"is a unit of no column{near}", f"units['{key}']", name))
        try:
            parse_unit("1" if text == SI else text)
        except UnitError as error:
            problems.append(Problem(str(error), f"units['{key}']", name))
    if problems:
        raise InputError(problems)
