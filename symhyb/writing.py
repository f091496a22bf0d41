"""Files are written whole or not at all: beside their place first, then moved there.

Several files that belong together take the place of older ones all at once: if one cannot, those
that were moved before it go back, and the old ones are there again.
"""

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from symhyb.errors import InputError, Problem

PREFIX = ".symhyb-"  # of what is not complete yet
STALE = 86_400.0  # s, after which what a process that was killed left behind is removed


def require_folder(directory: str | os.PathLike[str]) -> None:
    """Refuse a place where no folder can be written, before any work is done.

    Raises:
        InputError: a file stands there, or the folder around it cannot be written to.
    """
    path = Path(directory).absolute()
    there = next(folder for folder in (path, *path.parents) if folder.exists())
    reason = "" if os.access(there, os.W_OK) else "may not be written to"
    if not there.is_dir():
        reason = "is a file, not a folder"
    if reason:
        raise InputError(Problem(reason, file=str(path if there == path else there)))


def require_new(path: str | os.PathLike[str] | None, force: bool = False) -> None:
    """Refuse a file that is there already, unless by ``force``, and one that cannot be written,
    before any work is done. None is no file.

    Raises:
        InputError: it is there, is a folder, or its folder cannot be written to.
    """
    if path is None:
        return
    target = Path(path)
    if target.is_dir():
        raise InputError(Problem("is a folder; name a file in it", file=str(path)))
    if target.exists() and not force:
        raise InputError(Problem("is there already; --force replaces it", file=str(path)))
    require_folder(target.absolute().parent)


def write_file(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write one file at once, so that nobody meets half of it; its folder is made if it is new.

    Raises:
        InputError: a folder stands there, or it cannot be written.
    """
    target = Path(path)
    if target.is_dir():
        raise InputError(Problem("is a folder; name a file in it", file=str(path)))
    part = target.with_name(f"{PREFIX}{os.getpid()}-{target.name}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            part.write_bytes(content.encode() if isinstance(content, str) else content)
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        raise _unwritable(target, error) from error


@contextmanager
def staged(directory: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield an empty folder; when all went well, its files move into ``directory``.

    They replace files of the same names there; whatever else is there stays.

    Raises:
        InputError: the files cannot be written.
    """
    target = Path(directory).absolute()
    require_folder(target)
    try:
        home = target if target.is_dir() else target.parent
        home.mkdir(parents=True, exist_ok=True)
        _forget_stale(home)
        work = Path(tempfile.mkdtemp(prefix=PREFIX, dir=home))
    except OSError as error:
        raise _unwritable(home, error) from error
    part, old = work / "new", work / "old"
    try:
        part.mkdir()
        yield part
        _exchange(part, target, old)
    except OSError as error:  # also of whoever writes into the folder that it got
        raise _unwritable(target, error) from error
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _exchange(part: Path, target: Path, old: Path) -> None:
    """Move all files of ``part`` to ``target``, those of the same names to ``old``; or none."""
    made = not target.exists()
    moved: list[tuple[Path, Path]] = []
    try:
        target.mkdir(exist_ok=True)
        for file in sorted(file for file in part.rglob("*") if file.is_file()):
            place, kept = (folder / file.relative_to(part) for folder in (target, old))
            place.parent.mkdir(parents=True, exist_ok=True)
            if place.exists():
                kept.parent.mkdir(parents=True, exist_ok=True)
                _keep(place, kept)
            moved.append((place, kept))
            os.replace(file, place)
    except BaseException:
        for place, kept in reversed(moved):
            with suppress(OSError):
                if kept.exists():
                    os.replace(kept, place)
                else:
                    place.unlink(missing_ok=True)
        if made:
            shutil.rmtree(target, ignore_errors=True)
        raise


def _keep(place: Path, kept: Path) -> None:
    """A second name of a file, which stays in its place until another takes it; where the disk
    knows no such names a copy."""
    try:
        os.link(place, kept)
    except OSError:
        shutil.copy2(place, kept)


def _forget_stale(folder: Path) -> None:
    """Remove what a process that was killed long ago left half-written."""
    for one in folder.glob(f"{PREFIX}*"):
        with suppress(OSError):
            if time.time() - one.lstat().st_mtime > STALE:
                shutil.rmtree(one) if one.is_dir() and not one.is_symlink() else one.unlink()


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(Problem(f"cannot be written: {error.strerror or error}", file=str(path)))
