"""The value that everything downstream starts from, and the whole way from file to value."""

import hashlib
import json
import pickle
import re

import numpy as np
import pytest

from symhyb.data.recording import Recording, read_recording
from symhyb.errors import InputError


@pytest.fixture
def recording(model, write, table, signals) -> Recording:
    return read_recording(write("run.csv", table(signals)), model)


def test_values_are_in_si_and_nothing_is_noted(recording, signals):
    assert recording.name == "run.csv"
    np.testing.assert_allclose(recording.t, signals["t"], rtol=1e-14)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"], rtol=1e-14)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1000, rtol=1e-14)
    np.testing.assert_allclose(recording.sensors["accel"], signals["accel"], rtol=1e-14)
    assert recording.notes == ()
    assert recording.duration == pytest.approx(0.99)


def test_the_hash_is_that_of_the_bytes_of_the_file(model, write, table, signals):
    text = table(signals)
    recording = read_recording(write("run.csv", text), model)
    assert recording.sha256 == hashlib.sha256(text.encode()).hexdigest()


def test_a_recording_is_a_value(recording):
    with pytest.raises(AttributeError):
        recording.name = "other"
    for array in (recording.t, *recording.inputs.values(), *recording.sensors.values()):
        assert array.dtype == np.float64
        assert array.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    again = pickle.loads(pickle.dumps(recording))
    np.testing.assert_array_equal(again.sensors["laser"], recording.sensors["laser"])


def test_split_keeps_every_sample_once_and_the_time(recording):
    before, after = recording.split(0.4)
    assert (before.t[-1], after.t[0]) == (0.39, 0.4)
    for name in ("laser", "accel"):
        joined = np.concatenate([before.sensors[name], after.sensors[name]])
        np.testing.assert_array_equal(joined, recording.sensors[name])
    assert before.notes == ("part of run.csv before 0.4 s",)
    assert after.notes == ("part of run.csv from 0.4 s on",)
    assert before.sha256 == recording.sha256
    assert not after.inputs["f"].flags.writeable


def test_parts_share_samples_where_they_overlap(recording):
    before, after = recording.split(0.5)
    assert recording.shares(before)
    assert recording.crop(0.3, 0.7).shares(after)
    assert not before.shares(after)


def test_runs_of_one_file_with_the_same_times_share_nothing(model, write, signals):
    runs = {
        name: {k: (v * scale).tolist() if k != "t" else v.tolist() for k, v in signals.items()}
        for name, scale in (("one", 1), ("two", 2))
    }
    path = write("run.json", json.dumps(runs))
    one, two = (read_recording(f"{path}#{name}", model) for name in runs)
    assert one.sha256 == two.sha256
    assert not one.shares(two)
    assert one.shares(read_recording(f"{path}#one", model))


@pytest.mark.parametrize("at", [-1.0, 0.0, 1.0, 60.0, float("nan")])
def test_split_outside_is_refused(recording, at):
    with pytest.raises(InputError, match=r"cannot split at .* the recording is 0 … 0\.99 s"):
        recording.split(at)


@pytest.mark.parametrize("at", [0.05, 0.95])
def test_split_needs_20_samples_on_both_sides(recording, at):
    with pytest.raises(InputError, match=r"samples are left; at least 20"):
        recording.split(at)


def test_crop_includes_its_ends(recording):
    part = recording.crop(0.2, 0.6)
    assert (part.t[0], part.t[-1], part.t.size) == (0.2, 0.6, 41)
    np.testing.assert_array_equal(part.inputs["f"], recording.inputs["f"][20:61])
    assert part.notes == ("part of run.csv, 0.2 … 0.6 s",)


def test_crop_without_limits_reaches_the_ends(recording):
    assert recording.crop(None, 0.5).t[0] == 0.0
    assert recording.crop(0.5).t[-1] == 0.99
    assert recording.crop().t.size == 100
    assert recording.crop(0.5, 1.0).t[-1] == 0.99  # one step behind the last sample is meant


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        (-1.0, None, "cannot crop at -1 s"),
        (None, 5.0, "cannot crop at 5 s"),
        (0.8, 0.2, "the start must come first"),
        (0.2, 0.3, "11 samples are left"),
        (float("nan"), None, "cannot crop at nan s"),
    ],
)
def test_crop_outside_or_too_short_is_refused(recording, start, end, message):
    with pytest.raises(InputError, match=message):
        recording.crop(start, end)


def test_a_part_without_any_sample_of_a_sensor_leaves_the_sensor_out(model, write, table, signals):
    signals["accel"][50:] = np.nan
    after = read_recording(write("run.csv", table(signals)), model).split(0.5)[1]
    assert set(after.sensors) == {"laser"}
    assert "sensor accel has no finite sample: left out" in after.notes


def test_span_drops_the_rest_before_it_is_judged(model, write, table, signals):
    signals["f"][60:] = np.nan
    path = write("run.csv", table(signals))
    with pytest.raises(InputError, match=r"input f: stops at t = 0\.59 s"):
        read_recording(path, model)
    part = read_recording(path, model, span=(None, 0.59))
    assert part.t[-1] == 0.59
    assert part.notes[0] == "only t = -inf … 0.59 s was read"


def test_sensors_without_a_column_and_unused_columns_are_noted(model, write, table, signals):
    signals["gyro"], signals["spare"] = signals.pop("accel"), signals["t"]
    recording = read_recording(write("run.csv", table(signals)), model)
    assert set(recording.sensors) == {"laser"}
    assert recording.notes == (
        "sensor accel has no column: left out",
        "columns gyro, spare are not used",
    )


# ------------------------------------------------------------------------ real recordings


def test_the_positioning_drive(public_file, model):
    columns = {"laser": "qm [m]", "f": "gtau*vir"}
    recording = read_recording(public_file("emps", "DATA_EMPS.mat"), model, columns)
    assert recording.t.size == 24841
    assert recording.duration == pytest.approx(24.84)
    assert recording.sensors["laser"].max() == pytest.approx(0.24637775)
    assert np.abs(recording.inputs["f"]).max() == pytest.approx(152.04983561)
    assert "columns kp, kv, qg are not used" in recording.notes


def test_the_silverbox_has_no_time_and_an_empty_last_column(public_file, model):
    columns = {"laser": "V2 [mm]", "f": "V1", "t": "index/610.3515625"}
    recording = read_recording(public_file("silverbox"), model, columns)
    assert recording.t.size == 131072
    assert recording.t[-1] == pytest.approx(131071 * 2**14 / 1e7)
    assert recording.inputs["f"][0] == 0.0057756
    assert recording.notes == ("sensor accel has no column: left out",)


def test_the_rolling_ship_is_sampled_unevenly_and_coarsely(public_file, model):
    path = public_file("kvlcc2_rolldecay", "model_test_21337.csv")
    columns = {"laser": "phi [mm]", "f": "0*phi", "t": "time"}
    recording = read_recording(path, model, columns, span=(25.5, 91.0))
    assert recording.t[0] >= 25.5
    assert recording.t[-1] <= 91.0
    said = " ".join(recording.notes)
    assert "quantised in steps of 8.727e-05 mm" in said  # 0.005 degrees
    assert re.search(r"uneven: steps of 0\.00999\d* to 0\.0100\d* s, median 0\.01 s", said)
    assert "input f is constant at 0 N" in said
