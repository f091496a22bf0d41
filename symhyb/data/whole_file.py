"""A file without a model: every column of numbers as a sensor, in the unit of the file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from symhyb.data.columns import TIMES, map_columns
from symhyb.data.files.stamps import CLOCKS
from symhyb.data.files.table import Column, Table
from symhyb.data.recording import Recording, recorded
from symhyb.data.rows import Span
from symhyb.data.source import INDEX
from symhyb.errors import InputError, Problem
from symhyb.model.expression import parse_expression
from symhyb.model.types import Model, Sensor
from symhyb.units import Unit

TIME = "t"


@dataclass(frozen=True, slots=True, eq=False)
class WholeFile:
    """The ``recording`` of a file, whose sensors are its columns in their own units; ``units`` are
    these by name, None where the header states none; ``left`` are sentences on columns that are
    no signals."""

    recording: Recording
    units: Mapping[str, str | None]
    left: tuple[str, ...]


def whole_file(
    table: Table, columns: Mapping[str, str] | None = None, span: Span = (None, None)
) -> WholeFile:
    """Take every column of a table as it is; ``columns`` = {"t": "index/1000"} says what time is
    where no column is called so, and names expressions in columns beside.

    Raises:
        InputError: no time that increases, or no column of numbers.
    """
    asked = dict(columns or {})
    signals = {_name(column, table): column for column in table.columns if _usable(column)}
    signals = {name: one for name, one in signals.items() if not _is_time(one, table, asked)}
    if not signals and asked.keys() <= {TIME}:
        raise InputError(Problem("has no column of numbers beside time", file=table.file))
    units = {name: column.unit for name, column in signals.items()}
    more = {name: text for name, text in asked.items() if name != TIME}
    units |= dict.fromkeys(more)
    bare = [replace(one, header=name) for name, one in signals.items()]
    used = {id(one) for one in signals.values()}
    others = [one for one in table.columns if id(one) not in used]
    plain = replace(table, columns=(*bare, *others), notes=table.notes)
    clock = {TIME: asked[TIME]} if TIME in asked else {}
    model = _model(units)
    recording = recorded(plain, map_columns(plain, model, {**clock, **more}), model, span)
    hidden = (" not used", "left out")
    notes = tuple(note for note in recording.notes if not note.endswith(hidden[0]))
    return WholeFile(replace(recording, notes=notes), units, tuple(_left(table)))


def _model(units: Mapping[str, str | None]) -> Model:
    """A model of nothing but sensors. The factor of each unit is 1: nothing is converted."""
    clock = parse_expression("t")
    sensors = (Sensor(name, clock, Unit(text=unit or "1")) for name, unit in units.items())
    return Model("", (), sensors=tuple(sensors))


def _usable(column: Column) -> bool:
    return column.problem is None and column.values.ndim == 1 and column.values.size > 0


def _name(column: Column, table: Table) -> str:
    """What a column is called: its name, or with its unit or part where several share that."""
    same = [one for one in table.columns if one.name == column.name]
    return column.name if len(same) == 1 and column.name else column.header


def _is_time(column: Column, table: Table, asked: Mapping[str, str]) -> bool:
    """Whether a column is the time of the file, which is no signal."""
    wanted = asked.get(TIME, "")
    if wanted and wanted.strip() in (column.header, column.name):
        return True
    if column.name == TIME or (column.name == INDEX and not wanted):
        return True
    if column.part and column.local in CLOCKS:
        return True
    usual = [one for one in table.columns if _called_time(one.name)]
    return TIME not in asked and [column] == usual and not table.find(TIME)


def _called_time(name: str) -> bool:
    small = name.lower()
    return any(small == one or small.startswith((f"{one}_", f"{one} ")) for one in TIMES)


def _left(table: Table) -> Iterator[str]:
    """Say which columns are no signals."""
    for column in table.columns:
        if column.problem is not None:
            yield f"{column.name}: {column.problem.text}"
        elif column.values.ndim == 0:
            number = f"{float(column.values):.6g} {column.unit or ''}".rstrip()
            yield f"{column.name} is a single number: {number}"
