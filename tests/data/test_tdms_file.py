"""TDMS files, written by nptdms: groups are parts, times follow from what channels state."""

import io

import numpy as np
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.files.tdms_file import read_tdms
from symhyb.data.recording import read_recording
from symhyb.errors import InputError

nptdms = pytest.importorskip("nptdms", reason="the extra tdms is not installed")


def tdms(*channels):
    """The bytes of a file of channels (group, name, values, properties)."""
    stream = io.BytesIO()
    with nptdms.TdmsWriter(stream) as writer:
        writer.write_segment([nptdms.ChannelObject(*one) for one in channels])
    return stream.getvalue()


def stepped(step, unit="", **more):
    return {"wf_increment": step, "wf_start_offset": 0.0, "unit_string": unit, **more}


@pytest.fixture
def content(signals):
    return tdms(
        ("Fast", "laser", 1e3 * signals["laser"], stepped(0.01, "um")),
        ("Fast", "f", signals["f"], stepped(0.01, "N")),
        ("Slow", "accel", signals["accel"][::10], stepped(0.1, "m/s^2")),
    )


def test_groups_have_times_and_units_of_their_own(model, write, content, signals):
    path = write("run.tdms", content)
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.t, signals["t"][:100])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"])
    assert "sensor accel: 10 Hz beside rows at 100 Hz; missing in between" in recording.notes
    assert read_table(f"{path}#Slow").names() == ["t", "accel"]


def test_one_group_is_no_part_and_times_may_be_a_column(model, write, signals):
    path = write(
        "run.tdms",
        tdms(
            *(
                ("Log", name, signals[key], {})
                for name, key in {"Time": "t", "laser": "laser", "f": "f"}.items()
            )
        ),
    )
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.t, signals["t"])
    assert "t is Time, there is no column t" in recording.notes


def test_channels_of_a_group_with_other_steps_are_parts_of_it(signals):
    table = read_tdms(
        tdms(
            ("A", "x", signals["t"], stepped(0.01)),
            ("A", "y", signals["t"][:50], stepped(0.02)),
            ("B", "z", signals["t"], stepped(0.01)),
        ),
        "a.tdms",
    )
    assert table.names() == ["A.1.t", "A.1.x", "A.2.t", "A.2.y", "B.t", "B.z"]
    np.testing.assert_allclose(table.find("A.2.t")[0].values, 0.02 * np.arange(50))


def test_groups_that_begin_at_other_times_are_apart(signals):
    start = np.datetime64("2024-03-05T13:45:12.5", "us")
    late = start + np.timedelta64(250, "ms")
    table = read_tdms(
        tdms(
            ("A", "x", signals["t"], stepped(0.01, wf_start_time=late)),
            ("B", "y", signals["t"], stepped(0.01, wf_start_time=start)),
        ),
        "a.tdms",
    )
    np.testing.assert_allclose(table.find("A.t")[0].values[:2], [0.25, 0.26])
    np.testing.assert_allclose(table.find("B.t")[0].values[:2], [0.0, 0.01])


def test_dates_texts_and_units_that_nobody_knows(signals):
    dates = np.datetime64("2024-03-05T13:45:12", "us") + np.arange(3) * np.timedelta64(10, "ms")
    table = read_tdms(
        tdms(
            ("A", "when", dates, {}),
            ("A", "x", np.arange(3.0), {"unit_string": "furlong%"}),
            ("A", "state", ["on", "off", "on"], {}),
        ),
        "a.tdms",
    )
    assert [column.header for column in table.columns] == ["when [s]", "x"]
    np.testing.assert_allclose(table.columns[0].values, [0, 0.01, 0.02])
    assert table.notes == (
        "channel when holds dates: counted in s from the first",
        "channel state is text: left out",
    )


@pytest.mark.parametrize("step", [0.0, -0.01, np.nan, np.inf])
def test_a_step_that_is_none_gives_no_times(step):
    assert read_tdms(tdms(("A", "x", np.arange(9.0), stepped(step))), "a").names() == ["x"]


def test_nothing_in_it(write):
    with pytest.raises(InputError, match="holds no channel with numbers"):
        read_table(write("run.tdms", tdms(("A", "x", np.zeros(0), {}))))
    with pytest.raises(InputError, match=r"is not a TDMS file, although its name ends in \.tdms"):
        read_table(write("run.tdms", b"t,f\n0,1\n"))


def test_a_file_that_is_cut_off_says_so(content):
    table = read_tdms(content[:-100], "a.tdms")
    assert table.notes[0] == "the file is cut off: what was written last is missing"
    with pytest.raises(InputError, match=r"damaged or cut off TDMS file|holds no channel"):
        read_tdms(content[:60], "a.tdms")


def test_damage_inside_is_a_sentence_and_nothing_is_printed(write, content, capfd):
    """With counts of any size: what asks for too much memory is ended."""
    said = []
    for place in [*range(4, 60), *range(60, 700, 9)]:
        broken = bytearray(content)
        broken[place] ^= 0x71
        try:
            read_tdms(bytes(broken), "a.tdms")
        except InputError as error:
            said.append(str(error))
        except MemoryError:
            with pytest.raises(InputError, match="of memory"):
                read_table(write("big.tdms", bytes(broken)))
    assert said
    assert all("\n" not in text for text in said)
    assert capfd.readouterr() == ("", "")
