"""What a result was made from: the versions of libraries, and the hashes of files."""

import hashlib
import platform
from importlib import metadata
from pathlib import Path
from typing import Any

from symhyb import __version__
from symhyb.data.recording import Recording
from symhyb.limits import TEXT_BYTES, content_of
from symhyb.model.types import Model
from symhyb.study.sources import Source

LIBRARIES = ("numpy", "scipy", "casadi", "sympy", "pysindy", "scikit-learn")


def versions() -> dict[str, str]:
    """The versions of Python, of symhyb and of the libraries whose numbers these are."""
    libraries = {name: metadata.version(name) for name in LIBRARIES}
    return {"python": platform.python_version(), "symhyb": __version__, **libraries}


def table_hashes(model: Model) -> dict[str, list[dict[str, str]]]:
    """The files of curves and of maps, which belong to a model; nothing where it has none."""
    return {
        word: [{"file": item.file, "sha256": item.sha256} for item in files]
        for word, files in model.table_files().items()
        if files
    }


def sha256_of(file: Path) -> str:
    """The SHA-256 of the bytes of a model or a study.

    Raises:
        InputError: it is there no more, or cannot be read.
    """
    return hashlib.sha256(content_of(file, TEXT_BYTES)).hexdigest()


def entry_of(role: str, recording: Recording, source: Source) -> dict[str, Any]:
    """What a manifest says of a recording: what it was read from and how, but no path."""
    return {
        "role": role,
        "file": recording.name,
        "sha256": recording.sha256,
        "span": list(source.span),
        **({"map": dict(source.columns)} if source.columns else {}),
        **({"parameters": dict(recording.parameters)} if recording.parameters else {}),
        **({"groups": dict(recording.groups)} if recording.groups else {}),
    }
