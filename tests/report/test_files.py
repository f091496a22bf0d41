"""Files: written whole or not at all, in the units that their header says."""

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.errors import InputError
from symhyb.model.types import Model
from symhyb.report import to_json, write_diagnosis, write_report, write_simulation

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]


def test_diagnosis_is_the_contract_as_readable_json(cases: Cases, tmp_path: Path) -> None:
    path = tmp_path / "new" / "diagnosis.json"
    write_diagnosis(path, *cases["missing"]())
    text = path.read_text(encoding="utf-8")
    assert json.loads(text) == to_json(*cases["missing"]())
    assert "±" in text


def test_report_takes_its_title_from_the_model(cases: Cases, tmp_path: Path, model: Model) -> None:
    path = tmp_path / "report.html"
    write_report(path, *cases["null"](), model)
    assert "<title>Slide on a rail, driven by a motor: nothing missing</title>" in path.read_text(
        encoding="utf-8"
    )
    write_report(path, *cases["null"]())
    assert "<title>Diagnosis: nothing missing</title>" in path.read_text(encoding="utf-8")


def test_simulation_is_in_the_unit_of_the_sensor(
    cases: Cases, tmp_path: Path, model: Model
) -> None:
    verdict = cases["failed"]()[1]
    path = tmp_path / "simulation.csv"
    write_simulation(path, verdict.traces, model)
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == [
        "recording",
        "role",
        "t",
        "encoder_measured [mm]",
        "encoder_before [mm]",
        "encoder_after [mm]",
        "tacho_measured [rad/s]",
        "tacho_before [rad/s]",
        "tacho_after [rad/s]",
    ]
    trace = verdict.traces[0]
    assert len(rows) == len(trace.t)
    assert {row[0] for row in rows} == {"run.csv"}
    assert {row[1] for row in rows} == {"holdout"}
    read = [math.nan if row[3] == "" else float(row[3]) for row in rows]
    np.testing.assert_allclose(read, 1000.0 * trace.measured["encoder"], rtol=1e-8)
    np.testing.assert_allclose([float(row[2]) for row in rows], trace.t, rtol=1e-11)
    assert {row[6] for row in rows} == {""}  # a sensor without a signal
    assert rows[-1][4] == ""  # a simulation that stopped


def test_a_folder_that_cannot_be_written_gives_one_sentence(cases: Cases, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file where a folder should be")
    path = tmp_path / "taken" / "diagnosis.json"
    with pytest.raises(InputError, match="cannot be written: ") as caught:
        write_diagnosis(path, *cases["null"]())
    assert len(caught.value.problems) == 1
    assert str(caught.value).startswith(str(path))


def test_what_fails_leaves_the_old_file_and_no_rest(cases: Cases, tmp_path: Path) -> None:
    folder = tmp_path / "report.html"
    folder.mkdir()
    (folder / "kept").write_text("kept")
    with pytest.raises(InputError):
        write_report(folder, *cases["null"]())
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]
    assert (folder / "kept").read_text() == "kept"
