"""Files written whole or not at all; a zip archive that is the same, byte by byte, every time."""

import io
import os
import shutil
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from symhyb.errors import InputError, Problem

FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of a zip archive; a real date would differ every time


def archive(files: Mapping[str, str | bytes]) -> bytes:
    """A zip archive of these files, in the order of their names."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as packed:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, FIRST_DAY)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system, entry.external_attr = 3, 0o644 << 16
            packed.writestr(entry, files[name])
    return buffer.getvalue()


def require_writable(path: Path) -> None:
    """Refuse a place that cannot be written to, before any work is done.

    Raises:
        InputError: no such folder, or no permission to write there.
    """
    target = path.absolute()
    there = next(folder for folder in target.parents if folder.exists())
    if not there.is_dir():
        raise InputError(Problem("is a file, not a folder", file=str(there)))
    if not os.access(there, os.W_OK):
        raise InputError(Problem("may not be written to", file=str(there)))


def write_file(path: Path, content: str | bytes) -> None:
    """Write one file at once, so that nobody meets half of it.

    Raises:
        InputError: it cannot be written.
    """
    if path.is_dir():
        raise InputError(Problem("is a folder; name a file in it", file=str(path)))
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            unfinished.write_bytes(content.encode() if isinstance(content, str) else content)
            os.replace(unfinished, path)
        finally:
            unfinished.unlink(missing_ok=True)
    except OSError as error:
        text = f"cannot be written: {error.strerror or error}"
        raise InputError(Problem(text, file=str(path))) from error


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write several files into a folder: all of them or none.

    Raises:
        InputError: they cannot be written.
    """
    require_writable(folder / "x")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        part = Path(tempfile.mkdtemp(prefix=".symhyb-", dir=folder))
        try:
            for name, text in files.items():
                (part / name).write_text(text, encoding="utf-8", newline="")
            for name in files:
                os.replace(part / name, folder / name)
        finally:
            shutil.rmtree(part, ignore_errors=True)
    except OSError as error:
        text = f"cannot be written: {error.strerror or error}"
        raise InputError(Problem(text, file=str(folder))) from error
