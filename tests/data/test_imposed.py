"""The motion of an imposed coordinate comes with the recording, like an input."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.data.recording import read_recording
from symhyb.errors import InputError
from symhyb.model.expression import parse_expression
from symhyb.model.types import Coordinate, Sensor
from symhyb.units import parse_unit


@pytest.fixture
def rig(model):
    """The coordinate x in mm is imposed; laser measures it, accel its acceleration."""
    return replace(model, coordinates=(Coordinate("x", parse_unit("mm"), imposed=True),))


def test_a_column_with_the_name_of_the_coordinate(rig, write, table, signals):
    signals["x"] = 3 * signals["laser"]
    recording = read_recording(write("run.csv", table(signals)), rig)
    assert set(recording.inputs) == {"f", "x"}
    np.testing.assert_allclose(recording.inputs["x"], signals["x"] / 1e3)
    assert recording.notes == ()


def test_a_map_names_the_motion_with_its_unit(rig, write, table, signals):
    path = write("run.csv", table(signals))
    recording = read_recording(path, rig, {"x": "2*laser [in]"})
    np.testing.assert_allclose(recording.inputs["x"], 2 * 0.0254 * signals["laser"])
    assert not any("imposed" in note for note in recording.notes)


def test_else_the_sensor_that_measures_it_and_nothing_else(rig, write, table, signals):
    recording = read_recording(write("run.csv", table(signals)), rig)
    np.testing.assert_array_equal(recording.inputs["x"], recording.sensors["laser"])
    assert recording.notes == ("coordinate x is imposed: it moves as sensor laser records",)


@pytest.mark.parametrize("measures", ["2*x", "x'"])
def test_a_sensor_of_something_else_does_not_count(rig, write, table, signals, measures):
    laser = replace(rig.sensors[0], measures=parse_expression(measures))
    rig = replace(rig, sensors=(laser, rig.sensors[1]))
    with pytest.raises(InputError, match=r"coordinate x: has no column.*x=…, or map a sensor") as e:
        read_recording(write("run.csv", table(signals)), rig)
    assert len(e.value.problems) == 1


def test_the_sensor_needs_a_column_itself(rig, write, table, signals):
    second = Sensor("encoder", parse_expression("x"), parse_unit("mm"))
    rig = replace(rig, sensors=(*rig.sensors, second))
    del signals["laser"]
    with pytest.raises(InputError, match=r"coordinate x: has no column"):
        read_recording(write("run.csv", table(signals)), rig)
    signals["encoder"] = signals["f"]
    recording = read_recording(write("run.csv", table(signals)), rig)
    assert "coordinate x is imposed: it moves as sensor encoder records" in recording.notes


def test_motion_needs_samples_from_end_to_end(rig, write, table, signals):
    signals["laser"][40:50] = np.nan
    with pytest.raises(InputError, match=r"input x: is missing for 10 samples"):
        read_recording(write("run.csv", table(signals)), rig)


def test_a_free_coordinate_needs_no_column(model, write, table, signals):
    recording = read_recording(write("run.csv", table(signals)), model)
    assert set(recording.inputs) == {"f"}
