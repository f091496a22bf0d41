"""Where one channel comes from: a column or an expression in columns, and its unit.

Units come from the map (``qm [mm]``), else from the header (``laser [mm]``), else from the model.
In an expression the columns are plain numbers in the unit of the file, and the result is in the
unit of the map, else of the model; if instead the headers state units and the map does not, the
columns enter in SI and their units are multiplied out.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.data.table import Column, Table, split_unit
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.expression import (
    Expression,
    ExpressionError,
    Name,
    evaluate,
    names,
    parse_expression,
    unit_of,
)
from symhyb.units import ONE, Unit, UnitError, parse_unit

INDEX = "index"


@dataclass(frozen=True, slots=True)
class Wanted:
    """A channel of the model: ``role`` is ``time``, ``input`` or ``sensor``."""

    role: str
    name: str
    unit: Unit

    def __str__(self) -> str:
        return f"{self.role} {self.name}"


@dataclass(frozen=True, slots=True)
class Source:
    """A channel's column, or expression in ``columns``, and the factor that makes it SI.

    ``headed`` says that the columns enter in SI, because their headers state units.
    """

    origin: Expression | Column
    columns: tuple[Column, ...]
    factor: float
    headed: bool = False


def find_source(text: str, channel: Wanted, table: Table) -> Source:
    """Read one entry of the map: a column first, an expression in columns else.

    Raises:
        InputError: no such column, a column that is not numeric, or a unit that does not fit.
    """
    base, stated = split_unit(text)
    column = _column(text.strip(), table) or _column(base, table)
    unit = _unit(stated, channel, table)
    if column is not None:
        source = _plain(column, unit, channel, table)
    else:
        source = _computed(_expression(base, channel, table), unit, channel, table)
    if channel.role != "input" and not _has_rows(source):
        sentence = f"'{text}' is a single number, not a column"
        raise InputError(Problem(sentence, str(channel), table.file))
    return source


def signal(source: Source, size: int) -> NDArray[np.float64]:
    """Compute a channel in SI, (N,) with N = ``size``; a single number is held."""
    if isinstance(source.origin, Column):
        values = source.origin.values
    else:
        known: dict[tuple[str, int] | str, NDArray[np.float64] | float] = {
            INDEX: np.arange(size, dtype=np.float64)
        }
        for column in source.columns:
            unit = parse_unit(column.unit) if source.headed and column.unit else ONE
            known[column.name] = column.values * unit.factor
        values = evaluate(source.origin, known)
    return np.array(np.broadcast_to(values * source.factor, size), dtype=np.float64)


def _column(name: str, table: Table) -> Column | None:
    by_header = (column for column in table.columns if column.header == name)
    by_name = (column for column in table.columns if column.name == name)
    return next(by_header, None) or next(by_name, None)


def _plain(column: Column, unit: Unit | None, channel: Wanted, table: Table) -> Source:
    if column.problem is not None:
        raise InputError(column.problem)
    headed = _unit(column.unit, channel, table)
    if unit is not None and headed is not None and unit.factor != headed.factor:
        sentence = f"the map says {unit}, but the header is '{column.header}'"
        raise InputError(Problem(sentence, str(channel), table.file))
    return Source(column, (column,), (unit or headed or channel.unit).factor)


def _computed(expression: Expression, unit: Unit | None, channel: Wanted, table: Table) -> Source:
    used = _columns_of(expression, channel, table)
    if unit is None and any(column.unit is not None for column in used):
        _check_dimension(expression, used, channel, table)
        return Source(expression, used, 1.0, headed=True)
    return Source(expression, used, (unit or channel.unit).factor)


def _has_rows(source: Source) -> bool:
    counts = isinstance(source.origin, Expression) and Name(INDEX) in names(source.origin)
    return counts or any(column.values.ndim for column in source.columns)


def _expression(text: str, channel: Wanted, table: Table) -> Expression:
    try:
        return parse_expression(text)
    except ExpressionError as error:
        hint = did_you_mean(text, table.names())
        sentence = f"'{text}' is no column{hint}; and as an expression in columns: {error}"
        raise InputError(Problem(sentence, str(channel), table.file)) from error


def _columns_of(expression: Expression, channel: Wanted, table: Table) -> tuple[Column, ...]:
    """Find the columns that an expression names; ``index`` is built in."""
    found: list[Column] = []
    problems: list[Problem] = []
    for name in sorted(names(expression), key=str):
        column = _column(name.name, table) if name.order == 0 else None
        if column is None and name != Name(INDEX):
            text = f"there is no column '{name}'{did_you_mean(str(name), table.names())}"
            problems.append(Problem(text, str(channel), table.file))
        elif column is not None and column.problem is not None:
            problems.append(column.problem)
        elif column is not None:
            found.append(column)
    if problems:
        raise InputError(problems)
    return tuple(found)


def _unit(text: str | None, channel: Wanted, table: Table) -> Unit | None:
    """Parse a unit in brackets and check that it measures the same thing as the channel."""
    if text is None:
        return None
    try:
        unit = parse_unit(text)
    except UnitError as error:
        raise InputError(Problem(f"[{text}]: {error}", str(channel), table.file)) from error
    if not unit.same_dimension(channel.unit):
        sentence = f"the column is in {unit}, but the model declares {channel.unit}"
        raise InputError(Problem(sentence, str(channel), table.file))
    return unit


def _check_dimension(
    expression: Expression, used: tuple[Column, ...], channel: Wanted, table: Table
) -> None:
    """Multiply out the units of the headers; a column without a unit makes that impossible."""
    text = expression.text
    cure = f"state the unit of the result, as in '{text} [{channel.unit}]'"
    bare = [column.name for column in used if column.unit is None]
    sentence = ""
    try:
        units: Mapping[str, Unit] = {c.name: parse_unit(c.unit or "1") for c in used}
        found = unit_of(expression, lambda name: units.get(name.name, ONE))
    except (UnitError, ExpressionError) as error:
        sentence = f"'{text}': {error}"
    else:
        if found is not None and not found.same_dimension(channel.unit):
            sentence = f"'{text}' is in {found}, but the model declares {channel.unit}"
    if bare:
        sentence = f"'{text}' mixes columns with a unit and without one ({', '.join(bare)})"
    if sentence:
        raise InputError(Problem(f"{sentence}; {cure}", str(channel), table.file))
