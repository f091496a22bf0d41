"""One door for every file format: a path in, named columns of numbers out.

A new format is one more function from bytes to :class:`Table` in ``_READERS``.
"""

import hashlib
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from symhyb.data.csv_file import read_csv
from symhyb.data.mat_file import read_mat
from symhyb.data.table import Table, refusal
from symhyb.errors import did_you_mean

_READERS: Mapping[str, Callable[[bytes, str], Table]] = {".csv": read_csv, ".mat": read_mat}


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


def _near(path: Path) -> str:
    if not path.parent.is_dir():
        return f": there is no folder '{path.parent}'"
    readable = (other for other in path.parent.iterdir() if other.suffix.lower() in _READERS)
    return did_you_mean(path.name, sorted(other.name for other in readable))
