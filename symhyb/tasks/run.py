"""A study with a sweep, carried out: what is finished stays, what is not is performed."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.steps import Counted, Say, silent
from symhyb.study.file import Study
from symhyb.tasks.cluster import run_there
from symhyb.tasks.expand import Task, chosen, tasks_of
from symhyb.tasks.folder import (
    FullError,
    ended,
    finished,
    held,
    prepare,
    sweep_out,
    there,
    write_index,
)
from symhyb.tasks.processes import Perform, run_here
from symhyb.tasks.work import perform, portable


@dataclass(frozen=True, slots=True)
class How:
    """How tasks are run: in ``workers`` processes, as many as there are cores if None, or on the
    workers of a ``scheduler``; ``resume`` goes on in a folder that holds tasks, ``only`` are
    patterns of those that are wanted."""

    workers: int | None = None
    scheduler: str = ""
    resume: bool = False
    only: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Ran:
    """How many tasks a study has, ``wanted`` of them now; of these some were finished ``before``,
    and the names of those that ``failed`` are by what they failed of."""

    total: int
    wanted: int
    before: int
    failed: dict[str, str]


def run_sweep(
    study: Study,
    directory: str | os.PathLike[str],
    how: How | None = None,
    say: Say | None = None,
    perform: Perform = perform,
) -> Ran:
    """Perform the tasks of a study that are not finished, and leave their folders.

    Raises:
        InputError: the study or a model is wrong, another run writes into the folder, it holds
            tasks and nobody asked to go on, it cannot be written, or no scheduler answers. What is
            finished is kept.
    """
    how, say, folder = how or How(), say or silent, Path(directory).absolute()
    say("reading the study")
    tasks = tasks_of(study)
    wanted = chosen(tasks, how.only)
    with held(folder):
        _require_asked(folder, tasks, how)
        write_index(folder, study.title, tasks)
        prepare(folder)
        distinct = {task.key: task for task in wanted}
        left = [task for key, task in distinct.items() if not finished(folder, key)]
        before = len(distinct) - len(left)
        what = "diagnosing" if study.fit is None else "fitting"
        try:
            _run(left, folder, how, _counting(say, len(left), what), perform)
        except FullError as error:
            text = f"cannot be written: {error}; what is finished is kept, go on with --resume"
            raise InputError(Problem(text, file=str(directory))) from error
        finally:
            sweep_out(folder)
        failed = {}
        for task in wanted:
            one = ended(folder, task.key)
            if one is not None and one.why:
                failed[task.name] = "; ".join(one.sentences)
        return Ran(len(tasks), len(wanted), before, failed)


def done_of(tasks: Sequence[Task], directory: Path) -> int:
    """How many of the tasks are finished in a folder."""
    return sum(finished(directory, task.key) for task in tasks)


def _require_asked(folder: Path, tasks: Sequence[Task], how: How) -> None:
    if there(folder) and not how.resume:
        text = (
            f"holds tasks of a study already, {done_of(tasks, folder)} of the {len(tasks)} of this "
            "one are finished; go on with --resume, or name another folder"
        )
        raise InputError(Problem(text, file=str(folder)))


def _run(
    tasks: Sequence[Task],
    folder: Path,
    how: How,
    ended: Callable[[Task], None],
    perform: Perform,
) -> None:
    ready = [replace(task, study=portable(task.study)) for task in tasks]
    if not ready:
        return
    if how.scheduler:
        run_there(ready, folder, how.scheduler, ended, perform)
        return
    from joblib import cpu_count

    workers = how.workers if how.workers is not None else int(cpu_count())
    run_here(ready, folder, workers, ended, perform)


def _counting(say: Say, total: int, what: str) -> Callable[[Task], None]:
    """What says how many tasks have ended."""
    done = 0
    say(Counted(what, done, total))

    def ended(task: Task) -> None:
        nonlocal done
        done += 1
        say(Counted(what, done, total))

    return ended
