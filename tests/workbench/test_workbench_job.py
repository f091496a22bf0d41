"""A diagnosis in a process of its own: its request, its messages, its end."""

import json
import time
from pathlib import Path

import pytest

from symhyb.steps import Counted
from symhyb.workbench.diagnosing import say
from symhyb.workbench.job import Job, Progress, Request, with_message


def until_ended(job: Job, most: float = 120.0) -> Progress:
    """Wait until a job has ended."""
    end = time.monotonic() + most
    while job.progress().state == "running":
        assert time.monotonic() < end
        time.sleep(0.05)
    return job.progress()


def test_messages_end_a_diagnosis() -> None:
    begun = Progress(Path("out"))
    assert with_message(begun, {"done": True}).state == "done"
    failed = with_message(begun, {"problems": ["one", "two"]})
    assert (failed.state, failed.problems) == ("failed", ("one", "two"))
    assert with_message(begun, {}) is begun


def test_steps_are_lines_of_json(capsys: pytest.CaptureFixture[str]) -> None:
    say("reading")
    say(Counted("trying", 2, 7))
    first, second = map(json.loads, capsys.readouterr().out.splitlines())
    assert first == {"step": "reading", "pieces": None}
    assert second == {"step": "trying", "pieces": [2, 7]}


def test_wrong_files_are_said_by_the_process(rig: dict[str, Path], tmp_path: Path) -> None:
    output = tmp_path / "out"
    job = Job(Request(rig["model"], (tmp_path / "none.csv",), (), (("laser", "laser"),), output))
    ended = until_ended(job)
    assert ended.state == "failed"
    assert "none.csv" in ended.problems[0]
    assert any("reading the model" in step for step in ended.steps)
    assert not output.exists()


def test_a_diagnosis_can_be_stopped(rig: dict[str, Path], tmp_path: Path) -> None:
    job = Job(Request(rig["model"], (rig["first"],), (), (), tmp_path / "out"))
    job.stop()
    assert job.progress().state == "stopped"
    assert job._process.poll() is not None
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_diagnosis_leaves_its_files(rig: dict[str, Path], tmp_path: Path) -> None:
    job = Job(Request(rig["model"], (rig["first"],), (), (), tmp_path / "out"))
    assert until_ended(job, 600.0).state == "done"
    assert (tmp_path / "out" / "diagnosis.json").is_file()
