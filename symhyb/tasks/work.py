"""One task, as a worker performs it: a diagnosis or a fit whose files are put in place at once."""

import json
import signal
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from symhyb.errors import InputError, NumericsError, visible
from symhyb.fault import NAME, fault_text
from symhyb.numeric.kernels.threads import one_thread
from symhyb.study.file import Study
from symhyb.study.run import StudyResult, carry_out, leave_files, manifest
from symhyb.tasks.expand import Task
from symhyb.tasks.fitting import leave_fit
from symhyb.tasks.folder import Ended, FullError, Why, begin, end, finished, leave_ended, whole
from symhyb.writing import write_file

_ALONE = threading.Lock()
"""Functions of CasADi are not made for two threads: a process performs one task at a time, however
many threads a worker of a cluster has."""


@dataclass(frozen=True, slots=True)
class Done:
    """A worker is done with a task; ``full`` is why nothing can be written any more."""

    key: str
    full: str = ""


def perform(task: Task, directory: Path) -> Done:
    """Perform a task and leave its folder, whether it succeeds or fails. One that is finished is
    left as it is. The linear algebra gets one thread: processes are several."""
    with _ALONE, one_thread():
        if finished(directory, task.key):
            return Done(task.key)
        try:
            begin(directory, task.key)
            _perform(task, directory)
        except FullError as error:
            return Done(task.key, str(error))
        finally:
            end(directory, task.key)
    return Done(task.key)


def leave_interruptions() -> None:
    """Let Ctrl-C end the run, which ends its workers, and not each worker by itself."""
    with suppress(ValueError):  # a thread that is not the main one
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def leave_failed(directory: Path, key: str, why: Why, sentence: str) -> None:
    """Leave the folder of a task that no worker could end.

    Raises:
        FullError: nothing can be written.
    """
    with whole(directory, key) as folder:
        leave_ended(folder, Ended(why, (sentence,)))


def _perform(task: Task, directory: Path) -> None:
    started = time.perf_counter()
    try:
        with whole(directory, task.key) as folder:
            if task.study.fit is not None:
                leave_fit(task, folder)
            else:
                carry_out(task.study, None, lambda result: _leave(task, result, folder))
            leave_ended(folder, Ended(seconds=time.perf_counter() - started))
        return
    except FullError:
        raise
    except Exception as error:
        how, text = _failed(error, time.perf_counter() - started)
    with whole(directory, task.key) as folder:
        if text:
            write_file(folder / NAME, text)
        leave_ended(folder, how)


def _failed(error: Exception, seconds: float) -> tuple[Ended, str]:
    """How a task ended by an error, and the text of a fault of symhyb itself."""
    match error:
        case InputError():
            return Ended("input", tuple(map(str, error.problems)), seconds), ""
        case NumericsError():
            return Ended("numerics", (f"the numerics failed: {error}",), seconds), ""
    said = f"{type(error).__name__}: {visible(str(error))[:300]}; see {NAME} of this task"
    return Ended("fault", (said,), seconds), fault_text(error)


def _leave(task: Task, result: StudyResult, folder: Path) -> None:
    """The files of a diagnosis, and what went into it."""
    leave_files(result, folder)
    content = {"task": task.name, "key": task.key, **manifest(result)}
    write_file(folder / "manifest.json", json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def portable(study: Study) -> Study:
    """A study whose files are found from any working directory, and which names no file of its own:
    the study file is that of the whole sweep."""

    def absolute(path: Path | None) -> Path | None:
        return None if path is None else path.absolute()

    return replace(
        study,
        file=None,
        model=study.model.absolute(),
        train=tuple(replace(one, file=absolute(one.file)) for one in study.train),
        holdout=tuple(replace(one, file=absolute(one.file)) for one in study.holdout),
    )
