"""One door for every file format: a path in, named columns of numbers out.

A new format is one more function from bytes to :class:`Table` in ``_READERS``.
"""

import hashlib
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem, did_you_mean

_BRACKETED = re.compile(r"(.*?)\s*\[([^\[\]]*)\]\s*", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Column:
    """A column as the file has it.

    ``header`` is the name as written (``laser [mm]``), ``values`` (N,) or, for a single number of
    a MAT file, (); in the unit of the file, NaN where a cell is empty. ``problem`` says why the
    column cannot be used, which matters only if somebody wants it.
    """

    header: str
    values: NDArray[np.float64]
    problem: Problem | None = None

    @property
    def name(self) -> str:
        """The name without its unit."""
        return split_unit(self.header)[0]

    @property
    def unit(self) -> str | None:
        """The unit in brackets behind the name, None if there is none."""
        return split_unit(self.header)[1]


@dataclass(frozen=True, slots=True)
class Table:
    """The columns of one file. ``lines`` (N,) are the line numbers of the rows in a text file.

    ``notes`` are sentences on what was left out; ``file`` is the path as given, for messages.
    """

    file: str
    columns: tuple[Column, ...]
    notes: tuple[str, ...] = ()
    lines: NDArray[np.intp] | None = None
    sha256: str = ""

    def names(self) -> list[str]:
        """The names of the columns without their units, in the order of the file."""
        return [column.name for column in self.columns]

    def row(self, number: int) -> str:
        """Say where row ``number`` (from 0) stands: ``line 14`` of a text, else ``row 13``."""
        return f"row {number + 1}" if self.lines is None else f"line {self.lines[number]}"


def split_unit(text: str) -> tuple[str, str | None]:
    """Split ``laser [mm]`` into ``laser`` and ``mm``; without brackets the unit is None."""
    found = _BRACKETED.fullmatch(text)
    return (found[1].strip(), found[2].strip()) if found else (text.strip(), None)


def read_table(path: str | os.PathLike[str]) -> Table:
    """Read the columns of a recording, whatever its format.

    Raises:
        InputError: there is no such file, its format is not readable, or its content is damaged.
    """
    path = Path(path)
    file = str(path)
    if path.is_dir():
        raise refusal(file, "is a folder, not a recording")
    if not path.exists():
        raise refusal(file, f"does not exist{_near(path)}")
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        known = ", ".join(_READERS)
        raise refusal(file, f"'{path.suffix}' is not a readable format; readable are {known}")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise refusal(file, f"cannot be read: {error.strerror}") from error
    if not content.strip():
        raise refusal(file, "the file is empty")
    return replace(reader(content, file), sha256=hashlib.sha256(content).hexdigest())


def refusal(file: str, text: str, line: int = 0) -> InputError:
    """Return the error for a file that cannot be used as a whole."""
    return InputError(Problem(text, file=file, line=line))


def _near(path: Path) -> str:
    if not path.parent.is_dir():
        return f": there is no folder '{path.parent}'"
    readable = (other for other in path.parent.iterdir() if other.suffix.lower() in _READERS)
    return did_you_mean(path.name, sorted(other.name for other in readable))


def _csv(content: bytes, file: str) -> Table:
    from symhyb.data.csv_file import read_csv

    return read_csv(content, file)


def _mat(content: bytes, file: str) -> Table:
    from symhyb.data.mat_file import read_mat

    return read_mat(content, file)


_READERS: Mapping[str, Callable[[bytes, str], Table]] = {".csv": _csv, ".mat": _mat}
