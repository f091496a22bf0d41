"""Which column is which channel: by equal name or by a map, converted to SI.

A map is ``{channel: column}``, where the column may also be an expression in columns and the
built-in ``index`` (row number from 0), and may end with a unit: ``{"laser": "roll angle [deg]",
"f": "gtau*vir", "t": "index/610.35"}``.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.data.source import INDEX, Source, Wanted, find_source, signal
from symhyb.data.table import Table
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.types import Model
from symhyb.units import parse_unit


@dataclass(frozen=True, slots=True)
class Channels:
    """What a file says about a model: ``t`` (N,) in s, inputs and sensors (N,) in SI.

    Nothing is cleaned yet. ``notes`` are sentences on what was left out.
    """

    t: NDArray[np.float64]
    inputs: Mapping[str, NDArray[np.float64]]
    sensors: Mapping[str, NDArray[np.float64]]
    notes: tuple[str, ...]


def map_columns(table: Table, model: Model, columns: Mapping[str, str] | None = None) -> Channels:
    """Find the column of every channel of ``model`` in ``table``.

    Raises:
        InputError: all problems at once: keys of the map that are no channel, columns that do not
            exist or are no numbers, units that do not fit, inputs without a column.
    """
    columns = dict(columns or {})
    wanted = tuple(_wanted(model))
    named = {channel: columns.get(channel.name, _equal(channel, table)) for channel in wanted}
    problems = [*_unknown_keys(columns, wanted, table), *_missing(named, table)]
    sources: dict[Wanted, Source] = {}
    for channel, text in named.items():
        try:
            if text is not None:
                sources[channel] = find_source(text, channel, table)
        except InputError as error:
            problems.extend(error.problems)
    if problems:
        raise InputError(dict.fromkeys(problems))
    size = _size(sources, table)
    signals = {channel: signal(source, size) for channel, source in sources.items()}

    def of(role: str) -> dict[str, NDArray[np.float64]]:
        return {channel.name: signals[channel] for channel in signals if channel.role == role}

    left_out = [f"{channel} has no column: left out" for channel in wanted if not named[channel]]
    notes = (*table.notes, *left_out, *_unused(table, sources.values()))
    return Channels(of("time")["t"], of("input"), of("sensor"), notes)


def _wanted(model: Model) -> Iterator[Wanted]:
    yield Wanted("time", "t", parse_unit("s"))
    for driver in model.inputs:
        yield Wanted("input", driver.name, driver.unit)
    for sensor in model.sensors:
        yield Wanted("sensor", sensor.name, sensor.unit)


def _equal(channel: Wanted, table: Table) -> str | None:
    """Return the header of the column with the channel's name, whatever unit stands behind it."""
    for column in table.columns:
        if channel.name in (column.header, column.name):
            return column.header
    return None


def _size(sources: Mapping[Wanted, Source], table: Table) -> int:
    """Return the number of rows, on which all columns in use must agree."""
    lengths = {
        column.name: column.values.size
        for source in sources.values()
        for column in source.columns
        if column.values.ndim
    }
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        text = f"the columns in use differ in their number of rows: {listed}"
        raise InputError(Problem(text, file=table.file))
    return next(iter(lengths.values()), 0)


def _unknown_keys(
    columns: Mapping[str, str], wanted: tuple[Wanted, ...], table: Table
) -> Iterator[Problem]:
    known = list(dict.fromkeys(channel.name for channel in wanted))
    for key, text in columns.items():
        if key not in known:
            sentence = f"the model has no input or sensor '{key}'{did_you_mean(key, known)}"
            yield Problem(sentence, f"{key}={text}", table.file)


def _missing(named: Mapping[Wanted, str | None], table: Table) -> Iterator[Problem]:
    """Complain of a time or an input without a column, and if no sensor at all has one."""
    for channel, text in named.items():
        if text is None and channel.role != "sensor":
            example = f"{channel.name}=…"
            if channel.role == "time":
                example = f"t={INDEX}/1000 at 1000 Hz"
            yield Problem(
                f"has no column{did_you_mean(channel.name, table.names())}"
                f"; say in the map what it is, as in {example}",
                str(channel),
                table.file,
            )
    sensors = {channel.name: text for channel, text in named.items() if channel.role == "sensor"}
    if all(text is None for text in sensors.values()):
        example = f"; map one, as in {next(iter(sensors))}=…" if sensors else ""
        yield Problem(
            f"no sensor of the model ({', '.join(sensors) or 'it has none'}) has a column"
            f" (columns: {', '.join(table.names()) or 'none'}){example}"
            + "".join(f"; {note}" for note in table.notes),
            file=table.file,
        )


def _unused(table: Table, sources: Iterable[Source]) -> Iterator[str]:
    used = {column.header for source in sources for column in source.columns}
    rest = [column.name for column in table.columns if column.header not in used]
    if rest:
        verb = "columns {} are" if len(rest) > 1 else "column {} is"
        yield verb.format(", ".join(rest)) + " not used"
