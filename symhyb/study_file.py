"""Read a study file (TOML, format 1): which model meets which recordings, or every problem at once.

symhyb = 1
title  = "Linear ball-screw drive"       # of the report; without it the title of the model
about  = "what the study shows"
model  = "../../models/emps.toml"        # paths are relative to the study file

budget = "10min"                         # after which the diagnosis ends; without it, no end
own    = ["m", "drag"]                   # of which every recording has its own value: parameters
                                         # of the model, keys of laws; all else is shared
[map]                                    # what --map says on the command line
force = "gtau*vir"                       # for all recordings; each may have its own entries

[[train]]                                # once or more: recordings to learn from
data = "emps/DATA_EMPS.mat"              # a file of a known public recording
span = [0.0, 20.0]                       # s; the rest is dropped
parameters = { m = 0.535 }               # known values in this recording, in the model's units

[[holdout]]                              # unseen recordings, for the proof alone
file = "pulses.csv"                      # a file beside the study
map  = { force = "F [kN]" }              # instead of, and besides, the entries above

[score]
window_s      = 0.25                     # without it, chosen from the recordings
force_band_hz = 60
"""

import os
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, takewhile
from pathlib import Path
from typing import Any

from symhyb.data.catalogue import named, unknown
from symhyb.data.formats import split_part
from symhyb.data.groups import EACH, Own, by_name
from symhyb.data.rows import Span
from symhyb.deadline import WANTED, seconds_of
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.limits import text_of
from symhyb.model.source import scan
from symhyb.model.tables import Fault, Table, describe
from symhyb.study_folders import Folders, folders_of

FORMAT = 1
"""The version of the study file that is read."""

SECTIONS = (
    "symhyb",
    "title",
    "about",
    "model",
    "map",
    "own",
    "budget",
    "train",
    "holdout",
    "score",
    "finish",
)


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


@dataclass(frozen=True, slots=True)
class Study:
    """What is to be diagnosed: paths as the working directory sees them, ``columns`` as in
    :func:`symhyb.read_recording`, for all recordings; ``file`` is None for a study that no
    file states. ``last_values``: whether every uncertain number of the corrected model is fitted
    once more to all training recordings; ``remainder`` the coordinate that then gets a smooth
    remainder, ``network`` the one that gets a trained network, None for none. ``own`` has for each
    name of what not all recordings share the grouping of those that do, empty for none. ``known``
    is a table of known values of parameters in each recording, ``groups`` one of their groups.
    ``budget_s`` is the time in s after which the diagnosis ends, None for no end."""

    model: Path
    train: tuple[Source, ...]
    holdout: tuple[Source, ...] = ()
    columns: Mapping[str, str] | None = None
    title: str = ""
    about: str = ""
    window_s: float | None = None
    force_band_hz: float | None = None
    file: Path | None = None
    own: Own = field(default_factory=dict)
    last_values: bool = False
    remainder: str | None = None
    network: str | None = None
    known: Path | None = None
    groups: Path | None = None
    budget_s: float | None = None

    def columns_of(self, source: Source) -> Mapping[str, str]:
        """The map of one recording: its own entries before those of all recordings."""
        return {**(self.columns or {}), **dict(source.columns)}

    @property
    def stated_own(self) -> list[str] | dict[str, str]:
        """What not all recordings share, as a study file says it."""
        if not any(self.own.values()):
            return list(self.own)
        return {name: by or EACH for name, by in self.own.items()}


def read_study(
    path: str | os.PathLike[str], within: Sequence[str | os.PathLike[str]] = ()
) -> Study:
    """Read and check a study file; model and recordings are looked for, but not read yet. They may
    lie in the folder of the study, in its project, and in the folders ``within``.

    Raises:
        InputError: every problem of the file, each with file, line and dotted name.
    """
    file = Path(path)
    text = text_of(file)
    try:
        document = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(Problem(f"is not valid TOML: {error}", file=str(file))) from None
    faults: list[Fault] = []
    root = Table((), document, faults).checked(SECTIONS)
    _check_format(root)
    study = _study(root, file, folders_of(file, within))
    if faults:
        raise InputError(sorted(_problems(faults, text, file), key=lambda problem: problem.line))
    return study


def _check_format(root: Table) -> None:
    version = root.entries.get("symhyb")
    if version is None and root.lacks("symhyb"):
        root.fault(f"the file does not state its format; begin it with: symhyb = {FORMAT}")
    elif version is not None and (version != FORMAT or isinstance(version, bool)):
        root.fault(f"must be the number {FORMAT}, not {describe(version)}", "symhyb")


def _study(root: Table, file: Path, folders: Folders) -> Study:
    score = root.table("score") or Table((), {}, root.faults)
    score = score.checked(("window_s", "force_band_hz"))
    finish = root.table("finish") or Table((), {}, root.faults)
    finish = finish.checked(("values", "remainder", "network"))
    name = root.text("model", required=True)
    if not root.entries.get("train") and root.lacks("train"):
        root.fault("[[train]] is missing: name at least one recording to learn from")
    return Study(
        model=_file(root, "model", name, folders) or Path(),
        train=tuple(_sources(root, "train", folders)),
        holdout=tuple(_sources(root, "holdout", folders)),
        columns=_map(root),
        title=root.text("title") or "",
        about=root.about(),
        window_s=_positive(score, "window_s"),
        force_band_hz=_positive(score, "force_band_hz"),
        file=file,
        own=_own(root),
        last_values=_flag(finish, "values"),
        remainder=finish.text("remainder"),
        network=finish.text("network"),
        budget_s=_budget(root),
    )


def _budget(root: Table) -> float | None:
    """The time after which the diagnosis ends, s; None where none is stated."""
    text = root.text("budget")
    seconds = None if text is None else seconds_of(text)
    if text is not None and seconds is None:
        root.fault(f"must be {WANTED}, not '{text}'", "budget")
    return seconds


def _map(table: Table) -> dict[str, str] | None:
    """The entries of a table ``map``: channel = column; None without one."""
    channels = table.table("map")
    return {key: channels.text(key) or "" for key in channels.entries} if channels else None


def _flag(table: Table, key: str) -> bool:
    """A key that is true or false; false where it is left out."""
    value = table.entries.get(key, False)
    if not isinstance(value, bool):
        table.fault(f"must be true or false, not {describe(value)}", key)
    return value is True


def _own(root: Table) -> dict[str, str]:
    """The names of what not all recordings share, each with the grouping of those that do."""
    stated: Any = root.entries.get("own", [])
    listed = list(stated.values()) if isinstance(stated, dict) else stated
    if not isinstance(listed, list) or not all(isinstance(name, str) for name in listed):
        text = (
            'must be a list of names, like ["m", "drag"], or say within which groups each is '
            f'shared, like {{ drag = "mount" }}, not {describe(stated)}'
        )
        root.fault(text, "own")
        return {}
    return by_name(stated)


def _sources(root: Table, key: str, folders: Folders) -> Iterator[Source]:
    """Read the recordings under ``[[train]]`` or ``[[holdout]]``."""
    listed = root.entries.get(key, [])
    if not isinstance(listed, list) or not all(isinstance(entry, dict) for entry in listed):
        root.fault(f"write each recording as a table [[{key}]], not {describe(listed)}", key)
        return
    if key == "train" and key in root.entries and not listed:
        root.fault("name at least one recording to learn from", key)
    for number, entries in enumerate(listed, 1):
        table = Table((f"{key}[{number}]",), entries, root.faults)
        table = table.checked(("file", "data", "span", "map", "parameters", "groups"))
        if sum(not table.lacks(name) for name in ("file", "data")) != 1:
            table.fault("state exactly one of file and data")
        file, data = table.text("file"), table.text("data") or ""
        if data:
            _check_data(table, data)
        own = tuple((_map(table) or {}).items())
        found, groups = _file(table, "file", file, folders), _groups(table)
        yield Source(found, data, _span(table), own, _known(table), groups)


def _groups(table: Table) -> tuple[tuple[str, str], ...]:
    """The groups of one recording: grouping and label."""
    groups = table.table("groups")
    found = [(by, groups.text(by)) for by in groups.entries] if groups else []
    return tuple((by, label) for by, label in found if label is not None)


def _known(table: Table) -> tuple[tuple[str, float], ...]:
    """The known values of parameters in one recording: path and number."""
    values = table.table("parameters")
    if values is None:
        return ()
    found = ((path, values.number(path)) for path in values.entries)
    return tuple((path, value) for path, value in found if value is not None)


def _file(table: Table, key: str, name: str | None, folders: Folders) -> Path | None:
    """Return the path that a name in the study file means, if there is such a file."""
    try:
        return None if name is None else folders.path(name)
    except ValueError as error:
        table.fault(str(error), key)
        return None


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


def _positive(table: Table, key: str) -> float | None:
    value = table.number(key)
    if value is not None and value <= 0:
        table.fault(f"must be positive, not {value:g}", key)
    return value


def _problems(faults: list[Fault], text: str, file: Path) -> Iterator[Problem]:
    source = scan(text)
    for path, sentence in faults:
        repeated = re.fullmatch(r"(\w+)\[(\d+)\]", path[0]) if path else None
        if repeated:
            line = _line(text, repeated[1], int(repeated[2]), path[1:])
        else:
            line = source.line(*path)
        yield Problem(sentence, ".".join(path), str(file), line)


def _line(text: str, table: str, number: int, keys: tuple[str, ...]) -> int:
    """Say where the ``number``-th table ``[[table]]`` stands, or a key of it, or a key of a table
    in it; 0 if it is not found (an array in braces)."""
    lines = list(enumerate(text.split("\n"), 1))
    heads = (line for line, words in lines if re.match(rf"\s*\[\[\s*{table}\s*\]\]", words))
    place = next(islice(heads, number - 1, None), 0)
    own = takewhile(lambda at: not re.match(rf"\s*\[(?!\s*{table}\.)", at[1]), lines[place:])
    inside = list(own) if place else []
    for key in keys:
        name = re.escape(key)
        wanted = rf"\s*{name}\s*=|\s*\[\s*{table}\.{name}\s*\]"
        place = next((line for line, words in inside if re.match(wanted, words)), place)
    return place
