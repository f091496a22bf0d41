"""Recordings as loggers and spreadsheets write them, each read as a person would have it read.

They are not shipped: ``mess`` in the folder that ``SYMHYB_EXAMPLES`` names, or beside the
recordings.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from symhyb.data.files.formats import AND
from symhyb.data.recording import read_recording
from symhyb.model.read import read_model

BESIDE = Path(__file__).parents[2] / "shared" / "examples"
EXAMPLES = Path(os.environ.get("SYMHYB_EXAMPLES", BESIDE))
MESS = EXAMPLES / "mess"
GERMAN = {
    "h": "Weg Stempel",
    "acc_body": "Beschl. Aufbau",
    "acc_wheel": "Beschl. Rad",
    "travel": "Federweg",
}

pytestmark = pytest.mark.skipif(
    not MESS.is_dir(), reason="SYMHYB_EXAMPLES names no folder with messy recordings"
)


@pytest.mark.parametrize(
    ("file", "case", "columns", "end", "note"),
    [
        ("motor_epoch.csv", "motor_backlash", {}, None, ""),
        ("motor_epochms.csv", "motor_backlash", {}, None, "t is timestamp_ms [ms]"),
        ("motor_iso.csv", "motor_backlash", {}, None, ""),
        ("motor_pandas.csv", "motor_backlash", {}, None, "t is timestamp"),
        ("qcar_preamble.csv", "quarter_car", {}, None, "3 lines above the names"),
        ("qcar_units_header.csv", "quarter_car", {}, None, "no gram: acc_body, acc_wheel"),
        ("qcar_units_parens.csv", "quarter_car", {}, None, "no gram: acc_body, acc_wheel"),
        ("qcar_german_utf8.csv", "quarter_car", GERMAN, None, "with a decimal comma"),
        ("qcar_german_latin1.csv", "quarter_car", GERMAN, None, "with a decimal comma"),
        ("qcar_logger1_500Hz.csv", "quarter_car", {}, None, "sensor travel has no column"),
        (
            *("qcar_logger1_500Hz.csv+qcar_logger2_100Hz.csv", "quarter_car", {}, 2.99),
            "channels with times of their own are merged",
        ),
    ],
)
def test_what_loggers_write_is_read_and_told(file, case, columns, end, note):
    model = read_model(EXAMPLES / case / "model.toml")
    read = read_recording(MESS / file, model, columns, span=(None, end))
    plain = read_recording(EXAMPLES / case / "train.csv", model)
    assert note in " ".join(read.notes)
    assert read.t.size > 1000
    car = case == "quarter_car"
    moments = np.round(read.t - (0.0 if car else read.t[0]), 6)
    usual = np.round(plain.t, 6)
    # the motor was recorded once more under the same voltage
    for name, values in ({**read.inputs, **read.sensors} if car else read.inputs).items():
        known = {**plain.inputs, **plain.sensors}[name]
        at = np.isfinite(values) & np.isin(moments, usual)
        if name == "travel" and AND in file:  # a clock of its own: no moment in common
            assert not at.any()
            continue
        rows = np.searchsorted(usual, moments[at])
        close = np.isclose(values[at], known[rows], rtol=1e-4, atol=1e-3 * np.nanstd(known))
        assert np.count_nonzero(at) > 1000, name
        assert close.mean() > 0.99, name


def test_tokens_for_missing_values_are_missing():
    model = read_model(EXAMPLES / "double_pendulum" / "model.toml")
    read = read_recording(MESS / "dpend_tokens.csv", model)
    missing = {name: int(np.isnan(values).sum()) for name, values in read.sensors.items()}
    assert missing == {"enc1": 20, "enc2": 15}
