"""A fault of symhyb itself as a text that can be sent: where it happened, and nothing of the data.

What an error says may hold values and names from a file, so its numbers are left out, and of the
files through which it went only those of Python packages are named.
"""

import platform
import re
import tempfile
import traceback
from importlib import metadata
from pathlib import Path

from symhyb.errors import InputError, NumericsError, visible

NAME = "symhyb-fault.txt"
LIBRARIES = ("symhyb", "casadi", "numpy", "scipy", "sympy", "pysindy", "scikit-learn", "numba")
STAGE = "while "
"""How the note of an error begins that says what was being done."""
SO_FAR = "so far: "
"""How the note of an interruption begins that says what was known by then."""


def error_sentences(error: BaseException) -> tuple[int, list[str]]:
    """What an error is about, a sentence each, and the exit status that it has. A fault of symhyb
    itself is left as a text that can be sent."""
    match error:
        case InputError():
            return 2, [str(problem) for problem in error.problems]
        case NumericsError():
            return 3, [f"the numerics failed: {error}"]
    place = leave_fault(error)
    where = f"; what happened, without any of your data, is in {place}" if place else ""
    said = f"{type(error).__name__}: {visible(str(error))[:300]}"
    return 3, [said, f"this is a fault of symhyb itself{where}; please send it to its authors"]


def fault_text(error: BaseException) -> str:
    """What can be sent: versions, what was being done, the sort of error, and its way through the
    code as module, line and function."""
    lines = [
        "A fault of symhyb itself. This text holds no data and no names of files.",
        "",
        f"versions: Python {platform.python_version()}, {', '.join(map(_version, LIBRARIES))}",
        f"system: {platform.system()} {platform.release()} {platform.machine()}",
        *(note for note in getattr(error, "__notes__", ()) if note.startswith(STAGE)),
    ]
    while error is not None:
        lines += ["", f"{type(error).__name__}: {_without_data(str(error))}"]
        frames = traceback.extract_tb(error.__traceback__)
        lines += [f"  {_module(one.filename)}:{one.lineno} in {one.name}" for one in frames]
        error = error.__cause__  # type: ignore[assignment]
    return "\n".join(lines) + "\n"


def leave_fault(error: BaseException) -> str:
    """Write the text into the working folder, else into that of temporary files, and say where; an
    empty text where neither can be written."""
    text = fault_text(error)
    for folder in (Path.cwd(), Path(tempfile.gettempdir())):
        try:
            (folder / NAME).write_text(text, encoding="utf-8")
        except OSError:
            continue
        return str(folder / NAME)
    return ""


def _version(library: str) -> str:
    try:
        return f"{library} {metadata.version(library)}"
    except metadata.PackageNotFoundError:
        return f"{library} is not installed"


def _without_data(text: str) -> str:
    """A sentence without quoted parts, paths and numbers."""
    text = re.sub(r"'[^']*'|\"[^\"]*\"|\S*[/\\]\S*", "…", visible(text.replace("\n", " ")))
    return re.sub(r"[-+]?\d[\d.,eE+-]*", "#", text)[:300]


def _module(file: str) -> str:
    """The file below the folder of packages, as ``symhyb/study/run.py``."""
    parts = Path(file).parts
    for root in ("site-packages", "dist-packages"):
        if root in parts:
            return "/".join(parts[len(parts) - parts[::-1].index(root) :])
    if "symhyb" in parts:
        return "/".join(parts[len(parts) - 1 - parts[::-1].index("symhyb") :])
    return Path(file).name
