"""``symhyb watch`` on the command line: what it prints, logs and ends with, killed or not."""

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command import Call

from tests.pushed import DRIVEN_MASS, STEP, STIFFNESS, pushed

SECONDS = 30.0


@pytest.fixture
def model(tmp_path: Path) -> Path:
    file = tmp_path / "mass.toml"
    file.write_text(DRIVEN_MASS, encoding="utf-8")
    return file


def written(file: Path, *parts: float) -> Path:
    """A recording of some seconds for each stiffness, one behind the other."""
    lines, first = ["t,f,laser"], 0.0
    for seed, stiffness in enumerate(parts):
        run = pushed(seed, samples=round(SECONDS / STEP), stiffness=stiffness)
        rows = zip(run.t + first, run.inputs["f"], run.sensors["laser"], strict=True)
        lines += [f"{t:.4f},{f:.6f},{x:.8f}" for t, f, x in rows]
        first += SECONDS
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def test_a_change_is_printed_logged_and_ends_with_one(
    model: Path, tmp_path: Path, symhyb: Call
) -> None:
    source, log = written(tmp_path / "rig.csv", STIFFNESS, 1.1 * STIFFNESS), tmp_path / "log.jsonl"
    done = symhyb(
        "watch", str(model), str(source), "--once", "--reference", "29", "--log", str(log)
    )
    assert done.status == 1
    assert "Something has changed since" in done.out
    assert "parameter k by 2." in done.out
    events = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    assert [event["kind"] for event in events][:3] == ["ready", "changed", "named"]


def test_without_a_change_it_ends_with_none(model: Path, tmp_path: Path, symhyb: Call) -> None:
    source = written(tmp_path / "rig.csv", STIFFNESS, STIFFNESS)
    done = symhyb("watch", str(model), str(source), "--once", "--reference", "29", "--json")
    assert done.status == 0
    kinds = [json.loads(line)["kind"] for line in done.out.splitlines()]
    assert kinds == ["ready", "ended"]


@pytest.mark.parametrize(
    ("source", "said"),
    [("none.csv", "No such file"), ("udp:0", "is no port")],
)
def test_a_source_that_is_none_is_one_error(
    model: Path, symhyb: Call, source: str, said: str
) -> None:
    done = symhyb("watch", str(model), source, "--once")
    assert done.status == 2
    assert said in done.err


@pytest.mark.slow
def test_a_log_survives_a_kill(model: Path, tmp_path: Path) -> None:
    source, log = written(tmp_path / "rig.csv", STIFFNESS), tmp_path / "log.jsonl"
    watch = [sys.executable, "-m", "symhyb", "watch", str(model), str(source)]
    with subprocess.Popen([*watch, "--reference", "29", "--log", str(log)]) as running:
        until = time.monotonic() + 60
        while not (log.exists() and log.read_text(encoding="utf-8").endswith("\n")):
            assert running.poll() is None
            assert time.monotonic() < until
            time.sleep(0.1)
        running.kill()
    (line,) = log.read_text(encoding="utf-8").splitlines()
    assert json.loads(line)["kind"] == "ready"
