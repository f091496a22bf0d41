"""What is on the workbench: a model file, recordings, and what a person has changed since.

Every change is a new value; the file stays as it is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import TypeVar

from symhyb.data.columns import map_columns
from symhyb.data.files.formats import read_table
from symhyb.data.files.table import Table
from symhyb.data.recording import Recording, recorded
from symhyb.errors import InputError, Problem
from symhyb.model.read import read_model
from symhyb.model.types import Input, Model, Parameter, Sensor

Channel = TypeVar("Channel", Input, Sensor)


@dataclass(frozen=True, slots=True, eq=False)
class Bench:
    """A ``model`` as its ``file`` says, the ``tables`` of the recordings at ``paths``, of which the
    one numbered ``shown`` is looked at, and what was changed: the map of ``columns`` (channel,
    column), the elements that are switched ``off``, and ``values`` of parameters by path, in the
    units of the file."""

    file: Path
    model: Model
    paths: tuple[Path, ...]
    tables: tuple[Table, ...]
    columns: tuple[tuple[str, str], ...] = ()
    off: frozenset[str] = frozenset()
    values: tuple[tuple[str, float], ...] = ()
    shown: int = 0

    @property
    def table(self) -> Table:
        """The recording that is looked at, as its file has it."""
        return self.tables[self.shown]

    @property
    def changed(self) -> bool:
        """Whether the model that is shown says something else than its file."""
        return bool(self.off or self.values)


def open_bench(
    file: Path, recordings: Sequence[Path], columns: Mapping[str, str] | None = None
) -> Bench:
    """Read a model and recordings. How columns become channels is left for later, where it can be
    mended.

    Raises:
        InputError: the model or a file cannot be read: all problems at once.
    """
    problems: list[Problem] = []
    model: Model | None = None
    try:
        model = read_model(file)
    except InputError as error:
        problems += error.problems
    tables = []
    for path in recordings:
        try:
            tables.append(read_table(path))
        except InputError as error:
            problems += error.problems
    if not recordings:
        problems.append(Problem("name at least one recording beside the model", file=str(file)))
    if problems or model is None:
        raise InputError(dict.fromkeys(problems))
    return Bench(file, model, tuple(recordings), tuple(tables), tuple((columns or {}).items()))


def read_shown(bench: Bench) -> Recording:
    """The recording that is looked at, through the map of columns.

    Raises:
        InputError: as :func:`symhyb.read_recording`.
    """
    channels = map_columns(bench.table, bench.model, dict(bench.columns))
    return recorded(bench.table, channels, bench.model)


def with_column(bench: Bench, channel: str, column: str) -> Bench:
    """The bench with a channel taken from another column; an empty one leaves it to its name."""
    rest = tuple(pair for pair in bench.columns if pair[0] != channel)
    return replace(bench, columns=(*rest, (channel, column)) if column else rest)


def with_shown(bench: Bench, number: int) -> Bench:
    """The bench with another recording looked at."""
    return replace(bench, shown=number)


def with_elements(bench: Bench, on: Sequence[str]) -> Bench:
    """The bench with these elements on, and all others off."""
    return replace(bench, off=frozenset(bench.model.elements.names()) - frozenset(on))


def with_value(bench: Bench, path: str, value: float) -> Bench:
    """The bench with another value of a parameter, in the unit of the file.

    Raises:
        InputError: it is no finite number.
    """
    if not isfinite(value):
        raise InputError(Problem(f"must be a finite number, not {value}", path, bench.model.file))
    stated = {item.path: item.value for item in bench.model.all_parameters()}
    rest = tuple(pair for pair in bench.values if pair[0] != path)
    return replace(bench, values=rest if stated[path] == value else (*rest, (path, value)))


def as_filed(bench: Bench) -> Bench:
    """The bench with the model as its file says."""
    return replace(bench, off=frozenset(), values=())


def current(bench: Bench) -> Model:
    """The model that is shown: that of the file without what is off, with the changed values."""
    if not bench.changed:
        return bench.model
    values, model = dict(bench.values), bench.model

    def valued(item: Parameter | None) -> Parameter | None:
        if item is None or item.path not in values:
            return item
        return replace(item, value=values[item.path])

    def tuned(one: Channel) -> Channel:
        one = replace(
            one, gain=valued(one.gain), offset=valued(one.offset), delay=valued(one.delay)
        )
        return replace(one, actuator=all_valued(one.actuator)) if isinstance(one, Input) else one

    def all_valued(items: Sequence[Parameter]) -> tuple[Parameter, ...]:
        return tuple(replace(item, value=values.get(item.path, item.value)) for item in items)

    kept = (element for element in model.elements if element.name not in bench.off)
    return replace(
        model,
        parameters=all_valued(model.parameters),
        elements=tuple(replace(one, parameters=all_valued(one.parameters)) for one in kept),
        inputs=tuple(map(tuned, model.inputs)),
        sensors=tuple(map(tuned, model.sensors)),
    )
