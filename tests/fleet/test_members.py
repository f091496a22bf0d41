"""The units of a fleet, read from a folder, and what is wrong with one that has none."""

import json
from pathlib import Path

import numpy as np
import pytest
from fleets import write_fits

from symhyb.errors import InputError
from symhyb.fleet.members import members_of, widths_of
from symhyb.tasks.outcome import read_outcomes

COVARIANCE = np.diag([1.0, 0.01, 1e-4])
VALUES = np.array([[100.0, 2.0, 1.0], [101.0, 2.1, 1.0], [99.0, 1.9, 1.0], [100.0, 2.0, 1.0]])
GROUPS = [{"drive": f"d{i // 2}", "warm": str(20 + i), "word": "x"} for i in range(4)]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_fits(tmp_path, VALUES, COVARIANCE, GROUPS)


def test_recordings_are_grouped_to_units(folder: Path) -> None:
    members = members_of(read_outcomes(folder), "drive", ["warm", "m"])
    assert [one.name for one in members] == ["d0", "d1"]
    assert members[0].conditions.tolist() == [[20, 1.5], [21, 1.5]]
    assert members[1].tasks == ("recordings=r2.csv", "recordings=r3.csv")
    assert members[0].freedom == 1000.0
    assert members[0].left == 1.0
    assert [one.name for one in members_of(read_outcomes(folder))][:2] == ["r0.csv", "r1.csv"]


def said(folder: Path, unit: str = "", *conditions: str) -> str:
    with pytest.raises(InputError) as caught:
        members_of(read_outcomes(folder), unit, conditions)
    return "\n".join(map(str, caught.value.problems))


def test_what_recordings_do_not_state_is_said(folder: Path) -> None:
    assert "did you mean 'drive'? (and 3 more)" in said(folder, "drives")
    assert "did you mean 'warm'" in said(folder, "", "warn")
    assert "must be a number, but 'r0.csv' states 'x'" in said(folder, "", "word")


def test_tasks_that_are_no_fits_of_one_kind_are_refused(folder: Path) -> None:
    index = json.loads((folder / "study.json").read_text())
    index["tasks"][0]["settings"]["noise"] = "0.1"
    (folder / "study.json").write_text(json.dumps(index))
    assert "its sweep varies noise too" in said(folder)
    file = folder / "tasks" / f"{1:064x}" / "fit.json"
    content = json.loads(file.read_text())
    content["numbers"][0]["name"] = "c"
    file.write_text(json.dumps(content))
    assert "fitted different numbers" in said(folder)


def test_a_folder_without_anything_finished_says_so(tmp_path: Path) -> None:
    folder = write_fits(tmp_path, VALUES, COVARIANCE, GROUPS, states=dict.fromkeys(range(4), ""))
    assert "no task is finished" in said(folder)


def test_a_number_that_was_not_determined_is_as_wide_as_can_be(folder: Path) -> None:
    file = folder / "tasks" / f"{1:064x}" / "fit.json"
    content = json.loads(file.read_text())
    content["covariance"][1] = [None] * 3
    file.write_text(json.dumps(content))
    members = members_of(read_outcomes(folder))
    assert members[1].fits[0].sd[1] == np.inf
    assert np.isfinite(widths_of(members)).all()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("covariance", [[1.0]]),
        ("covariance", "x"),
        ("covariance", [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        ("numbers", []),
        ("samples", None),
        ("noise_multiple", {}),
        ("numbers", [{"name": "k", "unit": "1", "value": "x"}]),
    ],
)
def test_a_damaged_fit_is_refused(folder: Path, key: str, value: object) -> None:
    file = folder / "tasks" / f"{1:064x}" / "fit.json"
    content = json.loads(file.read_text())
    file.write_text(json.dumps({**content, key: value}))
    with pytest.raises(InputError, match="is no fit"):
        read_outcomes(folder)
