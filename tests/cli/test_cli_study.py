"""Studies on the command line: run a sweep, go on with it, its table, and two of them compared."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command import Call
from sweeps import SWEEP, quick, write_sweep

from symhyb.tasks import run as running
from symhyb.tasks.folder import held


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A study with a sweep in the working folder, of which one process makes all tasks at once."""
    write_sweep(tmp_path, samples=0)

    def at_once(tasks, directory, workers, ended, perform) -> None:  # type: ignore[no-untyped-def]
        for task in tasks:
            quick(task, directory)
            ended(task)

    monkeypatch.setattr(running, "run_here", at_once)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_sweep_is_listed_run_and_shown(symhyb: Call, folder: Path) -> None:
    listed = symhyb("run", "study.toml", "-o", "out", "--dry-run")
    assert listed.status == 0
    assert len(listed.out.splitlines()) == 7
    assert listed.out.splitlines()[0].endswith("  recordings=r0.csv, noise=0.0")
    assert listed.out.endswith("6 tasks, 6 of them not finished\n")
    assert not (folder / "out").exists()
    part = symhyb("run", "study.toml", "-o", "out", "--only", "noise=0.0")
    assert part.status == 0
    assert part.out == "3 of 6 tasks: 3 finished, 0 failed\nnext: symhyb results out\n"
    refused = symhyb("run", "study.toml", "-o", "out")
    assert refused.status == 2
    assert "3 of the 6 of this one are finished; go on with --resume" in refused.err
    rest = symhyb("run", "study.toml", "-o", "out", "--resume")
    assert rest.out.startswith("6 tasks: 6 finished (3 before), 0 failed\n")
    shown = symhyb("results", "out", "--csv", "t.csv", "--times")
    assert shown.out.startswith("a mass with friction\n")
    assert shown.out.count("missing physics") == 6
    assert "q.coulomb = 0.5" in shown.out
    assert shown.out.endswith("6 tasks: 6 finished, 0 failed, 0 not run\n")
    lines = (folder / "t.csv").read_text().splitlines()
    assert len(lines) == 7
    assert lines[0].startswith("task,recordings,noise,state,verdict,found,q.coulomb [N],")


def test_two_studies_are_compared(symhyb: Call, folder: Path) -> None:
    for name in ("a", "b"):
        symhyb("run", "study.toml", "-o", name)
    same = symhyb("compare-studies", "a", "b")
    assert (same.status, same.out.splitlines()[0]) == (0, "6 tasks of both: 0 differ")
    (folder / "r1.csv").write_text("changed\n")
    symhyb("run", "study.toml", "-o", "b", "--resume", "--only", "recordings=r[01].csv")
    other = symhyb("compare-studies", "a", "b")
    assert other.status == 1
    assert other.out.startswith("6 tasks of both: 2 differ\n")
    assert "recordings=r1.csv, noise=0.0\n  q.coulomb: 0.5" in other.out
    assert " deviations)" in other.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--workers", "2", "--scheduler", "x"), "the scheduler has workers of its own"),
        (("--only", "noise=7"), "--only noise=7: fits no task"),
    ],
)
def test_options_that_do_not_fit_are_refused(
    symhyb: Call, folder: Path, arguments: tuple[str, ...], said: str
) -> None:
    done = symhyb("run", "study.toml", "-o", "out", *arguments)
    assert (done.status, done.out) == (2, "")
    assert said in done.err
    assert not (folder / "out").exists()


def test_options_of_a_sweep_are_refused_without_one(symhyb: Call, folder: Path) -> None:
    (folder / "plain.toml").write_text(SWEEP.partition("[sweep]")[0])
    for option in ("--resume", "--dry-run", "--workers=2"):
        done = symhyb("run", "plain.toml", "-o", "out", option)
        assert done.status == 2
        assert "plain.toml: has no [sweep], for which --workers" in done.err


def test_a_folder_in_use_and_one_without_tasks(symhyb: Call, folder: Path) -> None:
    with held(folder / "out"):
        done = symhyb("run", "study.toml", "-o", "out")
    assert done.status == 2
    assert "is being written to by process" in done.err
    assert symhyb("results", "out").status == 2
    assert symhyb("compare-studies", "out", "none").status == 2


def start(folder: Path, *options: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "symhyb", "run", "study.toml", "-o", "out", *options]
    return subprocess.Popen(
        command, cwd=folder, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def csv(symhyb: Call, folder: Path) -> bytes:
    assert symhyb("results", folder / "out", "--csv", folder / "t.csv").status == 0
    return (folder / "t.csv").read_bytes()


def left(folder: Path) -> list[str]:
    return sorted(one.name for one in (folder / "out" / "tasks").glob("[!.]*"))


def until(folder: Path, count: int, running: subprocess.Popen[bytes]) -> None:
    """Wait until so many tasks are finished."""
    deadline = time.monotonic() + 300
    while running.poll() is None and time.monotonic() < deadline:
        if (folder / "out" / "tasks").is_dir() and len(left(folder)) >= count:
            return
        time.sleep(0.05)


@pytest.mark.thorough
def test_a_run_that_is_killed_or_interrupted_ends_as_an_undisturbed_one(
    symhyb: Call, tmp_path: Path
) -> None:
    """Real diagnoses: the process group is killed, then interrupted, then the run goes on."""
    write_sweep(tmp_path / "a", samples=200)
    killed = start(tmp_path / "a")
    until(tmp_path / "a", 1, killed)
    time.sleep(int.from_bytes(os.urandom(1)) / 128)
    os.killpg(killed.pid, signal.SIGKILL)
    killed.communicate()
    first = left(tmp_path / "a")
    assert first
    interrupted = start(tmp_path / "a", "--resume")
    until(tmp_path / "a", len(first) + 1, interrupted)
    os.killpg(interrupted.pid, signal.SIGINT)
    _, said = interrupted.communicate(timeout=60)
    if interrupted.returncode:  # it was not quicker
        assert interrupted.returncode == 130
        assert b"go on with: symhyb run study.toml -o out --resume" in said
        assert b"Traceback" not in said
    kept = {key: (tmp_path / "a/out/tasks" / key).stat().st_ino for key in left(tmp_path / "a")}
    assert set(first) <= set(kept)
    out, said = start(tmp_path / "a", "--resume").communicate(timeout=500)
    assert out.decode().startswith(f"6 tasks: 6 finished ({len(kept)} before), 0 failed"), said
    again = {key: (tmp_path / "a/out/tasks" / key).stat().st_ino for key in kept}
    assert again == kept  # nothing was computed twice
    write_sweep(tmp_path / "b", samples=200)
    out, said = start(tmp_path / "b", "--workers", "1").communicate(timeout=500)
    assert out.decode().startswith("6 tasks: 6 finished, 0 failed"), said
    assert csv(symhyb, tmp_path / "a") == csv(symhyb, tmp_path / "b")
    assert b",finished,missing physics,x.coulomb," in csv(symhyb, tmp_path / "a")
