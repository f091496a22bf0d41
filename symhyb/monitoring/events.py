"""What a watch says: one event a line, for people and, as JSON, for programs and logs."""

import json
import os
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self

from symhyb.errors import InputError, Problem

Kind = Literal["ready", "changed", "named", "values", "unreadable", "silent", "back", "ended"]


@dataclass(frozen=True, slots=True)
class Amount:
    """One number of a change with its standard deviation, in the ``unit`` of the model file."""

    name: str
    value: float
    sd: float
    unit: str


@dataclass(frozen=True, slots=True)
class Event:
    """Something to say, at ``at_s`` of the source's time: that the reference is there (*ready*),
    that something *changed* and, some blocks later, by what (*named*), *values* of parameters, a
    block that is *unreadable*, a source that is *silent*, goes *back* in time or has *ended*.

    A change has its beginning ``since_s``, what it may be (``cause``, with ``amounts`` and its
    ``probability`` among ``rivals``), and the ``chance`` of as much where nothing changes."""

    kind: Kind
    sentence: str
    at_s: float
    since_s: float | None = None
    cause: str = ""
    amounts: tuple[Amount, ...] = ()
    probability: float | None = None
    chance: float | None = None
    rivals: tuple[str, ...] = ()

    def json(self) -> str:
        """The event in one line of JSON, without what it does not have."""
        kept = {k: v for k, v in asdict(self, dict_factory=_finite).items() if v not in ("", ())}
        return json.dumps(kept, ensure_ascii=False, allow_nan=False)


def _finite(items: list[tuple[str, Any]]) -> dict[str, Any]:
    """Entries without those that are None or no finite number."""
    numbers = {key for key, value in items if isinstance(value, float) and not isfinite(value)}
    return {key: value for key, value in items if value is not None and key not in numbers}


class Log:
    """A file to which events are appended, each on the disk before the next one is awaited; what a
    kill leaves of a last line is completed by a new line."""

    def __init__(self, path: Path) -> None:
        try:
            torn = path.exists() and path.stat().st_size and path.read_bytes()[-1:] != b"\n"
            self._file = path.open("a", encoding="utf-8")
        except OSError as error:
            raise InputError(
                Problem(error.strerror or "cannot be written", file=str(path))
            ) from error
        if torn:
            self._file.write("\n")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        self._file.close()

    def add(self, event: Event) -> None:
        """Append an event."""
        self._file.write(event.json() + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())
