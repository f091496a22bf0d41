"""RPC III files, written byte by byte: groups of points of one channel after the other."""

import numpy as np
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.files.rpc_file import read_rpc
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


def rpc(signals, dt=0.01, order="<", kind="SHORT_INTEGER", group=32, frame=16, **more):
    """The bytes of a file of ``signals`` = {(name, unit): (values, scale)}."""
    points = -(-max(len(values) for values, _ in signals.values()) // frame) * frame
    groups = -(-points // group)
    head = {
        "FORMAT": "BINARY_IEEE_" + ("LITTLE" if order == "<" else "BIG") + "_END",
        "NUM_HEADER_BLOCKS": 8,
        "NUM_PARAMS": 0,
        "FILE_TYPE": "TIME_HISTORY",
        "DATA_TYPE": kind,
        "DELTA_T": f"{dt:.8e}",
        "CHANNELS": len(signals),
        "FRAMES": points // frame,
        "PTS_PER_FRAME": frame,
        "PTS_PER_GROUP": group,
    }
    stored = np.zeros((groups, len(signals), group), order + ("f4" if kind[0] == "F" else "i2"))
    for k, ((name, unit), (values, scale)) in enumerate(signals.items()):
        head |= {f"DESC.CHAN_{k + 1}": name, f"UNITS.CHAN_{k + 1}": unit}
        head[f"SCALE.CHAN_{k + 1}"] = f"{scale:.8e}"
        padded = np.zeros(groups * group)
        padded[: len(values)] = np.asarray(values) / (1 if kind[0] == "F" else scale)
        stored[:, k] = (padded if kind[0] == "F" else np.round(padded)).reshape(groups, group)
    head |= more
    head = {key: value for key, value in head.items() if value is not None}
    head |= {"NUM_PARAMS": len(head)} if "NUM_PARAMS" in head and not more.get("NUM_PARAMS") else {}
    text = b"".join(
        key.encode().ljust(32, b"\0") + str(value).encode("latin-1").ljust(96, b"\0")
        for key, value in head.items()
    )
    return text.ljust(8 * 512, b"\0") + stored.tobytes()


@pytest.fixture
def channels(signals):
    """96 points in counts: force in kN, laser in um."""
    return {
        ("f", "kN"): (signals["f"][:96] / 1e3, 1e-6),
        ("laser", "um"): (1e3 * signals["laser"][:96], 0.1),
    }


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("kind", ["SHORT_INTEGER", "FLOATING_POINT"])
@pytest.mark.parametrize(("group", "frame"), [(32, 16), (64, 32), (96, 96), (128, 32)])
def test_channels_are_read_with_their_units(
    model, write, channels, signals, order, kind, group, frame
):
    content = rpc(channels, order=order, kind=kind, group=group, frame=frame)
    recording = read_recording(write("run.rsp", content), model)
    np.testing.assert_allclose(recording.t, signals["t"][:96], atol=1e-12)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"][:96], atol=1e-3)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"][:96] / 1e3, atol=6e-8)


def test_floating_numbers_of_the_plain_format_are_said(channels):
    table = read_rpc(rpc(channels, kind="FLOATING_POINT", FORMAT="BINARY"), "a.rpc")
    assert "are read as IEEE, not as those of a VAX" in table.notes[0]
    assert read_rpc(rpc(channels, FORMAT="BINARY"), "a.rpc").notes == ()


def test_points_that_are_padding_by_the_header_are_left_out(channels):
    table = read_rpc(rpc(channels, SAMPLES=90), "a.rpc")
    assert [column.values.shape for column in table.columns] == [(90,)] * 3


def test_a_channel_without_a_name_has_a_number_and_one_of_a_name_twice_is_not_read(channels):
    table = read_rpc(rpc(channels, **{"DESC.CHAN_1": None}), "a.rpc")
    assert table.names() == ["t", "CHAN_1", "laser"]
    table = read_rpc(rpc(channels, **{"DESC.CHAN_1": "laser"}), "a.rpc")
    assert "more than once" in table.columns[1].problem.text


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"FILE_TYPE": "MATRIX"}, "FILE_TYPE is 'MATRIX'; readable is TIME_HISTORY"),
        ({"FORMAT": "ASCII"}, "FORMAT is 'ASCII'; readable is BINARY_IEEE_LITTLE_END or"),
        ({"DATA_TYPE": "COMPLEX"}, "DATA_TYPE is 'COMPLEX'"),
        ({"CHANNELS": 10**9}, "states 1000000000 channels of 96 points; at most"),
        ({"CHANNELS": 9999}, "is cut off: its header states"),
        ({"FRAMES": 10**12}, "states 2 channels of 16000000000000 points"),
        ({"FRAMES": -1}, "FRAMES must be a count above 0, not '-1'"),
        ({"PTS_PER_GROUP": 0}, "PTS_PER_GROUP must be a count above 0"),
        ({"PTS_PER_GROUP": 10**15 - 1}, "is cut off: its header states"),
        ({"PTS_PER_FRAME": "²"}, "PTS_PER_FRAME must be a count above 0"),
        ({"NUM_HEADER_BLOCKS": 99999}, "states 99999 blocks of header"),
        ({"NUM_PARAMS": 999}, "with 999 values"),
        ({"DELTA_T": "soon"}, "DELTA_T is no number: 'soon'"),
        ({"DELTA_T": "nan"}, "DELTA_T must be a step in s above 0, not 'nan'"),
        ({"DELTA_T": None}, "DELTA_T is missing"),
        ({"SCALE.CHAN_2": None}, r"SCALE\.CHAN_2 is missing"),
    ],
)
def test_a_header_that_is_wrong_is_one_sentence(channels, wrong, said):
    with pytest.raises(InputError, match=said) as caught:
        read_rpc(rpc(channels, **wrong), "a.rsp")
    assert len(caught.value.problems) == 1


def test_cuts_and_damage_are_one_sentence_or_values(channels):
    whole = rpc(channels)
    for size in (140, 500, 4000, len(whole) - 1):
        with pytest.raises(InputError) as caught:
            read_rpc(whole[:size], "a.rsp")
        assert len(caught.value.problems) == 1
    said = []
    for place in range(0, 1300):
        broken = bytearray(whole)
        broken[place] ^= 0x15
        try:
            read_rpc(bytes(broken), "a.rsp")
        except InputError as error:
            said.append(str(error))
    assert len(said) > 100
    assert all("\n" not in text for text in said)


def test_what_is_no_rpc_file(write):
    with pytest.raises(InputError, match="is not an RPC III file, although its name says so"):
        read_table(write("run.rpc", b"t,f\n0,1\n"))
