"""Delimited text as loggers leave it: preambles, a row of units, dates, dashes, units in (…)."""

import numpy as np
import pytest

from symhyb.data.files.csv_file import read_csv
from symhyb.data.files.formats import read_table
from symhyb.data.files.table import split_unit
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


def below(text: str, line: str) -> str:
    """The text with one line more below its first."""
    first, rest = text.split("\n", 1)
    return f"{first}\n{line}\n{rest}"


def test_lines_above_the_names_are_skipped_and_noted(model, write, table, signals):
    text = "Test rig,4-post\nOperator,Meier\n\n" + table(signals)
    recording = read_recording(write("run.csv", text), model)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] * 1e-3, rtol=1e-14)
    assert recording.notes == ("2 lines above the names of the columns are not read",)


def test_a_problem_below_a_preamble_stands_at_its_own_line(model, write, table, signals):
    lines = table(signals).splitlines()
    lines[50] = lines[50].replace(lines[50].split(",")[2], "broken")
    path = write("run.csv", "\n".join(["Rig;4-post", "", *lines]))
    with pytest.raises(InputError, match=r"run\.csv:53: column 'laser': 'broken' is not a number"):
        read_recording(path, model)


@pytest.mark.parametrize("delimiter", [",", ";"])
def test_a_line_of_units_below_the_names_is_used(model, write, table, signals, delimiter):
    text = below(table(signals, delimiter), delimiter.join(["s", "kN", "m", "m/s²"]))
    if delimiter == ";":
        text = text.replace(".", ",")
    recording = read_recording(write("run.csv", text), model)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"] * 1e3, rtol=1e-14)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"], rtol=1e-14)
    assert "the units of the columns stand in the line below their names" in recording.notes


def test_a_line_of_units_may_hold_dashes_and_what_is_no_unit(write):
    text = "Zeit;Weg;Beschl. Rad;Temperatur;Status\ns;mm;m/s²;°C;-\n0,0;1,5;2,5;23,4;OK\n"
    columns = read_table(write("run.csv", text + "0,1;1,5;2,5;23,4;OK\n")).columns
    assert [c.unit for c in columns] == ["s", "mm", "m/s²", "°C", "1"]
    assert columns[1].values.tolist() == [1.5, 1.5]


def test_words_below_the_names_are_no_units(write):
    (_, state) = read_table(write("run.csv", "t,state\n0,m\n1,s\n")).columns
    assert state.unit is None
    assert "'m' is not a number" in str(state.problem)


def test_units_in_parentheses_are_units_if_they_are_known():
    assert split_unit("h (mm)") == ("h", "mm")
    assert split_unit("ratio [-]") == ("ratio", "1")
    assert split_unit("force (filtered)") == ("force (filtered)", None)
    assert split_unit("f(x)") == ("f(x)", None)


def test_g_is_the_acceleration_of_gravity_for_an_accelerometer(model, write, table, signals):
    text = table(signals).replace("accel", "accel [g]", 1)
    recording = read_recording(write("run.csv", text), model)
    np.testing.assert_allclose(recording.sensors["accel"], 9.80665 * signals["accel"], rtol=1e-14)
    assert "[g] of an acceleration is 9.80665 m/s^2, and no gram: accel" in recording.notes
    mapped = read_recording(write("run.csv", table(signals)), model, {"accel": "accel [g]"})
    assert "[g] of an acceleration is 9.80665 m/s^2, and no gram: accel" in mapped.notes
    text = table(signals).replace("laser", "laser [g]", 1)
    with pytest.raises(InputError, match="the column is in g, but the model declares mm"):
        read_recording(write("run.csv", text), model)


@pytest.mark.parametrize("between", ["T", " "])
def test_dates_are_counted_in_seconds_from_the_first(model, write, table, signals, between):
    stamps = [
        f"2024-03-05{between}13:45:{12 + int(t):02d}.{round(t % 1 * 1e6):06d}" for t in signals["t"]
    ]
    lines = table(signals).splitlines()
    rows = [
        ",".join([stamp, *line.split(",")[1:]])
        for stamp, line in zip(stamps, lines[1:], strict=True)
    ]
    recording = read_recording(write("run.csv", "\n".join([lines[0], *rows])), model)
    np.testing.assert_allclose(recording.t, signals["t"], atol=1e-9)


@pytest.mark.parametrize("dashes", ["-", "--", " ---", "–"])
def test_dashes_are_a_missing_sample(write, dashes):
    (_, laser) = read_table(write("run.csv", f"t,laser\n0,1.5\n1,{dashes}\n2,2.5\n")).columns
    np.testing.assert_array_equal(laser.values, [1.5, np.nan, 2.5])
    assert laser.problem is None


@pytest.mark.parametrize(
    ("name", "factor"),
    [("Time", 1), ("Zeit [s]", 1), ("time_ms", 1e3), ("Time (us)", 1e6), ("timestamp_sec", 1)],
)
def test_a_column_of_a_usual_name_is_time(model, write, table, signals, name, factor):
    columns = {name if key == "t" else key: values for key, values in signals.items()}
    columns[name] = signals["t"] * factor
    recording = read_recording(write("run.csv", table(columns)), model)
    np.testing.assert_allclose(recording.t, signals["t"], rtol=1e-12)
    assert any(note.startswith(f"t is {name}") for note in recording.notes)


def test_two_columns_of_usual_names_are_asked_about(model, write, table, signals):
    columns = {"Time" if key == "t" else key: values for key, values in signals.items()}
    path = write("run.csv", table(columns | {"timestamp_ms": 1e3 * signals["t"]}))
    with pytest.raises(InputError, match=r"as in t=Time or t=timestamp_ms \[ms\]"):
        read_recording(path, model)
    recording = read_recording(path, model, {"t": "timestamp_ms [ms]"})
    np.testing.assert_allclose(recording.t, signals["t"], rtol=1e-12)


def test_more_decimal_commas_than_delimiters_below_a_preamble():
    rows = [f"0,{k};1,5;{k},25;0,5" for k in range(1, 40)]
    table = read_csv("\n".join(["logger 7", "t;a;b;c", *rows]).encode(), "run.csv")
    assert table.names() == ["t", "a", "b", "c"]
    assert table.columns[2].values[:2].tolist() == [1.25, 2.25]
