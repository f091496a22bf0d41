"""Tasks on the cores of this computer: worker processes of joblib's loky.

Of a worker that was killed nobody learns which task it had: all that wait fail at once. So the
tasks that were running then are suspects, and each is tried again alone, where it is certain. One
whose worker was killed ``ATTEMPTS`` times has failed.
"""

import signal
import threading
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future
from contextlib import contextmanager
from pathlib import Path

from symhyb.tasks.expand import Task
from symhyb.tasks.folder import FullError, begun, end, finished
from symhyb.tasks.work import Done, leave_failed, leave_interruptions, perform

ATTEMPTS = 3
"""How often a task is tried whose worker is killed."""
MANAGER = "ExecutorManagerThread"  # of a pool of loky, by its name
_ENVIRONMENT = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

Perform = Callable[[Task, Path], Done]


def run_here(
    tasks: Sequence[Task],
    directory: Path,
    workers: int,
    ended: Callable[[Task], None],
    perform: Perform = perform,
) -> None:
    """Perform tasks in ``workers`` processes; ``ended`` gets each task that has its folder.

    Raises:
        FullError: nothing can be written; what is finished is kept.
    """
    killed: Counter[str] = Counter()
    waiting = list(tasks)
    while waiting:
        firm = [task for task in waiting if not killed[task.key]]
        batch = firm or waiting[:1]
        done = _round(batch, directory, workers if firm else 1, ended, perform)
        waiting = [task for task in waiting if task.key not in done]
        for task in batch:
            if task.key in done or not begun(directory, task.key):
                continue
            end(directory, task.key)
            killed[task.key] += 1
            if killed[task.key] >= ATTEMPTS:
                leave_failed(directory, task.key, "killed", killed_sentence(ATTEMPTS))
                waiting.remove(task)
                ended(task)


@contextmanager
def _interruptions_wait() -> Iterator[None]:
    """Hold Ctrl-C back while processes are started, which then never get it: who started them ends
    them, and none complains that it was interrupted while it was loading."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _manager_is_quiet() -> Iterator[None]:
    """Say nothing of the thread of a pool that looks for a task which its shutdown took back."""
    before = threading.excepthook

    def said(what: threading.ExceptHookArgs) -> None:
        named = what.thread.name if what.thread is not None else ""
        if what.exc_type is not KeyError or not named.startswith(MANAGER):
            before(what)

    threading.excepthook = said
    try:
        yield
    finally:
        threading.excepthook = before


def killed_sentence(times: int) -> str:
    """Say that a task could not be ended."""
    return (
        f"the process that worked on it was killed {times} times, as one is for which the memory "
        "does not suffice; fewer --workers leave more of it to each"
    )


def _round(
    tasks: Iterable[Task],
    directory: Path,
    workers: int,
    ended: Callable[[Task], None],
    perform: Perform,
) -> set[str]:
    """Perform tasks until all are done or a worker is killed; the keys of those that are done."""
    from joblib.externals.loky import ProcessPoolExecutor, wait

    by_key = {task.key: task for task in tasks}
    done: set[str] = set()
    left, waiting = list(by_key.values()), set[Future[Done]]()
    pool = ProcessPoolExecutor(
        max_workers=min(workers, len(left)), initializer=leave_interruptions, env=_ENVIRONMENT
    )
    try:
        with warnings.catch_warnings():  # a worker that has grown large is exchanged, which is fine
            warnings.filterwarnings("ignore", message="A worker stopped while some jobs")
            while left or waiting:
                with _interruptions_wait():
                    while left and len(waiting) < workers:  # no more than run at once
                        waiting.add(pool.submit(perform, left.pop(0), directory))
                ready, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in ready:
                    one = future.result()
                    if one.full:
                        raise FullError(one.full)
                    done.add(one.key)
                    ended(by_key[one.key])
    except BrokenExecutor:
        for key in by_key.keys() - done:
            if finished(directory, key):
                done.add(key)
                ended(by_key[key])
    finally:
        with _manager_is_quiet():
            pool.shutdown(wait=True, kill_workers=True)
    return done
