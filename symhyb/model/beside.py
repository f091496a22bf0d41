"""Files that a model file names: they lie in its folder or below it, on every system."""

import os
from pathlib import Path, PurePosixPath, PureWindowsPath

from symhyb.model.tables import Table, shorten


def beside(name: str) -> bool:
    """Whether a file name stays in the folder of the model file, on every system."""
    posix, windows = PurePosixPath(name), PureWindowsPath(name)
    leaves = posix.is_absolute() or windows.drive or windows.root or ".." in windows.parts
    return bool(name.strip()) and not leaves and "\0" not in name


def named_file(table: Table, key: str, required: bool = False) -> str | None:
    """Read the name of a file beside the model file, None if it is missing or leads elsewhere."""
    name = table.text(key, required=required)
    if name is None or beside(name):
        return name
    sentence = f"'{shorten(name)}' must be a file beside the model file or below it"
    table.fault(f"{sentence}: a relative name without '..'", key)
    return None


def inside(path: Path, home: Path) -> bool:
    """Whether ``path``, its links followed, lies in the folder ``home``."""
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(home))
