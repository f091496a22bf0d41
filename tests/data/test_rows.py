"""What is repaired and said, and what is refused: time, repeated rows, holes of inputs."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.data.recording import read_recording
from symhyb.data.rows import Block, blocks
from symhyb.errors import InputError


@pytest.fixture
def read(model, write, table):
    def read_table(columns, **more):
        return read_recording(write("run.csv", table(columns)), model, **more)

    return read_table


@pytest.fixture
def refused(read):
    def problem_of(columns) -> str:
        with pytest.raises(InputError) as caught:
            read(columns)
        (problem,) = caught.value.problems
        return f"{problem.place}: {problem.text}"

    return problem_of


def test_more_rows_than_are_read(refused, signals, monkeypatch) -> None:
    monkeypatch.setattr("symhyb.data.rows.ROWS", 50)
    assert "rows; at most 50 are read: cut the file into parts" in refused(signals)


def rows(signals, order):
    return {name: values[order] for name, values in signals.items()}


@pytest.mark.parametrize(
    ("flags", "expected"),
    [
        ([0, 0, 0], []),
        ([1, 1, 1], [Block(0, 2)]),
        ([1, 0, 1, 1], [Block(0, 0), Block(2, 3)]),
        ([0, 1, 0], [Block(1, 1)]),
        ([], []),
    ],
)
def test_blocks(flags, expected):
    assert blocks(np.array(flags, dtype=bool)) == expected


def test_time_that_goes_back_is_refused_with_line_and_both_values(refused, signals):
    signals["t"][50] = 0.25
    assert refused(signals) == (
        "t: time does not increase at line 52: 0.25 s after 0.49 s;"
        " sort the rows, or cut the file there"
    )


def test_every_step_back_is_counted(refused, signals):
    signals["t"] = signals["t"] % 0.3
    assert "at line 32: 0 s after 0.29 s (and 2 more)" in refused(signals)


def test_equal_times_with_different_values_are_refused(refused, signals):
    signals["t"][50] = signals["t"][49]
    assert "at line 52: 0.49 s after 0.49 s" in refused(signals)


def test_lines_are_those_of_the_file_whatever_was_dropped_before(read, signals):
    repeated = rows(signals, np.r_[:10, 9, 9, 10:100])
    repeated["t"][60] = 0.0
    with pytest.raises(InputError, match="at line 62: 0 s after"):
        read(repeated, span=(0.0, 0.9))


def test_repeated_rows_are_dropped_and_noted(read, signals):
    signals["accel"][30] = np.nan
    recording = read(rows(signals, np.r_[:31, 30, 30, 31:100]))
    np.testing.assert_array_equal(recording.t, signals["t"])
    assert "2 rows that repeat the row before them: dropped" in recording.notes


def test_missing_times_are_refused(refused, signals):
    signals["t"][[20, 40]] = np.nan
    assert refused(signals) == "t: time is missing at line 22 (and 1 more)"


def test_rows_without_any_number_are_dropped_and_noted(read, signals):
    for values in signals.values():
        values[[3, 70]] = np.nan
    recording = read(signals)
    assert recording.t.size == 98
    assert recording.notes[0] == "2 rows without any number: dropped"


@pytest.mark.parametrize("size", [0, 1, 19])
def test_too_few_samples(refused, signals, size):
    said = refused(rows(signals, slice(size)))
    assert said.endswith(
        "there is a header but no row below it"
        if size == 0
        else f"usable samples: {size}; at least 20 are needed"
    )


def test_a_span_with_too_few_samples_is_named(read, signals):
    with pytest.raises(InputError, match=r"samples: 0; .* \(only t = 5 … 6 s was read\)"):
        read(signals, span=(5.0, 6.0))


def test_20_samples_are_enough(read, signals):
    assert read(rows(signals, slice(20))).t.size == 20


# ------------------------------------------------------------------------------- inputs


def test_short_holes_of_an_input_are_bridged_in_a_straight_line_and_noted(read, signals):
    signals["f"][:] = 3 + 7 * signals["t"]
    whole = signals["f"].copy()
    signals["f"][[10, 40, 41, 42]] = np.nan
    signals["f"][10] = np.inf
    with np.errstate(all="ignore"):
        recording = read(signals)
    np.testing.assert_allclose(recording.inputs["f"], whole)
    assert recording.notes == ("input f: 4 missing samples interpolated, first at t = 0.1 s",)


def test_long_holes_of_an_input_are_refused_with_their_span(refused, signals):
    signals["f"][40:44] = np.nan
    assert refused(signals) == (
        "input f: is missing for 4 samples, t = 0.4 … 0.43 s;"
        " crop the recording to the part before or after it"
    )


def test_an_input_that_stops_before_the_sensors(refused, signals):
    signals["f"][98:] = np.nan
    assert refused(signals) == (
        "input f: stops at t = 0.97 s, before the sensors do at t = 0.99 s;"
        " crop the recording to end at 0.97 s"
    )


def test_an_input_that_begins_after_the_sensors(refused, signals):
    signals["f"][:5] = np.nan
    assert "begins only at t = 0.05 s" in refused(signals)


def test_an_input_without_any_sample(refused, signals):
    signals["f"][:] = np.nan
    assert refused(signals) == "input f: has no finite sample"


def test_all_holes_are_said_at_once(read, signals):
    signals["f"][20:30] = np.nan
    signals["f"][90:] = np.nan
    with pytest.raises(InputError) as caught:
        read(signals)
    assert len(caught.value.problems) == 2


def test_ends_without_a_sample_of_any_sensor_are_dropped(read, signals):
    for name in ("laser", "accel"):
        signals[name][:4] = np.nan
        signals[name][90:] = np.nan
    signals["f"][95:] = np.nan
    recording = read(signals)
    assert (recording.t[0], recording.t[-1]) == (0.04, 0.89)
    assert recording.notes == (
        "14 rows before the first or after the last sample of a sensor: dropped",
    )


def test_sensors_without_any_sample(read, refused, signals):
    signals["accel"][:] = np.nan
    recording = read(signals)
    assert set(recording.sensors) == {"laser"}
    assert recording.notes == ("sensor accel has no finite sample: left out",)
    signals["laser"][:] = np.inf
    assert "no sensor (laser, accel) has a finite sample" in refused(signals)


def test_a_held_input_keeps_its_value_between_slow_samples_and_over_a_hole(model, write):
    held = replace(model, inputs=(replace(model.inputs[0], between="held"),))
    t = np.arange(100) / 100
    wanted = np.floor(t * 20 + 1e-9) ** 2
    slow = np.where(np.arange(100) % 5 == 0, wanted, np.nan)
    slow[-1] = wanted[-1]
    hole = wanted.copy()
    hole[42:44] = np.nan
    for values, said in ((slow, "held in between"), (hole, "2 missing samples held over")):
        lines = [
            f"{a:.2f},{'' if np.isnan(f) else f},{a:.4f}" for a, f in zip(t, values, strict=True)
        ]
        recording = read_recording(write("run.csv", "\n".join(["t,f,laser", *lines])), held)
        np.testing.assert_allclose(recording.inputs["f"], wanted)
        assert any(said in note for note in recording.notes)


def test_a_time_shorter_than_any_motion_is_refused(refused, signals):
    said = refused({**signals, "t": 1e-302 * signals["t"]})
    assert said.startswith("t: time runs over 9.9e-303 s alone, faster than any machine")


def test_a_value_that_no_sensor_measures_is_missing(read, signals):
    """Loggers write the largest float for a sample that they do not have."""
    laser = signals["laser"].copy()
    laser[[7, 30]] = -1.7e308, 1e104
    found = read({**signals, "laser": laser}).sensors["laser"]
    assert np.flatnonzero(np.isnan(found)).tolist() == [7, 30]


def test_a_time_longer_than_any_machine_lasts_is_refused(refused, signals):
    """Differences of times as far apart as floats reach are infinite."""
    times = 1.5e308 * np.linspace(-1, 1, signals["t"].size)
    said = refused({**signals, "t": times})
    assert said.startswith("t: time runs from -1.5e+308 to 1.5e+308 s, longer than any machine")
