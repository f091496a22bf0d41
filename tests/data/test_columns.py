"""Names, maps, expressions and units of columns; every mistake in them."""

import re
from dataclasses import replace

import numpy as np
import pytest

from symhyb.data.recording import read_recording
from symhyb.errors import InputError
from symhyb.units import parse_unit


@pytest.fixture
def read(model, write, table):
    """Read a table with the small model."""

    def read_table(columns, mapping=None):
        return read_recording(write("run.csv", table(columns)), model, mapping)

    return read_table


@pytest.fixture
def problems(read):
    """The problems of a table, as sentences."""

    def problems_of(columns, mapping=None):
        with pytest.raises(InputError) as caught:
            read(columns, mapping)
        assert all(problem.file.endswith("run.csv") for problem in caught.value.problems)
        return [f"{problem.place}: {problem.text}" for problem in caught.value.problems]

    return problems_of


def renamed(signals, **names):
    return {names.get(name, name): values for name, values in signals.items()}


def test_the_map_names_columns(read, signals):
    recording = read(renamed(signals, laser="qm", t="time"), {"laser": "qm", "t": "time"})
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    np.testing.assert_array_equal(recording.t, signals["t"])


def test_the_map_goes_before_an_equal_name(read, signals):
    signals["other"] = signals["f"] * 7
    recording = read(signals, {"f": "other"})
    np.testing.assert_allclose(recording.inputs["f"], signals["other"], rtol=1e-14)
    assert recording.notes == ("column f is not used",)


def test_expressions_in_columns_and_index(read, signals):
    columns = {"i": signals["f"] / 4, "laser": signals["laser"]}
    recording = read(columns, {"f": "2*(i + i)", "t": "index/100", "accel": "-laser"})
    np.testing.assert_allclose(recording.inputs["f"], signals["f"])
    np.testing.assert_allclose(recording.t, signals["t"])
    np.testing.assert_allclose(recording.sensors["accel"], -signals["laser"])


def test_a_column_called_index_goes_before_the_built_in(read, signals):
    recording = read(signals | {"index": signals["t"] * 1000 + 7}, {"t": "index/1000"})
    assert recording.t[0] == 0.007


@pytest.mark.parametrize("name", ["roll angle", "Kraft-1", "x'", "2nd", "a/b", "ß [m/s^2]"])
def test_names_that_are_no_identifiers_are_matched_literally(read, signals, name):
    recording = read(renamed(signals, accel=name), {"accel": name})
    np.testing.assert_allclose(recording.sensors["accel"], signals["accel"])


def test_units_of_the_header_are_honoured(read, signals):
    columns = renamed(signals, t="t [ms]", laser="laser [um]", f="f [kN]")
    columns["t [ms]"] = signals["t"] * 1000
    recording = read(columns)
    np.testing.assert_allclose(recording.t, signals["t"])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] * 1e-6)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"] * 1e3)


def test_units_of_the_map_are_honoured(read, signals):
    columns = renamed(signals, laser="roll angle")
    mapping = {"laser": "roll angle [m]", "f": "2*f [kN]", "accel": "accel [mm/s^2]"}
    recording = read(columns, mapping)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"])
    np.testing.assert_allclose(recording.inputs["f"], signals["f"] * 2e3)
    np.testing.assert_allclose(recording.sensors["accel"], signals["accel"] * 1e-3)


def test_a_map_without_a_unit_leaves_that_of_the_header(read, signals):
    recording = read(renamed(signals, laser="qm [m]"), {"laser": "qm"})
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"])


def test_a_literal_header_with_its_unit_may_be_named_in_full(read, signals):
    recording = read(renamed(signals, laser="qm [m]"), {"laser": "qm [m]"})
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"])


def test_units_of_headers_are_multiplied_out_in_expressions(read, signals):
    columns = renamed(signals, f="i [mA]") | {"k [N/A]": np.full(100, 3.0)}
    recording = read(columns, {"f": "k*i"})
    np.testing.assert_allclose(recording.inputs["f"], signals["f"] * 3e-3)


def test_a_stated_unit_takes_the_columns_of_an_expression_as_plain_numbers(read, signals):
    columns = renamed(signals, f="i [mA]") | {"k": np.full(100, 3.0)}
    recording = read(columns, {"f": "k*i [N]"})
    np.testing.assert_allclose(recording.inputs["f"], signals["f"] * 3)


def test_sensors_and_inputs_of_one_name_share_a_column(model, write, table, signals):
    partner = replace(model.sensors[0], name="f", unit=parse_unit("kN"))
    path = write("run.csv", table(signals))
    recording = read_recording(path, replace(model, sensors=(*model.sensors, partner)))
    np.testing.assert_allclose(recording.sensors["f"], recording.inputs["f"] * 1000)


# ------------------------------------------------------------------------------ mistakes


def test_a_key_that_is_no_channel(problems, signals):
    (problem,) = problems(signals, {"lasr": "f"})
    assert problem == "lasr=f: the model has no input or sensor 'lasr'; did you mean 'laser'?"


def test_a_column_that_does_not_exist(problems, signals):
    (problem,) = problems(signals, {"laser": "acel"})
    assert problem == "sensor laser: there is no column 'acel'; did you mean 'accel'?"


def test_a_name_with_a_blank_that_does_not_exist(problems, signals):
    (problem,) = problems(renamed(signals, accel="roll angle"), {"laser": "rol angle"})
    assert "'rol angle' is no column; did you mean 'roll angle'?" in problem


def test_everything_that_is_wrong_is_said_at_once(problems, signals):
    columns = renamed(signals, t="clock", f="force")
    found = problems(columns, {"acel": "accel", "laser": "lasr", "accel": "accel [N]"})
    assert len(found) == 5
    text = "\n".join(found)
    assert "acel=accel: the model has no input or sensor 'acel'; did you mean 'accel'?" in text
    assert "time t: has no column; known: clock, force, laser, accel; say in the map" in text
    assert "input f: has no column; known: " in text
    assert "sensor laser: there is no column 'lasr'; did you mean 'laser'?" in text
    assert "sensor accel: the column is in N, but the model declares m/s^2" in text


def test_an_input_is_needed(problems, signals):
    del signals["f"]
    (problem,) = problems(signals)
    assert problem.startswith("input f: has no column; known: t, laser, accel; say in the map")


def test_one_sensor_is_needed(problems, signals):
    found = problems({"t": signals["t"], "f": signals["f"], "g": signals["f"]})
    assert found == [
        ": no sensor of the model (laser, accel) has a column (columns: t, f, g);"
        " map one, as in laser=…"
    ]


def test_time_is_needed_and_the_cure_is_said(problems, signals):
    del signals["t"]
    (problem,) = problems(signals)
    assert problem.startswith("time t: has no column")
    assert problem.endswith("as in t=index/1000 at 1000 Hz")


@pytest.mark.parametrize(
    ("mapping", "message"),
    [
        ({"laser": "laser [mmm]"}, r"\[mmm\]: 'mmm' is not a known unit"),
        ({"laser": "laser [s]"}, "the column is in s, but the model declares mm"),
        ({"laser": "2*laser [s]"}, "the column is in s, but the model declares mm"),
        ({"laser": ""}, "'' is no column"),
        ({"laser": "f.real"}, "'f.real' is no column"),
        ({"laser": "__import__('os')"}, "is no column"),
        ({"laser": "curve(c, f)"}, "asks for a curve, which stands in a model file alone"),
        ({"laser": "laser'"}, "there is no column 'laser''"),
        ({"laser": "3"}, "'3' is a single number, not a column"),
    ],
)
def test_mistakes_in_a_map(problems, signals, mapping, message):
    (problem,) = problems(signals, mapping)
    assert re.search(message, problem)


def test_a_map_that_contradicts_the_header(problems, signals):
    (problem,) = problems(renamed(signals, laser="laser [um]"), {"laser": "laser [m]"})
    assert problem == "sensor laser: the map says m, but the header is 'laser [um]'"


def test_a_header_in_another_dimension(problems, signals):
    (problem,) = problems(renamed(signals, laser="laser [s]"))
    assert problem == "sensor laser: the column is in s, but the model declares mm"


def test_an_expression_whose_units_do_not_fit(problems, signals):
    (problem,) = problems(renamed(signals, f="i [mA]"), {"f": "2*i"})
    assert problem.startswith("input f: '2*i' is in mA, but the model declares N; state the unit")


def test_an_expression_of_columns_with_and_without_units(problems, signals):
    columns = renamed(signals, f="i [mA]") | {"k": signals["f"]}
    (problem,) = problems(columns, {"f": "k*i"})
    assert "mixes columns with a unit and without one (k); state the unit" in problem
    assert problem.endswith("as in 'k*i [N]'")


def test_an_expression_that_adds_different_units(problems, signals):
    columns = renamed(signals, f="i [mA]") | {"k [V]": signals["f"]}
    (problem,) = problems(columns, {"f": "k + i"})
    assert "adds 'k' in V and 'i' in mA" in problem
