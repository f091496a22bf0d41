"""Tasks on the workers of a Dask scheduler that runs in processes of its own."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
import sweeps
from sweeps import write_sweep

from symhyb.errors import InputError
from symhyb.study.file import read_study
from symhyb.tasks import cluster
from symhyb.tasks.outcome import read_outcomes
from symhyb.tasks.rows import csv_text, rows_of
from symhyb.tasks.run import How, Ran, run_sweep

TESTS = Path(__file__).parents[1]

CLUSTER = """\
import sys, time
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=2, processes=True,
                      dashboard_address=None) as running:
        print(running.scheduler_address, flush=True)
        sys.stdin.read()
"""


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """A scheduler with two workers, known by its address alone."""
    pytest.importorskip("distributed", reason="needs distributed: pip install 'symhyb[dask]'")
    script = tmp_path / "cluster.py"
    script.write_text(CLUSTER, encoding="utf-8")
    paths = os.pathsep.join([str(TESTS), str(TESTS.parent), os.environ.get("PYTHONPATH", "")])
    with subprocess.Popen(
        [sys.executable, str(script)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": paths},
        cwd=tmp_path,
        start_new_session=True,
        text=True,
    ) as running:
        assert running.stdout is not None
        yield running.stdout.readline().strip()
        with suppress(ProcessLookupError):  # a test may have killed it
            os.killpg(running.pid, signal.SIGKILL)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_sweep(tmp_path / "study", samples=0)
    return tmp_path / "study"


def run(folder: Path, address: str, perform=sweeps.quick) -> Ran:  # type: ignore[no-untyped-def]
    study = read_study(folder / "study.toml")
    how = How(scheduler=address, resume=True)
    return run_sweep(study, folder / "out", how, perform=perform)


@pytest.mark.slow
def test_workers_of_a_cluster_that_are_killed_cost_no_task(folder: Path, address: str) -> None:
    assert run(folder, address, sweeps.deadly_once) == Ran(6, 6, 0, {})
    write_sweep(folder / "b", samples=0)
    study = read_study(folder / "b" / "study.toml")
    run_sweep(study, folder / "b" / "out", How(workers=1), perform=sweeps.quick)
    tables = [csv_text(rows_of(read_outcomes(one / "out"))) for one in (folder, folder / "b")]
    assert tables[0] == tables[1]
    assert run(folder, address) == Ran(6, 6, 6, {})


@pytest.mark.thorough
def test_a_task_that_kills_every_worker_of_a_cluster_fails(folder: Path, address: str) -> None:
    ran = run(folder, address, sweeps.deadly)
    assert "recordings=r1.csv, noise=0.0" in ran.failed
    assert "was killed 4 times" in ran.failed["recordings=r1.csv, noise=0.0"]
    again = run(folder, address)
    assert again.failed == {}


@pytest.mark.thorough
def test_a_scheduler_that_is_lost_is_one_error_and_the_run_goes_on_elsewhere(
    folder: Path,
    address: str,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr(cluster, "CONNECT_S", 2)
    with pytest.raises(InputError) as caught:
        run(folder, address, sweeps.deadly_to_all)
    (one,) = caught.value.problems
    assert (one.place, one.file) == ("--scheduler", address)
    assert "the scheduler answers no more within 2 s" in one.text
    assert not caplog.records
    study = read_study(folder / "study.toml")
    ran = run_sweep(study, folder / "out", How(workers=1, resume=True), perform=sweeps.quick)
    assert (ran.total, ran.failed) == (6, {})


def test_a_scheduler_that_does_not_answer_is_one_error_within_seconds(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed", reason="needs distributed: pip install 'symhyb[dask]'")
    monkeypatch.setattr(cluster, "CONNECT_S", 1)
    for address in ("tcp://127.0.0.1:1", "nonsense://x"):
        begun = time.monotonic()
        with pytest.raises(InputError) as caught:
            run(folder, address)
        (one,) = caught.value.problems
        assert (one.place, one.file) == ("--scheduler", address)
        assert "no scheduler answers within 1 s" in one.text
        assert time.monotonic() - begun < 10


def test_without_dask_the_extra_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r'run: pip install "symhyb\[dask\]"'):
        run(folder, "tcp://127.0.0.1:1")


def test_a_worker_that_does_not_see_the_folder_is_one_error(folder: Path) -> None:
    from symhyb.tasks.expand import tasks_of

    task = tasks_of(read_study(folder / "study.toml"))[0]
    done = cluster._performed(sweeps.quick, task, str(folder / "nowhere"))
    assert "does not see this folder; it must be shared" in done.full
