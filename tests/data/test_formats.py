"""One door for files: several loggers of one recording, and what stands behind a name."""

import numpy as np
import pytest

from symhyb.data.files.formats import files_of, read_table
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


@pytest.fixture
def loggers(write, table, signals):
    """A rig at 100 Hz and a logger of its own for acceleration, at 20 Hz and 3 ms later."""
    slow = {"t": signals["t"][::5] + 0.003, "accel": signals["accel"][::5]}
    rig = write("rig.csv", table({name: signals[name] for name in ("t", "f", "laser")}))
    return rig, write("imu.csv", table(slow))


def test_two_loggers_are_one_recording_with_two_times(model, loggers, signals):
    rig, imu = loggers
    recording = read_recording(f"{rig}+{imu}", model)
    measured = np.isfinite(recording.sensors["accel"])
    np.testing.assert_allclose(recording.t[measured], signals["t"][::5] + 0.003)
    np.testing.assert_allclose(recording.sensors["accel"][measured], signals["accel"][::5])
    lasers = np.isfinite(recording.sensors["laser"])
    np.testing.assert_allclose(recording.sensors["laser"][lasers], signals["laser"] / 1e3)
    assert "channels with times of their own are merged: f+laser, accel" in recording.notes


def test_the_second_file_stands_beside_the_first_or_is_found_by_itself(
    loggers, tmp_path, monkeypatch
):
    rig, imu = loggers
    table = read_table(f"{rig}+imu.csv")
    assert table.names() == ["rig.t", "rig.f", "rig.laser", "imu.t", "imu.accel"]
    assert read_table(f"{rig}+imu.csv#imu").names() == ["t", "accel"]
    assert files_of(f"{rig}+imu.csv#imu") == (rig, imu)
    other = tmp_path / "other"
    other.mkdir()
    (other / "imu.csv").write_text("t,accel\n0,7\n")
    monkeypatch.chdir(other)
    assert files_of(f"{rig}+imu.csv") == (rig, imu)  # not that of the folder it is called in
    assert read_table(f"{rig}+{other / 'imu.csv'}").find("imu.accel")[0].values.tolist() == [7.0]


def test_files_that_are_called_alike_are_numbered(loggers, tmp_path):
    rig, _ = loggers
    twin = tmp_path / "twin"
    twin.mkdir()
    (twin / "rig.csv").write_bytes(rig.read_bytes())
    table = read_table(f"{rig}+twin/rig.csv")
    assert table.names() == [f"{k}.{name}" for k in (1, 2) for name in ("t", "f", "laser")]
    assert table.sha256 != read_table(rig).sha256


def test_a_plus_in_the_name_of_a_file_is_no_second_file(write, table, signals):
    path = write("left+right.csv", table(signals))
    assert files_of(path) == (path,)
    assert read_table(path).names() == list(signals)


def test_a_logger_that_is_not_there_is_one_sentence(loggers):
    with pytest.raises(InputError, match=r"imv\.csv: does not exist; did you mean 'imu\.csv'"):
        read_table(f"{loggers[0]}+imv.csv")
