"""How a task ends: whole, by an error that is its own, or by a disk that is full."""

import errno
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from fakes import fake_diagnosis, friction
from sweeps import write_sweep

from symhyb.errors import InputError, NumericsError, Problem
from symhyb.study.file import read_study
from symhyb.study.run import run_study
from symhyb.tasks import work
from symhyb.tasks.expand import Task, tasks_of
from symhyb.tasks.folder import AGAIN, begun, ended, finished, prepare
from symhyb.writing import staged


@pytest.fixture
def task(tmp_path: Path) -> Task:
    study = read_study(write_sweep(tmp_path))
    prepare(tmp_path / "out")
    one = tasks_of(study)[1]
    return replace(one, study=work.portable(one.study))


def failing(monkeypatch: pytest.MonkeyPatch, fail: Callable[[], None]) -> None:
    monkeypatch.setattr(work, "carry_out", lambda study, say, leave: fail())


def test_a_task_leaves_the_files_of_a_diagnosis_and_what_went_in(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = fake_diagnosis(monkeypatch)(friction())
    monkeypatch.setattr("symhyb.study.run.apply", lambda model, *_: model)
    monkeypatch.setattr("symhyb.study.run._first_checks", lambda *_: None)
    monkeypatch.setattr(work, "leave_files", lambda result, folder: (folder / "a").touch())
    monkeypatch.chdir("/")  # as a worker elsewhere
    assert work.perform(task, tmp_path / "out") == work.Done(task.key)
    folder = tmp_path / "out" / "tasks" / task.key
    assert sorted(one.name for one in folder.iterdir()) == ["a", "manifest.json", "task.json"]
    said = json.loads((folder / "manifest.json").read_text())
    assert (said["task"], said["key"]) == (task.name, task.key)
    assert said["noise"] == {"level": 0.001, "seed": 0}
    assert [one["file"] for one in said["recordings"]] == ["r0.csv"]
    assert str(tmp_path) not in json.dumps(said)
    assert len(asked) == 1
    assert finished(tmp_path / "out", task.key)
    assert not begun(tmp_path / "out", task.key)
    work.perform(task, tmp_path / "out")
    assert len(asked) == 1  # nothing is done twice


def raising(error: Exception) -> Callable[[], None]:
    def fail() -> None:
        raise error

    return fail


@pytest.mark.parametrize(
    ("error", "why", "said"),
    [
        (InputError([Problem("a"), Problem("b")]), "input", ("a", "b")),
        (NumericsError("no solution"), "numerics", ("the numerics failed: no solution",)),
        (ZeroDivisionError("1/0"), "fault", ("ZeroDivisionError: 1/0; see symhyb-fault.txt of",)),
    ],
)
def test_an_error_is_how_a_task_ended(
    task: Task,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    error: Exception,
    why: str,
    said: tuple[str, ...],
) -> None:
    failing(monkeypatch, raising(error))
    assert work.perform(task, tmp_path / "out") == work.Done(task.key)
    how = ended(tmp_path / "out", task.key)
    assert how is not None
    assert how.why == why
    assert all(one.startswith(start) for one, start in zip(how.sentences, said, strict=True))
    assert finished(tmp_path / "out", task.key) == (why not in AGAIN)
    fault = tmp_path / "out" / "tasks" / task.key / "symhyb-fault.txt"
    assert fault.exists() == (why == "fault")


@pytest.mark.parametrize("how", ["plain", "staged"])
def test_a_full_disk_is_no_end_of_a_task(
    task: Task, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    """Where it is met by what writes files, and where that made a sentence of it."""
    error = OSError(errno.ENOSPC, "No space left on device")

    def fail() -> None:
        if how == "plain":
            raise error
        with staged(tmp_path / "elsewhere"):
            raise error

    failing(monkeypatch, fail)
    done = work.perform(task, tmp_path / "out")
    assert done == work.Done(task.key, "No space left on device")
    assert list((tmp_path / "out" / "tasks").iterdir()) == []


def test_a_study_with_a_sweep_is_no_single_diagnosis(tmp_path: Path) -> None:
    path = write_sweep(tmp_path, samples=0)
    with pytest.raises(InputError, match="sweep: states many diagnoses, which symhyb run performs"):
        run_study(path, tmp_path / "out")
