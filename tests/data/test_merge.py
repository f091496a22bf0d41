"""Several rates in one recording: sensors stay missing in between, inputs run in straight lines."""

import io

import numpy as np
import pytest
from scipy.io import savemat

from symhyb.data.channels import own_step
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


def mat(**variables):
    buffer = io.BytesIO()
    savemat(buffer, variables, oned_as="column")
    return buffer.getvalue()


def fast_and_slow(period=10, offset=0.0, count=100):
    """t and laser at 1000 Hz, t_acc and acc every ``period`` ms, f beside the laser."""
    t = np.arange(count) / 1000
    slow = np.arange(0, count, period) / 1000 + offset
    return {
        "t": t,
        "laser": np.sin(40 * t),
        "f": np.cos(40 * t),
        "t_acc": slow,
        "acc": np.cos(30 * slow),
    }


def test_times_of_its_own_are_named_behind_the_at_sign(model, write):
    data = fast_and_slow(period=4)
    recording = read_recording(write("run.mat", mat(**data)), model, {"accel": "2*acc @ t_acc"})
    np.testing.assert_array_equal(recording.t, data["t"])
    expected = np.full(100, np.nan)
    expected[::4] = 2 * data["acc"]
    np.testing.assert_array_equal(recording.sensors["accel"], expected)
    assert not np.isnan(recording.sensors["laser"]).any()
    assert "sensor accel: 250 Hz beside rows at 1000 Hz; missing in between" in recording.notes
    assert "channels with times of their own are merged: f+laser, accel" in recording.notes


def test_units_and_expressions_of_times(model, write):
    data = fast_and_slow(period=4)
    data["t_acc"] = data["t_acc"] * 1e3 + 7
    mapping = {"accel": "acc [mm/s^2] @ (t_acc - 7) [ms]"}
    recording = read_recording(write("run.mat", mat(**data)), model, mapping)
    assert recording.t.size == 100
    np.testing.assert_allclose(recording.sensors["accel"][::4], data["acc"] / 1e3)


def test_times_that_differ_by_rounding_are_one(model, write):
    data = fast_and_slow(period=4)
    data["t_acc"] = data["t_acc"] * (1 + 1e-12) + 1e-10
    recording = read_recording(write("run.mat", mat(**data)), model, {"accel": "acc @ t_acc"})
    assert recording.t.size == 100


def test_times_between_those_of_others_are_rows_of_their_own(model, write):
    data = fast_and_slow(period=4, offset=3e-4)
    recording = read_recording(write("run.mat", mat(**data)), model, {"accel": "acc @ t_acc"})
    assert recording.t.size == 125
    known = np.isfinite(recording.sensors["accel"])
    np.testing.assert_allclose(recording.t[known], data["t_acc"])
    np.testing.assert_allclose(recording.sensors["laser"][~known], data["laser"] / 1e3)
    f = np.interp(recording.t, data["t"], data["f"])
    np.testing.assert_allclose(recording.inputs["f"], f)


def test_a_slow_input_runs_in_straight_lines_between_its_samples(model, write):
    data = fast_and_slow(period=10)
    path = write("run.mat", mat(**data, accel=data["laser"]))
    recording = read_recording(path, model, {"f": "acc @ t_acc"})
    assert recording.t[-1] == pytest.approx(0.09)  # nothing is known of it afterwards
    f = np.interp(recording.t, data["t_acc"], data["acc"])
    np.testing.assert_allclose(recording.inputs["f"], f, rtol=1e-12)
    assert "input f: 100 Hz beside rows at 1000 Hz; straight lines in between" in recording.notes


def test_a_slow_input_with_a_long_hole_is_refused(model, write):
    data = fast_and_slow(period=10, count=400)
    keep = np.abs(data["t_acc"] - 0.2) > 0.035
    data["t_acc"], data["acc"] = data["t_acc"][keep], data["acc"][keep]
    with pytest.raises(
        InputError, match=r"input f: is missing for 79 samples, t = 0\.161 … 0\.239"
    ):
        read_recording(write("run.mat", mat(**data)), model, {"f": "acc @ t_acc"})


def test_a_slow_sensor_tells_its_own_gaps(model, write):
    data = fast_and_slow(period=10, count=400)
    keep = np.abs(data["t_acc"] - 0.2) > 0.035
    data["t_acc"], data["acc"] = data["t_acc"][keep], data["acc"][keep]
    notes = read_recording(write("run.mat", mat(**data)), model, {"accel": "acc @ t_acc"}).notes
    gap = "sensor accel: a gap in time: t = 0.16 … 0.24 s (step otherwise 0.01 s)"
    assert gap in notes


def test_columns_padded_with_empty_cells_are_the_same(model, write, table):
    data = fast_and_slow(period=4)
    padded = dict.fromkeys(("t_acc", "acc"), np.full(100, np.nan))
    padded = {name: np.pad(data[name], (0, 75), constant_values=np.nan) for name in padded}
    path = write("run.csv", table(data | padded))
    recording = read_recording(path, model, {"accel": "acc @ t_acc"})
    np.testing.assert_allclose(recording.sensors["accel"][::4], data["acc"], rtol=1e-14)
    assert recording.t.size == 100


def test_rows_with_empty_cells_between_slow_samples(model, write, table):
    data = fast_and_slow(period=5)
    f = np.where(np.arange(100) % 5 == 0, 3 * data["t"], np.nan)
    path = write("run.csv", table({"t": data["t"], "laser": data["laser"], "f": f}))
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.inputs["f"], 3 * recording.t, rtol=1e-12)
    assert recording.t.size == 96


def test_structures_bring_their_own_times(model, write):
    data = fast_and_slow(period=4)
    fast = {"t": data["t"], "laser": data["laser"], "f": data["f"]}
    slow = {"t": data["t_acc"], "accel": data["acc"]}
    path = write("run.mat", mat(daq=fast, imu=slow))
    recording = read_recording(path, model)
    np.testing.assert_array_equal(recording.sensors["accel"][::4], data["acc"])
    mapped = read_recording(path, model, {"accel": "-imu.accel", "laser": "daq.laser"})
    np.testing.assert_array_equal(mapped.sensors["accel"], -recording.sensors["accel"])


@pytest.mark.parametrize(
    ("mapping", "message"),
    [
        ({"accel": "acc"}, r"differ in their number of rows: .* as in accel=acc @ t_acc"),
        ({"accel": "acc @ t_ac"}, r"there is no column 't_ac'; did you mean 't_acc'"),
        ({"accel": "acc @ step"}, r"time t: 'step' is a single number, not a column"),
        ({"accel": "acc @ acc"}, r"time does not increase"),
        ({"accel": "ac @ t_acc"}, r"there is no column 'ac'"),
    ],
)
def test_mistakes_in_times(model, write, mapping, message):
    path = write("run.mat", mat(**fast_and_slow(period=4), step=0.1))
    with pytest.raises(InputError, match=message):
        read_recording(path, model, mapping)


def test_a_rate_is_seen_by_even_distances():
    t = np.arange(1000) / 1000
    values = np.full(1000, np.nan)
    values[::7] = 1.0
    assert own_step(values, t) == pytest.approx(0.007)
    assert own_step(np.ones(1000), t) is None
    holes = np.ones(1000)
    holes[np.random.default_rng(1).random(1000) < 0.4] = np.nan
    assert own_step(holes, t) is None
    half = np.ones(1000)
    half[400:] = np.nan
    assert own_step(half, t) is None
