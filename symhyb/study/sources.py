"""The recordings of a study file: one by one, by a pattern of names, or by a table.

[[train]]
file = "bench/a.csv"                     # a file beside the study
[[train]]
files = "runs/*.csv"                     # every file that fits, sorted by name
[[train]]
table = "runs.csv"                       # a row for each recording

file,           start, end, parameters.m, groups.mount, map.laser
runs/heavy.csv, 0,     20,  1.168,        heavy,        qm [mm]

What stands beside ``files`` or ``table`` holds for all of their recordings; a cell of the table
goes before it, and an empty cell says nothing. Everything that is wrong is reported at once.
"""

import glob
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import TypeVar

from symhyb.data.by_recording import cells_of
from symhyb.data.catalogue import named, unknown
from symhyb.data.files.formats import split_part
from symhyb.data.rows import Span
from symhyb.errors import InputError, did_you_mean
from symhyb.limits import STUDY_RECORDINGS
from symhyb.model.tables import Table, describe, shorten
from symhyb.study.folders import Folders

ORIGINS = ("file", "data", "files", "table")
KEYS = (*ORIGINS, "span", "map", "parameters", "groups")
Cell = TypeVar("Cell", str, float)
PLAIN_COLUMNS, NAMED_COLUMNS = ("file", "start", "end"), ("parameters", "groups", "map")


@dataclass(frozen=True, slots=True)
class Source:
    """Where a recording comes from: the path ``file``, or ``data`` = ``"emps/DATA_EMPS.mat"``, a
    file of a known public recording. ``span`` (start, end) in s drops the rest. ``columns`` are the
    entries of the map that this recording has for itself, ``parameters`` the known values of
    parameters in it, in the units of the model, ``groups`` those of which it is, by grouping."""

    file: Path | None = None
    data: str = ""
    span: Span = (None, None)
    columns: tuple[tuple[str, str], ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()
    groups: tuple[tuple[str, str], ...] = ()

    @property
    def name(self) -> str:
        """The name of the file, for sentences."""
        return self.file.name if self.file is not None else self.data


def read_sources(root: Table, key: str, folders: Folders) -> tuple[Source, ...]:
    """The recordings under ``[[train]]`` or ``[[holdout]]`` in their order; what is wrong becomes a
    fault of ``root``."""
    listed = root.entries.get(key, [])
    if not isinstance(listed, list) or not all(isinstance(entry, dict) for entry in listed):
        root.fault(f"write each recording as a table [[{key}]], not {describe(listed)}", key)
        return ()
    if key == "train" and key in root.entries and not listed:
        root.fault("name at least one recording to learn from", key)
    found: list[Source] = []
    by_file: dict[Path, list[Source]] = {}
    several: set[Source] = set()  # those of a pattern or a table, none of which may stand twice
    for number, entries in enumerate(listed, 1):
        table = Table((f"{key}[{number}]",), entries, root.faults).checked(KEYS)
        for source in _sources(table, folders):
            many = "files" in table.entries or "table" in table.entries
            if source.file is not None and (many or source in several):
                if any(_overlap(one.span, source.span) for one in by_file.get(source.file, ())):
                    table.fault(f"'{source.name}' is listed already; name it once", *_given(table))
                    continue
                several.add(source)
            if source.file is not None:
                by_file.setdefault(source.file, []).append(source)
            found.append(source)
    if len(found) > STUDY_RECORDINGS:
        root.fault(f"{len(found)} recordings are more than {STUDY_RECORDINGS}", key)
    return tuple(found)


def text_map(table: Table, key: str) -> dict[str, str] | None:
    """The texts of a table under a key, by name; None without one."""
    channels = table.table(key)
    return {name: channels.text(name) or "" for name in channels.entries} if channels else None


def file_named(table: Table, key: str, name: str | None, folders: Folders) -> Path | None:
    """The path that a name in the study file means, if there is such a file."""
    try:
        return None if name is None else folders.path(name)
    except ValueError as error:
        table.fault(str(error), key)
        return None


def _sources(table: Table, folders: Folders) -> Iterator[Source]:
    """The recordings of one entry."""
    if sum(not table.lacks(name) for name in ORIGINS) != 1:
        table.fault("state exactly one of file, data, files and table")
    file, data = table.text("file"), table.text("data") or ""
    pattern, rows = table.text("files"), table.text("table")
    if data:
        _check_data(table, data)
    shared = Source(
        data=data,
        span=_span(table),
        columns=tuple((text_map(table, "map") or {}).items()),
        parameters=_known(table),
        groups=_groups(table),
    )
    if pattern is not None:
        yield from _matching(table, pattern, shared, folders)
    elif rows is not None:
        path = file_named(table, "table", rows, folders)
        if path is not None:
            yield from _rows(table, path, shared, folders)
    else:
        yield replace(shared, file=file_named(table, "file", file, folders))


def _matching(table: Table, pattern: str, shared: Source, folders: Folders) -> Iterator[Source]:
    """A recording for each file whose name fits a pattern, sorted by name."""
    parts = PurePath(pattern).parts
    fixed = [part for part in parts if not glob.has_magic(part)]
    if "\0" in pattern or len(fixed) == len(parts):
        table.fault("is no pattern of names, as 'runs/*.csv'; one file is given by: file", "files")
        return
    wild = next(i for i, part in enumerate(parts) if glob.has_magic(part))
    if ".." in parts[wild:] or not folders.holds(Path(*parts[:wild])):
        text = "leads out of the study's folder and project, and is not looked at"
        table.fault(f"'{shorten(pattern)}' {text}; allow its folder with --within FOLDER", "files")
        return
    names = sorted(glob.glob(pattern, root_dir=folders.home, recursive=True))
    files = [name for name in names if not os.path.isdir(folders.home / name)]
    if not files:
        table.fault(f"no file fits '{shorten(pattern)}'", "files")
    for name in files:
        path = file_named(table, "files", name, folders)
        if path is not None:
            yield replace(shared, file=path)


def _rows(table: Table, path: Path, shared: Source, folders: Folders) -> Iterator[Source]:
    """A recording for each row of a table."""
    try:
        rows = cells_of(path)
    except InputError as error:
        table.fault(error.problems[0].text, "table")
        return
    if len(rows) < 2:
        table.fault(f"'{path.name}' needs a header and a row for each recording", "table")
        return
    (_, head), *body = rows
    if not _is_header(table, path, head):
        return
    for line, cells in body:
        where = f"{path.name}, line {line}: "
        if len(cells) != len(head):
            text = f"has {len(cells)} cells below a header of {len(head)}"
            table.fault(where + text, "table")
            continue
        row = {column: cell for column, cell in zip(head, cells, strict=True) if cell}
        source = _row(Table(table.path, row, table.faults), where, shared, folders)
        if source is not None:
            yield source


def _is_header(table: Table, path: Path, head: list[str]) -> bool:
    """Whether the first row names columns that are known, each once, with ``file`` among them."""
    before = len(table.faults)
    known = (*PLAIN_COLUMNS, *(f"{word}.NAME" for word in NAMED_COLUMNS))
    for column in dict.fromkeys(head):
        word, _, name = column.partition(".")
        if column not in PLAIN_COLUMNS and not (word in NAMED_COLUMNS and name):
            near = did_you_mean(column, known)
            table.fault(f"{path.name}: '{shorten(column)}' is no column here{near}", "table")
        elif head.count(column) > 1:
            table.fault(f"{path.name}: '{column}' has two columns", "table")
    if "file" not in head:
        table.fault(f"{path.name}: a column 'file' with the recordings is missing", "table")
    return len(table.faults) == before


def _row(row: Table, where: str, shared: Source, folders: Folders) -> Source | None:
    """The recording of a row of a table, whose cells go before what is ``shared``."""
    before = len(row.faults)
    cells: dict[str, str] = {key: str(value) for key, value in row.entries.items()}
    path = None
    if "file" not in cells:
        row.fault(where + "names no file", "table")
    else:
        try:
            path = folders.path(cells["file"])
        except ValueError as error:
            row.fault(where + str(error), "table")
    numbers: dict[str, float] = {}
    for column, cell in cells.items():
        if column in ("start", "end") or column.startswith("parameters."):
            try:
                value = row.as_number(float(cell), "table")
            except ValueError:
                value = None
                row.fault(f"{where}{column} must be a number, not '{shorten(cell)}'", "table")
            if value is not None:
                numbers[column] = value
    start, end = (
        numbers.get(column, stated)
        for column, stated in zip(("start", "end"), shared.span, strict=True)
    )
    if start is not None and end is not None and start >= end:
        row.fault(f"{where}the start {start:g} s is not before the end {end:g} s", "table")
    if len(row.faults) > before:
        return None
    return replace(
        shared,
        file=path,
        span=(start, end),
        columns=_with(shared.columns, _below("map", cells)),
        parameters=_with(shared.parameters, _below("parameters", numbers)),
        groups=_with(shared.groups, _below("groups", cells)),
    )


def _below(word: str, cells: Mapping[str, Cell]) -> dict[str, Cell]:
    """The cells of the columns ``word.NAME`` by name."""
    prefix = f"{word}."
    found = ((column, cell) for column, cell in cells.items() if column.startswith(prefix))
    return {column.removeprefix(prefix): cell for column, cell in found}


def _with(
    shared: tuple[tuple[str, Cell], ...], own: Mapping[str, Cell]
) -> tuple[tuple[str, Cell], ...]:
    return tuple({**dict(shared), **own}.items())


def _given(table: Table) -> tuple[str, ...]:
    return tuple(key for key in ORIGINS if key in table.entries)


def _overlap(first: Span, second: Span) -> bool:
    """Whether two spans have a sample in common, or may have one."""
    ends = [
        (s if s is not None else -float("inf"), e if e is not None else float("inf"))
        for s, e in (first, second)
    ]
    return ends[0][0] < ends[1][1] and ends[1][0] < ends[0][1]


def _groups(table: Table) -> tuple[tuple[str, str], ...]:
    """The groups of one recording: grouping and label."""
    return tuple((by, label) for by, label in (text_map(table, "groups") or {}).items() if label)


def _known(table: Table) -> tuple[tuple[str, float], ...]:
    """The known values of parameters in one recording: path and number."""
    values = table.table("parameters")
    if values is None:
        return ()
    found = ((path, values.number(path)) for path in values.entries)
    return tuple((path, value) for path, value in found if value is not None)


def _check_data(table: Table, data: str) -> None:
    """See whether a name like ``emps/DATA_EMPS.mat`` is known."""
    name, _, file = data.partition("/")
    dataset = named(name)
    if dataset is None:
        own = "; a file of your own is given by: file = ..." if Path(data).suffix else ""
        table.fault(unknown(name or data) + own, "data")
        return
    files = [known.name for known in dataset.files]
    file = split_part(file)[0].name if file else file
    if file not in files and (file or len(files) > 1):
        near = did_you_mean(file, files)
        table.fault(f"'{data}' names no file of {name}{near}", "data")


def _span(table: Table) -> Span:
    value = table.entries.get("span")
    if value is None:
        return (None, None)
    pair = table.numbers(value, "span", 2, "[start, end] in s, the start first")
    if pair is None:
        return (None, None)
    if pair[0] >= pair[1]:
        table.fault(f"must be [start, end] in s, the start first, not {value}", "span")
    return (pair[0], pair[1])
