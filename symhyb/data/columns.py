"""Which column is which channel: by equal name or by a map, converted to SI.

A map is ``{channel: column}``, where the column may also be an expression in columns and the
built-in ``index`` (row number from 0), and may end with a unit: ``{"laser": "roll angle [deg]",
"f": "gtau*vir", "t": "index/610.35"}``. Behind ``@`` stand the times of a channel that has its own:
``{"accel": "acc [g] @ t_acc"}``.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from symhyb.data.channels import Channels
from symhyb.data.files.table import Column, Table, split_unit
from symhyb.data.merge import merged, one_run
from symhyb.data.source import (
    GRAVITY,
    INDEX,
    STANDARD_GRAVITY,
    Source,
    Wanted,
    find_source,
    has_rows,
    signal,
)
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.expression import Name
from symhyb.model.types import Model
from symhyb.units import parse_unit

TIME = Wanted("time", "t", parse_unit("s"))
TIMES = (
    "time",
    "times",
    "timestamp",
    "time stamp",
    "elapsed",
    "elapsed time",
    "zeit",
    "zeitstempel",
    "temps",
)
"""What others call the column of time, in small letters."""
_UNIT_AT_END = re.compile(r"(.+)[_ ](s|sec|ms|us)", re.IGNORECASE)
MOST_NAMES = 12  # columns that a note lists

_Clocked = tuple[Source, Source | None]  # a channel's source and that of its times


def read_map(options: Sequence[str] | None) -> dict[str, str]:
    """Read the options ``--map channel=column``.

    Raises:
        InputError: an option without channel, ``=`` or column, or a channel that stands twice.
    """
    columns: dict[str, str] = {}
    problems = []
    for text in options or ():
        channel, equals, column = (part.strip() for part in text.partition("="))
        if not (channel and equals and column):
            problems.append(Problem("write it as channel=column", f"--map {text}"))
        elif channel in columns:
            problems.append(Problem(f"'{channel}' is mapped twice", f"--map {text}"))
        columns[channel] = column
    if problems:
        raise InputError(problems)
    return columns


def map_columns(table: Table, model: Model, columns: Mapping[str, str] | None = None) -> Channels:
    """Find the column of every channel of ``model`` in ``table``.

    The motion of an imposed coordinate is found like an input, else it is what the sensor records
    that measures it and nothing else. Channels with times of their own are merged, see
    :func:`symhyb.data.merge.merged`.

    Raises:
        InputError: all problems at once: keys of the map that are no channel, columns that do not
            exist or are no numbers, units that do not fit, inputs without a column.
    """
    columns = dict(columns or {})
    wanted = tuple(_wanted(model))
    named = {channel: columns.get(channel.name, _equal(channel, table)) for channel in wanted}
    borrowed = dict(_borrowed(model, named))
    problems = [*_unknown_keys(columns, wanted, table), *_missing(named, borrowed, table)]
    found: dict[Wanted, _Clocked] = {}
    for channel, text in named.items():
        try:
            if text is not None and channel != TIME:
                found[channel] = _clocked(text, channel, named[TIME], table)
        except InputError as error:
            problems.extend(error.problems)
    if problems:
        raise InputError(dict.fromkeys([*_time_problems(named[TIME], table), *problems]))
    found |= {channel: found[sensor] for channel, sensor in borrowed.items()}
    used = [*found.values()]
    left_out = [
        f"{channel} has no column: left out" for channel in wanted[1:] if channel not in found
    ]
    notes = [*table.notes, *_clock_notes(named, columns, table), *left_out, *_unused(table, used)]
    notes += _gravity_notes(named, found)
    notes += [
        f"{channel} is imposed: it moves as {sensor} records"
        for channel, sensor in borrowed.items()
    ]
    return _channels(found, tuple(notes), table)


def channels_of(table: Table, model: Model) -> tuple[tuple[Wanted, str | None], ...]:
    """Every channel of a model, time first, with the column that is found by its name, None where
    none is."""
    return tuple((channel, _equal(channel, table)) for channel in _wanted(model))


def _clocked(text: str, channel: Wanted, time: str | None, table: Table) -> _Clocked:
    """Find the source of a channel and that of its times: behind ``@``, else ``time``, which is
    looked up beside the channel first. A single number has no times."""
    own = ""
    if not table.find(text.strip()):
        text, _, own = text.partition("@")
    source = find_source(text, channel, table)
    clock = own.strip() or time
    if clock is None or not has_rows(source):
        return source, None
    return source, find_source(clock, TIME, table, source.part)


def _time_problems(time: str | None, table: Table) -> tuple[Problem, ...]:
    """Say what is wrong with time itself; a column of that name in several parts is not wrong."""
    if time is None or len(table.find(time)) > 1:
        return ()
    try:
        find_source(time, TIME, table)
    except InputError as error:
        return error.problems
    return ()


def _channels(found: Mapping[Wanted, _Clocked], notes: tuple[str, ...], table: Table) -> Channels:
    """Compute all signals, group by group of channels with the same times, and merge the groups."""
    groups: dict[tuple[str, ...], dict[Wanted, _Clocked]] = {}
    for channel, (source, clock) in found.items():
        if clock is not None:
            key = (clock.text, *(column.header for column in clock.columns))
            groups.setdefault(key, {})[channel] = source, clock
    parts = [_group(group, table) for group in groups.values()]
    whole = merged([one_run(part, table) for part in parts], table)
    held = {
        channel.name: signal(source, whole.t.size, table.first)
        for channel, (source, clock) in found.items()
        if clock is None
    }
    order = [channel.name for channel in found if channel.role in ("input", "coordinate")]
    inputs = {**whole.inputs, **held}
    return Channels(
        whole.t, {name: inputs[name] for name in order}, whole.sensors, (*notes, *whole.notes)
    )


def _group(group: Mapping[Wanted, _Clocked], table: Table) -> Channels:
    clock = next(clock for _, clock in group.values() if clock is not None)
    size = _size([clock, *(source for source, _ in group.values())], table)
    signals = {channel: signal(source, size, table.first) for channel, (source, _) in group.items()}
    return Channels(
        signal(clock, size, table.first),
        {c.name: values for c, values in signals.items() if c.role in ("input", "coordinate")},
        {c.name: values for c, values in signals.items() if c.role == "sensor"},
        (),
    )


def _wanted(model: Model) -> Iterator[Wanted]:
    yield TIME
    for driver in model.inputs:
        yield Wanted("input", driver.name, driver.unit)
    for coordinate in model.coordinates:
        if coordinate.imposed:
            yield Wanted("coordinate", coordinate.name, coordinate.unit)
    for sensor in model.sensors:
        yield Wanted("sensor", sensor.name, sensor.unit)


def _equal(channel: Wanted, table: Table) -> str | None:
    """Return what the column with the channel's name is called, whatever unit stands behind it.

    Time may also be a sample step, a single number ``dt``, or the only column of a usual name.
    """
    found = table.find(channel.name)
    if found:
        return found[0].header if len(found) == 1 else channel.name
    if channel != TIME:
        return None
    steps = table.find("dt")
    if steps and not any(step.values.ndim for step in steps):
        return f"{INDEX}*dt"
    others = _times(table)
    return others[0] if len(others) == 1 else None


def _times(table: Table) -> list[str]:
    """What stands in a map for the columns that are called as time usually is."""
    return list(dict.fromkeys(filter(None, map(_as_time, table.columns))))


def _as_time(column: Column) -> str | None:
    """What stands in a map for a column that is called as :data:`TIMES` are, with the unit that its
    name ends with (``timestamp_ms``) unless it states one; None if it is called otherwise."""
    for name, unit in ((column.name, ""), *_endings(column.name)):
        if name.lower() in TIMES:
            return column.header if column.unit or not unit else f"{column.header} [{unit}]"
    return None


def _endings(name: str) -> Iterator[tuple[str, str]]:
    """A name without the unit of time that it ends with, and that unit."""
    found = _UNIT_AT_END.fullmatch(name)
    if found is not None:
        yield found[1], "s" if found[2].lower() == "sec" else found[2].lower()


def _borrowed(model: Model, named: Mapping[Wanted, str | None]) -> Iterator[tuple[Wanted, Wanted]]:
    """Pair imposed coordinates that have no column with a sensor that measures just them."""
    columns = {channel.name: channel for channel in named if channel.role == "sensor"}
    for channel, text in named.items():
        if channel.role != "coordinate" or text is not None:
            continue
        for sensor in model.sensors:
            exact = sensor.measures.tree == Name(channel.name)
            if exact and named[columns[sensor.name]] is not None:
                yield channel, columns[sensor.name]
                break


def _size(sources: Iterable[Source], table: Table) -> int:
    """Return the number of rows, on which all columns with the same times must agree."""
    lengths = {
        column.name: column.values.size
        for source in sources
        for column in source.columns
        if column.values.ndim
    }
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        text = (
            f"the columns in use differ in their number of rows: {listed}; a channel with times of"
            " its own names them in the map, as in accel=acc @ t_acc"
        )
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


def _missing(
    named: Mapping[Wanted, str | None], borrowed: Mapping[Wanted, Wanted], table: Table
) -> Iterator[Problem]:
    """Complain of a time, an input or an imposed coordinate without a column, and if no sensor at
    all has one."""
    for channel, text in named.items():
        if text is None and channel.role != "sensor" and channel not in borrowed:
            example = f"{channel.name}=…"
            if channel.role == "time":
                example = " or ".join(f"t={one}" for one in _times(table))
                example = example or f"t={INDEX}/1000 at 1000 Hz"
            if channel.role == "coordinate":
                example += ", or map a sensor that measures it and nothing else"
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
            f" (columns: {_some(table.names()) or 'none'}){example}"
            + "".join(f"; {note}" for note in table.notes),
            file=table.file,
        )


def _clock_notes(
    named: Mapping[Wanted, str | None], columns: Mapping[str, str], table: Table
) -> Iterator[str]:
    if "t" in columns or table.find("t"):
        return
    steps = table.find("dt")
    size = f" ({steps[0].header} = {float(steps[0].values):g})" if steps else ""
    yield f"t is {named[TIME]}{size}, there is no column t"


def _gravity_notes(
    named: Mapping[Wanted, str | None], found: Mapping[Wanted, _Clocked]
) -> Iterator[str]:
    """Say which accelerations are in g, which elsewhere is a gram."""
    channels = []
    for channel, (source, _) in found.items():
        stated = split_unit((named[channel] or "").partition("@")[0])[1]
        units = {stated, *(column.unit for column in source.columns)}
        if GRAVITY in units and channel.unit.same_dimension(STANDARD_GRAVITY):
            channels.append(channel.name)
    if channels:
        factor = f"{STANDARD_GRAVITY.factor:g} m/s^2"
        yield f"[g] of an acceleration is {factor}, and no gram: {_some(channels)}"


def _unused(table: Table, used: Iterable[_Clocked]) -> Iterator[str]:
    sources = [source for pair in used for source in pair if source is not None]
    known = {column.header for source in sources for column in source.columns}
    rest = [column.name for column in table.columns if column.header not in known]
    if rest:
        verb = "columns {} are" if len(rest) > 1 else "column {} is"
        yield verb.format(_some(rest)) + " not used"


def _some(names: list[str]) -> str:
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more
