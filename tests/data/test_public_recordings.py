"""Every public recording can be read, with a map and, where it has parts, by its part."""

import numpy as np
import pytest

from symhyb.data.recording import read_recording
from symhyb.errors import InputError
from symhyb.model.expression import parse_expression
from symhyb.model.types import Coordinate, Model, Sensor
from symhyb.units import parse_unit


def one(sensor, unit, imposed=""):
    """A model of one coordinate that ``sensor`` measures; ``imposed`` names a moved one."""
    moved = [Coordinate(imposed, parse_unit("m"), imposed=True)] if imposed else []
    return Model(
        "one",
        (Coordinate("q", parse_unit(unit)), *moved),
        sensors=(Sensor(sensor, parse_expression("q"), parse_unit(unit)),),
    )


def test_emps(public_file):
    path = public_file("emps", "DATA_EMPS.mat")
    recording = read_recording(path, one("qm", "m"))
    assert (recording.t.size, recording.duration) == (24841, pytest.approx(24.84))


def test_silverbox(public_file):
    recording = read_recording(
        public_file("silverbox"), one("y", "V"), {"t": "index/610.3515625", "y": "V2"}
    )
    assert recording.duration == pytest.approx(131072 / 610.3515625, rel=0.1)


def test_the_tanker(public_file):
    path = public_file("kvlcc2_rolldecay", "model_test_21338.csv")
    recording = read_recording(path, one("phi", "rad"), {"t": "time"}, span=(9.3, 89.0))
    assert 0.05 < np.ptp(recording.sensors["phi"]) < 1.0


@pytest.mark.parametrize("cell", [1, 4])
def test_the_pendulum_by_its_cells(public_file, cell):
    path = public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    model = one("angle", "rad")
    named = read_recording(
        path, model, {"t": f"Time_id.{cell}", "angle": f"Y_id.{cell}.1 - 3.14159265359"}
    )
    chosen = read_recording(
        f"{path}#{cell}", model, {"t": "Time_id", "angle": "Y_id.1 - 3.14159265359"}
    )
    np.testing.assert_array_equal(named.sensors["angle"], chosen.sensors["angle"])
    np.testing.assert_array_equal(named.t, chosen.t)
    assert named.t.size == 9167
    assert np.median(np.diff(named.t)) == pytest.approx(1e-3)


def test_cells_that_follow_on_one_another_are_one_swing(public_file):
    path = public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    columns = {"t": "Time_id", "angle": "Y_id.1 - pi"}
    whole = read_recording(f"{path}#1-4", one("angle", "rad"), columns)
    third = read_recording(f"{path}#3", one("angle", "rad"), columns)
    assert whole.t.size == 4 * 9167
    np.testing.assert_array_equal(
        whole.sensors["angle"][2 * 9167 : 3 * 9167], third.sensors["angle"]
    )
    assert np.abs(np.diff(whole.sensors["angle"])).max() < 0.02  # no jump from cell to cell


def test_a_cell_that_is_not_there(public_file):
    path = public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    with pytest.raises(InputError, match=r"in 4 parts .*, and none of them is '6'; .*mat#4'"):
        read_recording(f"{path}#6", one("angle", "rad"), {"t": "Time_id", "angle": "Y_id.1"})


def test_the_double_pendulum_steps_by_dt(public_file):
    path = public_file("pendulum", "DoublePendulumDataForParameterEstimation.mat")
    recording = read_recording(f"{path}#26", one("angle", "rad"), {"angle": "Y_id.2"})
    assert recording.t.size == 2667
    assert recording.t[-1] == pytest.approx(2.666)


def test_a_ball_by_its_sheet_and_drop(public_file):
    path = public_file("balldrops", "Ball_drops_data.xls#Golf Ball#2")
    mapping = {"t": "Time (s)", "height": "Height (m)"}
    recording = read_recording(path, one("height", "m"), mapping)
    fall = np.polyfit(recording.t, recording.sensors["height"], 2)
    assert -5.5 < fall[0] < -3.5  # half of g, less drag
    assert recording.t[0] == 0.0
    assert recording.t.size == 44


@pytest.mark.slow
def test_the_balls_have_to_be_reported_apart(public_file):
    path = public_file("balldrops", "Ball_drops_data.xls")
    mapping = {"t": "Time (s)", "height": "Height (m)"}
    with pytest.raises(InputError, match=r"in 11 parts of the file \(Baseball, Blue Basketball"):
        read_recording(path, one("height", "m"), mapping)
    numbered = r"'#6' counts runs and not parts: name the part first, as in .*#Baseball'"
    with pytest.raises(InputError, match=numbered):
        read_recording(f"{path}#6", one("height", "m"), mapping)


@pytest.mark.parametrize(
    "file", ["0.5Hz30lbtension1amplitude.json", "1Hz30lbtension1.5amplitude.json"]
)
def test_the_damper_with_its_imposed_motion(public_file, file):
    mapping = {"x": "data.2 [in]", "force": "data.3 [kip]"}
    recording = read_recording(public_file("brfd", file), one("force", "N", "x"), mapping)
    assert np.median(np.diff(recording.t)) == pytest.approx(1 / 1024)
    assert 0.03 < np.ptp(recording.inputs["x"]) < 0.12  # amplitudes of 1 and 1.5 in
    assert any("quantised" in note for note in recording.notes)
