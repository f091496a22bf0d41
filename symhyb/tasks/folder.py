"""The folder of a sweep: which tasks there are, which are finished, and who may write.

study.json            all tasks in their order, with settings and keys
tasks/KEY/            of each finished task its files, put there at once
tasks/KEY/task.json   how it ended
running/KEY           a mark while it runs
lock                  held by the run that writes here, which a process that ends lets go
"""

import errno
import json
import os
import shutil
import socket
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from symhyb import __version__
from symhyb.errors import InputError, Problem
from symhyb.limits import TEXT_BYTES, content_of
from symhyb.tasks.expand import Task
from symhyb.writing import PREFIX, require_folder, write_file

INDEX, TASKS, RUNNING, LOCK, ENDED = "study.json", "tasks", "running", "lock", "task.json"
FORMAT = 1
INDEX_BYTES = 100 * TEXT_BYTES  # of all tasks with their settings
FULL = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO}
"""What no other task would be written with either."""

Why = Literal["", "input", "numerics", "fault", "killed"]
AGAIN = ("fault", "killed")
"""What a further run tries anew: it may end otherwise."""


@dataclass(frozen=True, slots=True)
class Listed:
    """A recording as ``study.json`` names it: its ``groups`` by grouping, and what is known of its
    ``parameters``, in the units of the model file."""

    name: str
    groups: tuple[tuple[str, str], ...] = ()
    parameters: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Entry:
    """A task as ``study.json`` names it, with the training recordings that it is made from."""

    name: str
    settings: tuple[tuple[str, str], ...]
    key: str
    recordings: tuple[Listed, ...] = ()


@dataclass(frozen=True, slots=True)
class Ended:
    """How a task ended: ``why`` it failed, empty if it did not, ``sentences`` that say so, and the
    ``seconds`` it took."""

    why: Why = ""
    sentences: tuple[str, ...] = ()
    seconds: float = 0.0


class FullError(Exception):
    """Nothing can be written to the folder; the message is the reason."""


@contextmanager
def held(directory: Path) -> Iterator[None]:
    """Hold the folder, made if it is new, so that no other run writes into it.

    Raises:
        InputError: another run holds it, or it cannot be written to.
    """
    require_folder(directory)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        stream = open(directory / LOCK, "a+", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        text = f"cannot be written: {error.strerror or error}"
        raise InputError(Problem(text, file=str(directory))) from None
    with stream:
        if not _lock(stream.fileno()):
            stream.seek(0)
            who = stream.read(200).strip() or "another process"
            text = f"is being written to by {who}; wait for its end, or name another folder"
            raise InputError(Problem(text, file=str(directory)))
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}")
        stream.flush()
        yield


def _lock(number: int) -> bool:
    """Lock an open file for as long as it is open; False if another process has it."""
    try:
        import fcntl
    except ImportError:  # Windows
        import msvcrt

        try:
            msvcrt.locking(number, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        except OSError:
            return False
        return True
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def write_index(directory: Path, title: str, tasks: Sequence[Task]) -> None:
    """Name all tasks of a study in their order.

    Raises:
        InputError: the file cannot be written.
    """
    content = {
        "format": FORMAT,
        "title": title,
        "symhyb": __version__,
        "tasks": [
            {
                "name": one.name,
                "settings": dict(one.settings),
                "key": one.key,
                "recordings": [
                    {
                        "name": source.name,
                        "groups": dict(source.groups),
                        "parameters": dict(source.parameters),
                    }
                    for source in one.study.train
                ],
            }
            for one in tasks
        ],
    }
    write_file(directory / INDEX, _text(content))


def read_index(directory: Path) -> tuple[str, tuple[Entry, ...]]:
    """The title of a study and its tasks.

    Raises:
        InputError: the folder is none of a sweep.
    """
    file = directory / INDEX
    if not file.is_file():
        text = (
            "holds no tasks of a study; symhyb run STUDY -o DIR leaves them, where it has a sweep"
        )
        raise InputError(Problem(text, file=str(directory)))
    content = _json(file, INDEX_BYTES)
    try:
        tasks = [
            Entry(
                one["name"],
                tuple(one["settings"].items()),
                _hash(one["key"]),
                tuple(map(_listed, one.get("recordings", ()))),
            )
            for one in content["tasks"]
        ]
        return str(content["title"]), tuple(tasks)
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        text = f"is no list of tasks: {error}"
        raise InputError(Problem(text, file=str(file))) from None


def _listed(one: dict[str, Any]) -> Listed:
    groups = tuple((str(by), str(name)) for by, name in one["groups"].items())
    known = tuple((str(path), float(value)) for path, value in one["parameters"].items())
    return Listed(str(one["name"]), groups, known)


def there(directory: Path) -> bool:
    """Whether a run left tasks in the folder."""
    tasks = directory / TASKS
    return tasks.is_dir() and any(not one.name.startswith(PREFIX) for one in tasks.iterdir())


def prepare(directory: Path) -> None:
    """Make the folders of tasks, and remove what a run that was killed left half-written."""
    try:
        sweep_out(directory)
        shutil.rmtree(directory / RUNNING, ignore_errors=True)
        for part in (TASKS, RUNNING):
            (directory / part).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            Problem(f"cannot be written: {error.strerror}", file=str(directory))
        ) from None


def sweep_out(directory: Path) -> None:
    """Remove what is half-written, and marks of nothing."""
    with suppress(OSError):
        (directory / RUNNING).rmdir()
    for one in (directory / TASKS).glob(f"{PREFIX}*"):
        shutil.rmtree(one, ignore_errors=True)


def ended(directory: Path, key: str) -> Ended | None:
    """How a task ended, None if it did not, or left no whole file."""
    file = directory / TASKS / key / ENDED
    if not file.is_file():
        return None
    try:
        content = _json(file, TEXT_BYTES)
        return Ended(content["why"], tuple(content["sentences"]), float(content["seconds"]))
    except (InputError, KeyError, TypeError, ValueError):
        return None


def finished(directory: Path, key: str) -> bool:
    """Whether nothing is left to do of a task."""
    one = ended(directory, key)
    return one is not None and one.why not in AGAIN


def begin(directory: Path, key: str) -> None:
    """Mark that a task runs.

    Raises:
        FullError: nothing can be written.
    """
    try:
        (directory / RUNNING / key).touch()
    except OSError as error:
        raise FullError(error.strerror or str(error)) from error


def begun(directory: Path, key: str) -> bool:
    """Whether a task is marked as running."""
    return (directory / RUNNING / key).exists()


def end(directory: Path, key: str) -> None:
    """Take the mark away."""
    with suppress(OSError):
        (directory / RUNNING / key).unlink(missing_ok=True)


@contextmanager
def whole(directory: Path, key: str) -> Iterator[Path]:
    """Yield an empty folder, which becomes that of the task when all went well. One that another
    run finished in the meantime stays.

    Raises:
        FullError: nothing can be written.
    """
    place = directory / TASKS / key
    try:
        work = Path(tempfile.mkdtemp(prefix=PREFIX, dir=directory / TASKS))
    except OSError as error:
        raise FullError(error.strerror or str(error)) from error
    try:
        yield work
        work.chmod(0o755)  # a temporary folder is private
        if not finished(directory, key):
            shutil.rmtree(place, ignore_errors=True)
            with suppress(FileExistsError):
                os.rename(work, place)
    except (OSError, InputError) as error:
        if full(error):
            raise FullError(_reason(error)) from error
        raise
    finally:
        shutil.rmtree(work, ignore_errors=True)


def leave_ended(folder: Path, how: Ended) -> None:
    """Write how a task ended into its folder.

    Raises:
        InputError: it cannot be written.
    """
    content = {"why": how.why, "sentences": how.sentences, "seconds": round(how.seconds, 2)}
    write_file(folder / ENDED, _text(content))


def full(error: BaseException | None) -> bool:
    """Whether an error came of a disk on which nothing can be written any more."""
    return _cause(error) is not None


def _cause(error: BaseException | None) -> OSError | None:
    while error is not None:
        if isinstance(error, OSError) and error.errno in FULL:
            return error
        error = error.__cause__ or error.__context__
    return None


def _reason(error: BaseException) -> str:
    cause = _cause(error)
    return (cause.strerror if cause is not None else "") or str(error)


def _hash(text: object) -> str:
    if not isinstance(text, str) or len(text) != 64 or set(text) - set("0123456789abcdef"):
        raise ValueError(f"{text!r} is no key")
    return text


def _text(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _json(file: Path, most: int) -> Any:
    try:
        return json.loads(content_of(file, most))
    except (ValueError, RecursionError) as error:
        raise InputError(Problem(f"is no JSON: {error}", file=str(file))) from None
