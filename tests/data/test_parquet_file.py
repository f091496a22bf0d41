"""Parquet: numbers are columns, units may stand in the metadata of a field."""

import io

import numpy as np
import pandas as pd
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.recording import read_recording
from symhyb.errors import InputError

arrow = pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
parquet = pytest.importorskip("pyarrow.parquet")


def content_of(table):
    buffer = io.BytesIO()
    parquet.write_table(table, buffer)
    return buffer.getvalue()


def test_numbers_flags_and_units_of_fields(model, write, signals):
    fields = [
        arrow.field(
            name,
            arrow.float32() if name == "laser" else arrow.float64(),
            metadata={"unit": "um"} if name == "laser" else None,
        )
        for name in signals
    ]
    columns = [arrow.array(v * (1e3 if n == "laser" else 1)) for n, v in signals.items()]
    columns = [c.cast(f.type) for c, f in zip(columns, fields, strict=True)]
    path = write("run.parquet", content_of(arrow.table(columns, schema=arrow.schema(fields))))
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3, rtol=1e-6)
    np.testing.assert_array_equal(recording.inputs["f"], signals["f"])
    assert recording.notes == ()


def test_what_pandas_writes(model, write, signals):
    frame = pd.DataFrame(signals).astype({"accel": "Float64"})
    frame.loc[3, "accel"] = None
    frame["when"] = pd.Timestamp("2024-05-01") + pd.to_timedelta(10 * signals["t"], unit="s")
    frame["name"] = "run"
    frame.index = frame.index * 7
    buffer = io.BytesIO()
    frame.to_parquet(buffer)
    recording = read_recording(write("run.parquet", buffer.getvalue()), model, {"t": "when"})
    np.testing.assert_allclose(recording.t, 10 * signals["t"], atol=1e-6)
    assert np.flatnonzero(np.isnan(recording.sensors["accel"])).tolist() == [3]
    assert recording.notes[0].startswith("column when holds dates: counted in s from the first")
    assert any(note.startswith("column name is") for note in recording.notes)


@pytest.mark.slow
def test_what_cannot_be_used(write, signals):
    whole = content_of(arrow.table({n: arrow.array(v) for n, v in signals.items()}))
    for content, message in (
        (b"t,f\n0,1\n", r"is not a Parquet file, although its name ends in \.parquet"),
        (whole[:-4] + b"PARE", r"is encrypted; save it without a key"),
        (whole[: len(whole) // 2], r"is cut off: the end of a Parquet file is missing"),
        (b"PAR1" + whole[len(whole) // 2 :], r"is a damaged Parquet file: "),
        (b"PAR1PAR1", r"is a damaged Parquet file: "),
        (content_of(arrow.table({"t": arrow.array([], arrow.float64())})), r"no row"),
    ):
        with pytest.raises(InputError, match=message) as caught:
            read_table(write("run.parquet", content))
        assert "\n" not in str(caught.value)
