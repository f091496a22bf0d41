"""A sweep that is run: once each, whole or not at all, whoever is killed."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import sweeps
from sweeps import write_sweep

from symhyb.errors import InputError
from symhyb.study.file import read_study
from symhyb.tasks.folder import ended, held, there
from symhyb.tasks.outcome import read_outcomes
from symhyb.tasks.processes import Perform
from symhyb.tasks.rows import csv_text, rows_of
from symhyb.tasks.run import How, Ran, run_sweep

ROOT = Path(__file__).parents[2]


def run(folder: Path, perform: Perform, **how: object) -> Ran:
    study = read_study(folder / "study.toml")
    return run_sweep(study, folder / "out", How(**{"workers": 2, **how}), perform=perform)  # type: ignore[arg-type]


def table(folder: Path) -> str:
    return csv_text(rows_of(read_outcomes(folder / "out")))


def performed(folder: Path) -> list[str]:
    return (folder / "performed.txt").read_text().splitlines()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_sweep(tmp_path, samples=0)
    return tmp_path


def test_every_task_is_performed_once_and_kept(folder: Path) -> None:
    said: list[str] = []
    study = read_study(folder / "study.toml")
    ran = run_sweep(study, folder / "out", How(workers=2), said.append, perform=sweeps.quick)
    assert ran == Ran(6, 6, 0, {})
    assert len(performed(folder)) == 6
    assert [f"{one.done}/{one.total}" for one in said[1:]] == [f"{i}/6" for i in range(7)]  # type: ignore[attr-defined]
    assert sorted(one.name for one in (folder / "out").iterdir()) == ["lock", "study.json", "tasks"]
    with pytest.raises(InputError, match="6 of the 6 of this one are finished; go on with --res"):
        run(folder, sweeps.quick)
    assert run(folder, sweeps.quick, resume=True) == Ran(6, 6, 6, {})
    assert len(performed(folder)) == 6


@pytest.mark.thorough
def test_a_part_is_run_and_the_rest_later(folder: Path) -> None:
    assert run(folder, sweeps.quick, only=("recordings=r1.csv",)) == Ran(6, 2, 0, {})
    states = [one.state for one in read_outcomes(folder / "out").tasks]
    assert states == ["not run"] * 2 + ["finished"] * 2 + ["not run"] * 2
    assert run(folder, sweeps.quick, resume=True) == Ran(6, 6, 2, {})
    assert len(performed(folder)) == 6


@pytest.mark.thorough
def test_a_recording_that_changed_is_diagnosed_anew(folder: Path) -> None:
    run(folder, sweeps.quick)
    (folder / "r2.csv").write_text("another\n")
    assert run(folder, sweeps.quick, resume=True) == Ran(6, 6, 4, {})
    assert [name.partition(",")[0] for name in performed(folder)[6:]] == ["recordings=r2.csv"] * 2


@pytest.mark.thorough
def test_a_task_that_kills_its_worker_fails_and_no_other(folder: Path) -> None:
    ran = run(folder, sweeps.deadly)
    (name,) = ran.failed
    assert name == "recordings=r1.csv, noise=0.0"
    assert "was killed 3 times" in ran.failed[name]
    assert sorted(performed(folder)) == sorted(
        one.entry.name for one in read_outcomes(folder / "out").tasks if one.state == "finished"
    )
    assert len(performed(folder)) == 5
    again = run(folder, sweeps.quick, resume=True)  # with more memory, say
    assert (again.before, again.failed) == (5, {})


@pytest.mark.thorough
def test_a_worker_that_is_killed_once_costs_no_task(folder: Path) -> None:
    assert run(folder, sweeps.deadly_once).failed == {}
    assert sorted(set(performed(folder))) == sorted(performed(folder))
    undisturbed = table(folder)
    write_sweep(folder / "b", samples=0)
    run(folder / "b", sweeps.quick, workers=1)
    assert table(folder / "b") == undisturbed


@pytest.mark.slow
def test_a_full_disk_is_one_error_and_what_is_finished_stays(folder: Path) -> None:
    with pytest.raises(InputError) as caught:
        run(folder, sweeps.disk_full, workers=1)
    said = f"{folder / 'out'}: cannot be written: No space left on device; what is finished is kept"
    assert str(caught.value).startswith(said)
    left = [one.name for one in (folder / "out" / "tasks").iterdir()]
    assert left
    assert all(ended(folder / "out", key) for key in left)
    assert run(folder, sweeps.quick, resume=True).failed == {}


@pytest.mark.slow
def test_of_two_runs_into_one_folder_the_second_is_refused(folder: Path) -> None:
    with (
        held(folder / "out"),
        pytest.raises(InputError, match=rf"is being written to by process {os.getpid()} on "),
    ):
        run(folder, sweeps.quick)
    assert not there(folder / "out")
    assert run(folder, sweeps.quick).failed == {}


SCRIPT = """\
import sys
sys.path.insert(0, {tests!r})
import sweeps
from symhyb.study.file import read_study
from symhyb.tasks.run import How, run_sweep
run_sweep(read_study("study.toml"), "out", How(workers=2, resume=True), perform=sweeps.slow)
"""


@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(1, marks=pytest.mark.slow),
        *(pytest.param(seed, marks=pytest.mark.thorough) for seed in (2, 3)),
    ],
)
def test_what_is_killed_at_any_moment_goes_on_where_it_was(folder: Path, seed: int) -> None:
    script = SCRIPT.format(tests=str(ROOT / "tests"))
    whole = subprocess.Popen([sys.executable, "-c", script], cwd=folder, start_new_session=True)
    deadline = time.monotonic() + 60
    while not (folder / "performed.txt").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    time.sleep(random.Random(seed).uniform(0, 0.5))
    os.killpg(whole.pid, signal.SIGKILL)
    whole.wait()
    time.sleep(0.1)
    tasks = folder / "out" / "tasks"
    assert all(ended(folder / "out", one.name) for one in tasks.glob("[!.]*"))
    kept = {one.name: one.stat().st_ino for one in tasks.glob("[!.]*")}
    assert run(folder, sweeps.quick, resume=True).failed == {}
    assert not list(tasks.glob(".*"))
    assert {key: (tasks / key).stat().st_ino for key in kept} == kept
    write_sweep(folder / "b", samples=0)
    run(folder / "b", sweeps.quick)
    assert table(folder) == table(folder / "b")


@pytest.mark.slow
def test_the_rest_of_a_run_that_was_interrupted_is_kept(folder: Path) -> None:
    script = SCRIPT.format(tests=str(ROOT / "tests"))
    whole = subprocess.Popen(
        [sys.executable, "-c", script], cwd=folder, start_new_session=True, stderr=subprocess.PIPE
    )
    tasks, deadline = folder / "out" / "tasks", time.monotonic() + 60
    while not list(tasks.glob("[!.]*")) and time.monotonic() < deadline:
        time.sleep(0.01)
    os.killpg(whole.pid, signal.SIGINT)  # as a terminal does it
    _, said = whole.communicate(timeout=30)
    assert said.decode().count("Traceback") == 1, (
        said.decode()
    )  # of the script, which no command line ends
    assert said.decode().rstrip().endswith("KeyboardInterrupt")
    left = [one.name for one in tasks.iterdir()]
    assert 1 <= len(left) < 6
    assert all(ended(folder / "out", key) for key in left)
