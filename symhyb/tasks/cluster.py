"""Tasks on the workers of a Dask scheduler, which see the same folders as this computer.

A worker that is killed loses its task, and the scheduler gives it to another one. A scheduler that
is lost is looked for again, and what is not finished is handed in anew.
"""

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from symhyb.errors import InputError, Problem
from symhyb.tasks.expand import Task
from symhyb.tasks.folder import FullError, finished
from symhyb.tasks.processes import Perform, killed_sentence
from symhyb.tasks.work import leave_failed, perform

CONNECT_S = 8
"""How long a scheduler has to answer."""
CONNECTIONS = 4
"""How often it is asked, where the connection is lost before a task ends."""
KEY = "symhyb-"
_LOGGERS = ("distributed", "distributed.client", "distributed.core", "distributed.batched")


def run_there(
    tasks: Sequence[Task],
    directory: Path,
    address: str,
    ended: Callable[[Task], None],
    perform: Perform = perform,
) -> None:
    """Perform tasks on the workers of the scheduler at an address, as ``tcp://host:8786``.
    ``ended`` gets each task that has its folder.

    Raises:
        InputError: Dask is not installed, no scheduler answers, or it is lost again and again.
        FullError: nothing can be written.
    """
    waiting, lost, again = list(tasks), 0, False
    while waiting:
        before = len(waiting)
        with _quiet():
            client = _connected(address, again)
            try:
                done = _round(client, waiting, directory, ended, perform)
            finally:
                _closed(client)
        again = True
        waiting = [task for task in waiting if task.key not in done]
        lost = 0 if len(waiting) < before else lost + 1
        if waiting and lost >= CONNECTIONS:
            text = f"the scheduler was lost {lost} times with no task ended in between"
            raise InputError(Problem(text, "--scheduler", address))


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Dask's log off the terminal: what it says of a lost connection is said in a sentence."""
    loggers = [logging.getLogger(name) for name in _LOGGERS]
    levels = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for one, level in zip(loggers, levels, strict=True):
            one.setLevel(level)


def _connected(address: str, again: bool) -> Any:
    """A client of the scheduler."""
    try:
        from distributed import Client
    except ImportError:
        text = (
            'needs the package distributed, which is not installed; run: pip install "symhyb[dask]"'
        )
        raise InputError(Problem(text, "--scheduler")) from None
    try:
        return Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError, ImportError) as error:
        said = (str(error).splitlines() or [type(error).__name__])[0]
        what = "the scheduler answers no more" if again else "no scheduler answers"
        text = f"{what} within {CONNECT_S} s: {said}; start one with: dask scheduler"
        raise InputError(Problem(text, "--scheduler", address)) from None


def _closed(client: Any) -> None:
    with suppress(OSError, TimeoutError):
        client.close(timeout=CONNECT_S)


def _round(
    client: Any,
    tasks: Sequence[Task],
    directory: Path,
    ended: Callable[[Task], None],
    perform: Perform,
) -> set[str]:
    """Hand tasks in and wait for them; the keys of those that ended before the connection did."""
    from distributed import as_completed

    by_key = {task.key: task for task in tasks}
    futures = [
        client.submit(_performed, perform, task, str(directory), key=KEY + task.key, pure=False)
        for task in tasks
    ]
    done: set[str] = set()
    try:
        for future in as_completed(futures, loop=client.loop):
            task = by_key[future.key.removeprefix(KEY)]
            if future.status == "finished":
                one = future.result()
                if one.full:
                    raise FullError(one.full)
            elif future.status == "error":
                _failed(future.exception(), task, directory)
            else:  # the connection is lost
                break
            done.add(task.key)
            ended(task)
    except (OSError, TimeoutError):  # lost, too
        pass
    for key in by_key.keys() - done:
        if finished(directory, key):
            done.add(key)
            ended(by_key[key])
    return done


def _failed(error: BaseException, task: Task, directory: Path) -> None:
    """Leave the folder of a task that no worker ended."""
    from distributed import KilledWorker

    if not isinstance(error, KilledWorker):
        said = f"{type(error).__name__}: {str(error)[:300]}"
        leave_failed(directory, task.key, "killed", f"no worker could perform it: {said}")
        return
    allowed = int(getattr(error, "allowed_failures", 3))
    leave_failed(directory, task.key, "killed", killed_sentence(allowed + 1))


def _performed(perform: Perform, task: Task, directory: str) -> Any:
    """Perform a task in a worker, which must see the folder of the run."""
    import socket

    from symhyb.tasks.work import Done

    if not Path(directory).is_dir():
        host = socket.gethostname()
        return Done(task.key, f"the worker on {host} does not see this folder; it must be shared")
    return perform(task, Path(directory))
