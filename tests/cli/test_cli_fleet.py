"""Fleets on the command line: numbers, units that deviate, files, and what to look at next."""

import json
from pathlib import Path

import numpy as np
import pytest
from command import Call
from fleets import write_fits

COVARIANCE = np.diag([0.5, 0.01, 0.0005]) ** 2


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    chance = np.random.default_rng(0)
    spread = np.array([2.0, 0.05, 0.003])
    values = np.array([100.0, 2.0, 1.0]) + spread * chance.standard_normal((40, 3))
    values[8, 0] += 40
    groups = [{"drive": f"d{i}", "warm": str(20 + i % 7)} for i in range(40)]
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    return write_fits(tmp_path / "out", values, COVARIANCE, groups, states={3: ""})


def test_a_fleet_is_shown_and_written(symhyb: Call, folder: Path) -> None:
    files = ("--csv", "units.csv", "--picture", "fleet.svg")
    done = symhyb("fleet", "out", "--unit", "drive", "--over", "warm", *files)
    assert done.status == 1, done.err
    assert done.out.startswith("a fleet\n39 units: 38 alike, 1 deviates\n")
    assert "d8: k is 4" in done.out
    assert "note: 1 tasks are not run" in done.out
    assert done.out.endswith("next: symhyb next out\n")
    assert len(Path("units.csv").read_text().splitlines()) == 40
    assert Path("fleet.svg").stat().st_size > 1000
    again = symhyb("fleet", "out", *files)
    assert (again.status, again.out) == (2, "")
    assert "--force replaces it" in again.err
    facts = json.loads(symhyb("fleet", "out", "--unit", "drive", "--json").out)
    assert facts["deviating"] == ["d8"]


def test_what_to_look_at_next(symhyb: Call, folder: Path) -> None:
    done = symhyb("next", "out", "--unit", "drive", "--over", "warm")
    assert done.status == 0, done.err
    first, _, second, *_ = done.out.splitlines()
    assert first.startswith("  1. d8: k is ")
    assert second == "  2. d3: not run; nothing of its unit is"
    assert done.out.splitlines()[1].strip() == "r8.csv"
    (one,) = json.loads(symhyb("next", "out", "--most", "1", "--json").out)
    assert (one["why"], one["unit"]) == ("numbers", "r8.csv")


def test_what_is_wrong_is_said(symhyb: Call, folder: Path, tmp_path: Path) -> None:
    done = symhyb("fleet", "out", "--over", "warn")
    assert (done.status, done.out) == (2, "")
    assert "did you mean 'warm'" in done.err
    assert "and 38 more" in done.err
    assert len(done.err.splitlines()) == 1
    done = symhyb("fleet", tmp_path)
    assert "holds no tasks of a study" in done.err
