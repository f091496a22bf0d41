"""JSON tables in the shapes that programs write."""

import json

import numpy as np
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


@pytest.fixture
def lists(signals):
    return {name: values.tolist() for name, values in signals.items()}


def written(write, value):
    return write("run.json", json.dumps(value))


def shapes(lists):
    rows = [list(row) for row in zip(*lists.values(), strict=True)]
    return {
        "columns": lists,
        "records": [dict(zip(lists, row, strict=True)) for row in rows],
        "named rows": {"columns": list(lists), "index": [0, 1], "data": rows},
    }


@pytest.mark.parametrize("shape", ["columns", "records", "named rows"])
def test_every_shape_with_names_gives_the_same_recording(model, write, lists, signals, shape):
    recording = read_recording(written(write, shapes(lists)[shape]), model)
    np.testing.assert_array_equal(recording.t, signals["t"])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    np.testing.assert_array_equal(recording.inputs["f"], signals["f"])


@pytest.mark.parametrize("bare", [True, False])
@pytest.mark.parametrize("by", ["rows", "columns"])
def test_vectors_without_names_are_numbered(model, write, lists, signals, by, bare):
    table = [*lists.values()]
    table = table if by == "columns" else [list(row) for row in zip(*table, strict=True)]
    path = written(write, table if bare else {"data": table, "unit of f": "N"})
    mapping = {"t": "data.1", "f": "2*data.2", "laser": "data.3", "accel": "data.4 [mm/s^2]"}
    recording = read_recording(path, model, mapping)
    np.testing.assert_allclose(recording.inputs["f"], 2 * signals["f"])
    np.testing.assert_allclose(recording.sensors["accel"], signals["accel"] / 1e3)
    assert recording.notes == ()


def test_a_sample_step_gives_the_times(model, write, lists):
    del lists["t"]
    recording = read_recording(written(write, lists | {"dt [ms]": 5.0}), model)
    np.testing.assert_allclose(recording.t, np.arange(100) * 0.005)
    assert recording.notes == ("t is index*dt (dt [ms] = 5), there is no column t",)


def test_null_is_a_missing_sample_and_flags_are_numbers(model, write, lists):
    lists["laser"][3:5] = [None, None]
    lists["f"] = [k > 50 for k in range(100)]
    recording = read_recording(written(write, lists), model)
    assert np.flatnonzero(np.isnan(recording.sensors["laser"])).tolist() == [3, 4]
    assert set(recording.inputs["f"]) == {0.0, 1.0}


def test_a_record_may_lack_a_key(model, write, lists):
    records = shapes(lists)["records"]
    del records[7]["accel"]
    recording = read_recording(written(write, records), model)
    assert np.flatnonzero(np.isnan(recording.sensors["accel"])).tolist() == [7]


def test_mappings_within_are_parts(model, write, lists, signals):
    other = {name: [2 * x for x in values] for name, values in lists.items()}
    path = written(write, {"one": lists, "two": other, "gain": 3})
    recording = read_recording(f"{path}#two", model, {"f": "gain*f"})
    np.testing.assert_allclose(recording.inputs["f"], 6 * signals["f"])
    with pytest.raises(InputError, match=r"'laser' is in 2 parts of the file \(one, two\)"):
        read_recording(path, model)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('{"t": [0, 1', r"run\.json:1: is no JSON, or cut off: .* in column 12"),
        ("t,f\n0,1\n", r"is no JSON, or cut off"),
        (b"\xff\xfe\x00\xd8\x00", r"is not a text file, although its name ends in \.json"),
        ("[" * 100000, r"is nested too deeply"),
        ('{"t": [0], "t": [1]}', r"the key 't' stands more than once"),
        ("[]", r"holds no column of numbers; variable data is empty: left out"),
        ('{"title": "run"}', r"holds no column of numbers"),
        ('{"t": ["a", "b"]}', r"holds no column of numbers; variable t is text: left out"),
        ('{"t": [[1, 2], [3, "x"]]}', r"variable t\.2 is text"),
    ],
)
def test_what_cannot_be_used(write, model, content, message):
    with pytest.raises(InputError, match=message):
        read_recording(write("run.json", content), model)


def test_numbers_beyond_the_range_are_no_measurement(write):
    table = read_table(write("run.json", '{"a": [1, 1%s, NaN]}' % ("0" * 400)))
    np.testing.assert_array_equal(table.columns[0].values, [1, np.inf, np.nan])
