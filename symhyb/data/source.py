"""Where one channel comes from: a column or an expression in columns, and its unit.

Units come from the map (``qm [mm]``), else from the header (``laser [mm]``), else from the model.
In an expression the columns are plain numbers in the unit of the file, and the result is in the
unit of the map, else of the model; if instead the headers state units and the map does not, the
columns enter in SI and their units are multiplied out.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.table import PART, Column, Table, split_unit
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.framed import SI
from symhyb.model.expression import (
    Expression,
    ExpressionError,
    Name,
    evaluate,
    names,
    parse_expression,
    readings,
    tables_in,
    unit_of,
)
from symhyb.units import ONE, Unit, UnitError, parse_unit

INDEX = "index"
GRAVITY = "g"  # the unit of an accelerometer; elsewhere a gram
STANDARD_GRAVITY = replace(parse_unit("m/s^2"), text=GRAVITY, factor=9.80665)
_DOTTED = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\.\w+)+")


@dataclass(frozen=True, slots=True)
class Wanted:
    """A channel of the model: ``role`` is ``time``, ``input``, ``coordinate`` or ``sensor``."""

    role: str
    name: str
    unit: Unit

    def __str__(self) -> str:
        return f"{self.role} {self.name}"


@dataclass(frozen=True, slots=True)
class Source:
    """A channel's column, or expression in ``columns``, and the factor that makes it SI.

    ``names`` are what the expression calls the columns. ``headed`` says that the columns enter in
    SI, because their headers state units.
    """

    origin: Expression | Column
    columns: tuple[Column, ...]
    factor: float
    headed: bool = False
    names: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """What the source is, for sentences and to distinguish sources."""
        return self.origin.header if isinstance(self.origin, Column) else self.origin.text

    @property
    def part(self) -> str:
        """The one part of the file that all its columns stand in, else empty."""
        parts = {column.part for column in self.columns if column.values.ndim}
        return parts.pop() if len(parts) == 1 else ""


def find_source(text: str, channel: Wanted, table: Table, part: str = "") -> Source:
    """Read one entry of the map: a column first, an expression in columns else.

    A name is looked up in ``part`` of the file before all others.

    Raises:
        InputError: no such column, one in several parts, a column that is not numeric, or a unit
            that does not fit.
    """
    base, stated = split_unit(text)
    column = _column(text.strip(), channel, table, part) or _column(base, channel, table, part)
    unit = _unit(stated, channel, table)
    if column is not None:
        source = _plain(column, unit, channel, table)
    else:
        source = _computed(base, unit, channel, table, part)
    if channel.role != "input" and not has_rows(source):
        sentence = f"'{text}' is a single number, not a column"
        raise InputError(Problem(sentence, str(channel), table.file))
    return source


def signal(source: Source, size: int, first: int = 0) -> NDArray[np.float64]:
    """Compute a channel in SI, (N,) with N = ``size``; a single number is held. ``first`` is the
    number of the first row."""
    if isinstance(source.origin, Column):
        values = source.origin.values
    else:
        known: dict[tuple[str, int] | str, NDArray[np.float64] | float] = {
            INDEX: np.arange(first, first + size, dtype=np.float64)
        }
        for name, column in zip(source.names, source.columns, strict=True):
            unit = parse_unit(column.unit) if source.headed and column.unit else ONE
            known[name] = column.values * unit.factor
        values = evaluate(source.origin, known)
    return np.array(np.broadcast_to(values * source.factor, size), dtype=np.float64)


def has_rows(source: Source) -> bool:
    """Say whether the source is a column, or counts rows, and is not a single number."""
    counts = isinstance(source.origin, Expression) and Name(INDEX) in names(source.origin)
    return counts or any(column.values.ndim for column in source.columns)


def _column(name: str, channel: Wanted, table: Table, part: str) -> Column | None:
    found = table.find(name, part)
    if len(found) > 1:
        raise InputError(Problem(_in_parts(name, found, channel, table), str(channel), table.file))
    return found[0] if found else None


def _in_parts(name: str, found: tuple[Column, ...], channel: Wanted, table: Table) -> str:
    """Say that several parts of a file have a column, and how one of them is read."""
    first = found[0]
    parts = [column.part for column in found]
    listed = ", ".join(parts[:12]) + " …" * (len(found) > 12)
    text = f"the column '{name}' is in {len(found)} parts of the file ({listed})"
    if not table.run:
        cure = f"say which, as in {channel.name}={first.name}"
        return f"{text}; {cure}, or read one part, as in '{table.file}{PART}{first.part}'"
    last = f"{PART}{table.run}"
    file = table.file.removesuffix(last)
    if all(part.isdecimal() for part in parts):  # cells are asked for by their numbers
        return (
            f"{text}, and none of them is '{table.run}'; read one, as in '{file}{PART}{parts[-1]}'"
        )
    return (
        f"{text}; '{last}' counts runs and not parts: name the part first, as in"
        f" '{file}{PART}{first.part}', and the run behind it if there are several, as in"
        f" '{file}{PART}{first.part}{PART}1'"
    )


def _plain(column: Column, unit: Unit | None, channel: Wanted, table: Table) -> Source:
    if column.problem is not None:
        raise InputError(column.problem)
    headed = _unit(column.unit, channel, table)
    if unit is not None and headed is not None and unit.factor != headed.factor:
        sentence = f"the map says {unit}, but the header is '{column.header}'"
        raise InputError(Problem(sentence, str(channel), table.file))
    return Source(column, (column,), (unit or headed or channel.unit).factor)


def _computed(text: str, unit: Unit | None, channel: Wanted, table: Table, part: str) -> Source:
    flat, dotted = _flat(text, table)
    expression = _expression(flat, text, channel, table)
    used = _columns_of(expression, dotted, channel, table, part)
    own, columns = tuple(used), tuple(used.values())
    if unit is None and any(column.unit is not None for column in columns):
        _check_dimension(expression, used, channel, table)
        return Source(expression, columns, 1.0, True, own)
    return Source(expression, columns, (unit or channel.unit).factor, False, own)


def _flat(text: str, table: Table) -> tuple[str, dict[str, str]]:
    """Write plain names for dotted ones (``run.laser``), which the grammar does not have."""
    plain: dict[str, str] = {}
    if any("." in column.name for column in table.columns):
        for name in sorted(set(_DOTTED.findall(text)), key=len, reverse=True):
            plain[name] = f"part_{len(plain)}_"
    flat = _DOTTED.sub(lambda found: plain.get(found[0], found[0]), text)
    return flat, {alias: name for name, alias in plain.items()}


def _expression(flat: str, text: str, channel: Wanted, table: Table) -> Expression:
    try:
        expression = replace(parse_expression(flat), text=text)
        if readings(expression):
            raise ExpressionError(f"'{text}' asks for what a sensor of the model shows")
        for word, _ in tables_in(expression):
            raise ExpressionError(f"'{text}' asks for a {word}, which stands in a model file alone")
    except ExpressionError as error:
        hint = did_you_mean(text, table.names())
        sentence = f"'{text}' is no column{hint}; and as an expression in columns: {error}"
        raise InputError(Problem(sentence, str(channel), table.file)) from error
    return expression


def _columns_of(
    expression: Expression, dotted: Mapping[str, str], channel: Wanted, table: Table, part: str
) -> dict[str, Column]:
    """Find the columns that an expression names, by their names there; ``index`` is built in."""
    found: dict[str, Column] = {}
    problems: list[Problem] = []
    for name in sorted(names(expression), key=str):
        written = dotted.get(name.name, name.name)
        column = _column(written, channel, table, part) if name.order == 0 else None
        if column is None and name != Name(INDEX):
            called = written + "'" * name.order
            text = f"there is no column '{called}'{did_you_mean(called, table.names())}"
            problems.append(Problem(text, str(channel), table.file))
        elif column is not None and column.problem is not None:
            problems.append(column.problem)
        elif column is not None:
            found[name.name] = column
    if problems:
        raise InputError(problems)
    return found


def _unit(text: str | None, channel: Wanted, table: Table) -> Unit | None:
    """Parse a unit in brackets and check that it measures the same thing as the channel."""
    if text is None:
        return None
    if text.strip() == GRAVITY and channel.unit.same_dimension(STANDARD_GRAVITY):
        return STANDARD_GRAVITY
    if text.strip() == SI:
        return replace(channel.unit, text=SI, factor=1.0)
    try:
        unit = parse_unit(text)
    except UnitError as error:
        raise InputError(Problem(f"[{text}]: {error}", str(channel), table.file)) from error
    if not unit.same_dimension(channel.unit):
        sentence = f"the column is in {unit}, but the model declares {channel.unit}"
        raise InputError(Problem(sentence, str(channel), table.file))
    return unit


def _check_dimension(
    expression: Expression, used: Mapping[str, Column], channel: Wanted, table: Table
) -> None:
    """Multiply out the units of the headers; a column without a unit makes that impossible."""
    text = expression.text
    cure = f"state the unit of the result, as in '{text} [{channel.unit}]'"
    bare = [column.name for column in used.values() if column.unit is None]
    sentence = ""
    try:
        units: Mapping[str, Unit] = {name: parse_unit(c.unit or "1") for name, c in used.items()}
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
