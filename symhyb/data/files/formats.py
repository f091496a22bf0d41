"""One door for every file format: a path in, named columns of numbers out.

A new format is one more function from bytes to :class:`Table` in ``_READERS``; what a native parser
reads stands in ``_NATIVE`` too.
"""

import hashlib
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from symhyb.data.files.apart import read_apart
from symhyb.data.files.bag_file import folder_of_bag, read_bag
from symhyb.data.files.csv_file import read_csv
from symhyb.data.files.json_file import read_json
from symhyb.data.files.mat_file import read_mat
from symhyb.data.files.mdf_file import read_mdf
from symhyb.data.files.parquet_file import read_parquet
from symhyb.data.files.rpc_file import read_rpc
from symhyb.data.files.sheet_file import read_excel
from symhyb.data.files.table import PART, Table, choose, following, refusal
from symhyb.data.files.tdms_file import read_tdms
from symhyb.data.files.ulog_file import read_ulog
from symhyb.errors import did_you_mean, visible
from symhyb.limits import RECORDING_BYTES, content_of

_READERS: Mapping[str, Callable[[bytes, str], Table]] = {
    ".csv": read_csv,
    ".mat": read_mat,
    ".json": read_json,
    ".parquet": read_parquet,
    ".xlsx": read_excel,
    ".xls": read_excel,
    ".mf4": read_mdf,
    ".mdf": read_mdf,
    ".bag": read_bag,
    ".mcap": read_bag,
    ".db3": read_bag,
    ".ulg": read_ulog,
    ".tdms": read_tdms,
    ".rsp": read_rpc,
    ".rpc": read_rpc,
}
_NATIVE = frozenset(_READERS) - {".csv", ".json", ".rsp", ".rpc"}
AND = "+"
"""Between the names of files: they are one recording, of several loggers."""
_FROM_TO = re.compile(r"([1-9]\d*)-([1-9]\d*)")


def split_part(path: str | os.PathLike[str]) -> tuple[Path, tuple[str, ...]]:
    """Split ``drops.xls#Golf Ball#2`` into the path of the file and what is wanted of it."""
    whole = Path(path)
    if PART not in whole.name or whole.exists():
        return whole, ()
    name, *parts = whole.name.split(PART)
    return whole.with_name(name) if name else whole, tuple(parts)


def files_of(path: str | os.PathLike[str]) -> tuple[Path, ...]:
    """The files, or folders of bags, that a recording is read from: one, or those of several
    loggers. They need not exist."""
    whole, _ = split_part(path)
    return _beside(whole) or (whole,)


def read_table(path: str | os.PathLike[str]) -> Table:
    """Read the columns of a recording, whatever its format; ``FILE#PART`` reads one part of it.

    A part is a sheet, a structure, the number of a cell, or a group of channels; ``1-4`` are the
    cells 1 to 4, each following on the one before. ``FILE+FILE`` are several loggers of one
    recording, each a part with times of its own. A number that names no part is that of a run,
    from 1, where time starts anew in the file.

    Raises:
        InputError: there is no such file or part, its format is not readable, or its content is
            damaged.
    """
    whole, parts = split_part(path)
    files = _beside(whole)
    table = _together(whole, files) if files else _read(whole)
    for part in parts:
        table = _choose(table, part)
    return replace(table, file=str(path))


def _beside(whole: Path) -> tuple[Path, ...]:
    """The files of ``first.csv+second.csv``, each beside the first if it is found there; none where
    a single file is meant."""
    if AND not in str(whole) or whole.exists():
        return ()
    first, *others = map(Path, str(whole).split(AND))
    near = [(first.parent / one, one) for one in others]
    return (
        first,
        *(one if one.exists() and not beside.exists() else beside for beside, one in near),
    )


def _together(whole: Path, files: tuple[Path, ...]) -> Table:
    """One recording of several loggers: every file is a part with times of its own."""
    stems = [one.stem for one in files]
    names = stems if len(set(stems)) == len(stems) else [str(k + 1) for k in range(len(stems))]
    tables = [_read(one) for one in files]
    columns = [
        replace(one, header=f"{name}.{one.header}", part=_joined(name, one.part), inside=inside)
        for name, table in zip(names, tables, strict=True)
        for one in table.columns
        for inside in (one.inside or one.header,)
    ]
    notes = [
        f"{name}: {note}" for name, table in zip(names, tables, strict=True) for note in table.notes
    ]
    digest = hashlib.sha256("".join(table.sha256 for table in tables).encode()).hexdigest()
    return Table(str(whole), tuple(columns), tuple(notes), sha256=digest)


def _joined(name: str, part: str) -> str:
    return f"{name}.{part}" if part else name


def _choose(table: Table, part: str) -> Table:
    chosen = choose(table, part)
    if chosen is not None:
        return chosen
    if (ends := _FROM_TO.fullmatch(part)) is not None:
        return _follow(table, int(ends[1]), int(ends[2]))
    if part.isdecimal() and int(part) and not table.run:
        return replace(table, run=int(part))
    if table.run:
        raise refusal(
            table.file, f"'{PART}{part}' follows '{PART}{table.run}', but a run has no parts"
        )
    known = list(dict.fromkeys(column.part for column in table.columns if column.part))
    hint = did_you_mean(part, known) if known else "; it has no parts at all"
    raise refusal(table.file, f"has no part '{part}'{hint}")


def _follow(table: Table, first: int, last: int) -> Table:
    """Return the cells ``first`` to ``last`` of ``table`` as if they were one."""
    if first >= last:
        raise refusal(table.file, f"'{PART}{first}-{last}' must go up: the first cell comes first")
    cells = []
    for number in range(first, last + 1):
        cell = choose(table, str(number))
        if cell is None:
            raise refusal(table.file, f"'{PART}{first}-{last}': it has no cell {number}")
        cells.append(cell)
    return following(cells)


def _read(path: Path) -> Table:
    file = str(path)
    if path.is_dir():
        return _read_folder(path)
    if not path.exists():
        raise refusal(file, f"does not exist{_near(path)}")
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        known = ", ".join(_READERS)
        raise refusal(file, f"'{path.suffix}' is not a readable format; readable are {known}")
    content = content_of(path, RECORDING_BYTES)
    if not content.strip():
        raise refusal(file, "the file is empty")
    return _read_content(_READERS[suffix], content, file, suffix in _NATIVE)


def _read_folder(path: Path) -> Table:
    """Read a folder of ROS 2, which is one recording in several files."""
    content = folder_of_bag(path)
    if content is None:
        raise refusal(str(path), "is a folder, not a recording")
    return _read_content(read_bag, content, str(path), True)


def _read_content(
    reader: Callable[[bytes, str], Table], content: bytes, file: str, native: bool
) -> Table:
    table = read_apart(reader, content, file) if native else reader(content, file)
    return replace(_named_visibly(table), sha256=hashlib.sha256(content).hexdigest())


def _named_visibly(table: Table) -> Table:
    """The table with names and notes that a terminal and a page show and do not obey."""
    columns = tuple(
        replace(
            one,
            header=visible(one.header),
            part=visible(one.part),
            inside=visible(one.inside),
        )
        for one in table.columns
    )
    return replace(table, columns=columns, notes=tuple(map(visible, table.notes)))


def _near(path: Path) -> str:
    if not path.parent.is_dir():
        return f": there is no folder '{path.parent}'"
    readable = (other for other in path.parent.iterdir() if other.suffix.lower() in _READERS)
    return did_you_mean(path.name, sorted(other.name for other in readable))
