"""MATLAB files: vectors and numbers are columns, the rest is said and left out; cuts are seen."""

import io
import struct

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_array

from symhyb.data.files.formats import read_table
from symhyb.data.files.mat_file import read_mat
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


@pytest.fixture
def content(signals):
    """The bytes of a MAT file with column vectors and a number."""

    def content_of(compressed=False, **more):
        columns = {name: values[:, None] for name, values in signals.items()}
        buffer = io.BytesIO()
        savemat(buffer, columns | more, do_compression=compressed)
        return buffer.getvalue()

    return content_of


@pytest.mark.parametrize("compressed", [False, True])
def test_vectors_are_columns_and_numbers_may_be_used(model, write, signals, content, compressed):
    path = write("run.mat", content(compressed, gain=2.5, row=signals["f"][None, :]))
    recording = read_recording(path, model, {"f": "gain*row"})
    np.testing.assert_array_equal(recording.inputs["f"], 2.5 * signals["f"])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    assert recording.notes == ("column f is not used",)


def test_integers_and_flags_are_numbers(model, write, content, signals):
    counts = np.round(100 * signals["laser"]).astype(np.int16)
    path = write("run.mat", content(counts=counts, on=np.ones(100, dtype=bool)))
    recording = read_recording(path, model, {"laser": "counts/100", "f": "on"})
    np.testing.assert_allclose(recording.sensors["laser"], counts / 1e5)
    assert set(recording.inputs["f"]) == {1.0}


def test_what_is_no_vector_of_numbers_is_said_and_left_out(model, write, content):
    path = write(
        "run.mat",
        content(
            text="hello",
            big=np.ones((100, 70)),
            z=np.ones(100) * 1j,
            nothing=np.empty((0, 0)),
            struct={"a": "b"},
            sparse=csc_array(np.eye(3)),
        ),
    )
    assert set(read_recording(path, model).notes) == {
        "variable text is text: left out",
        "variable big is a matrix (100 x 70), not a vector: left out",
        "variable z is complex: left out",
        "variable nothing is empty: left out",
        "variable struct.a is text: left out",
        "variable sparse is no array of numbers: left out",
    }


def test_structures_cells_and_matrices_are_named_with_dots(model, write, content, signals):
    cells = np.empty((2, 1), dtype=object)
    both = np.stack([signals["accel"], signals["laser"]], axis=1)
    cells[:, 0] = [both, both.T]
    path = write("run.mat", content(cells=cells, both=both, run={"in": {"f": signals["f"]}}))
    names = read_table(path).names()[4:]
    assert names == [
        "cells.1.1",
        "cells.1.2",
        "cells.2.1",
        "cells.2.2",
        "both.1",
        "both.2",
        "run.in.f",
    ]
    mapping = {"f": "2*run.in.f + 0*both.1", "laser": "cells.2.2", "accel": "both.1 [mm/s^2]"}
    recording = read_recording(path, model, mapping)
    np.testing.assert_allclose(recording.inputs["f"], 2 * signals["f"])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    np.testing.assert_allclose(recording.sensors["accel"], signals["accel"] / 1e3)
    with pytest.raises(
        InputError, match=r"there is no column 'run\.in\.g'; did you mean 'run.in.f'"
    ):
        read_recording(path, model, {"f": "2*run.in.g"})


def test_an_array_of_structures_is_a_part_each(model, write, signals):
    runs = np.zeros(2, dtype=[(name, object) for name in signals])
    for k, part in enumerate((slice(0, 40), slice(40, 100))):
        for name, values in signals.items():
            runs[name][k] = values[part]
    buffer = io.BytesIO()
    savemat(buffer, {"runs": runs})
    path = write("run.mat", buffer.getvalue())
    recording = read_recording(f"{path}#runs.2", model)
    np.testing.assert_array_equal(recording.t, signals["t"][40:])
    with pytest.raises(InputError, match=r"has no part 'run'; did you mean 'runs\.[12]'"):
        read_recording(f"{path}#run", model)


@pytest.mark.slow
def test_cells_one_after_the_other(write, model, signals):
    pieces = [slice(0, 40), slice(40, 70), slice(70, None)]
    cells = {name: np.empty(3, dtype=object) for name in signals}
    for name, values in signals.items():
        cells[name][:] = [values[piece] for piece in pieces]
    other = np.empty(2, dtype=object)
    other[:] = [np.ones(5), np.ones(5)]
    buffer = io.BytesIO()
    savemat(buffer, {**cells, "rate": 100.0, "other": other})
    path = write("run.mat", buffer.getvalue())
    whole = read_recording(f"{path}#1-3", model)
    np.testing.assert_array_equal(whole.t, signals["t"])
    names = read_table(f"{path}#1-3").names()
    assert "other" not in names  # not in every cell
    assert "rate" in names
    assert read_table(f"{path}#1-2").find("other")[0].values.size == 10
    with pytest.raises(InputError, match=r"'#2-4': it has no cell 4"):
        read_recording(f"{path}#2-4", model)
    with pytest.raises(InputError, match=r"'#3-1' must go up"):
        read_recording(f"{path}#3-1", model)


def test_vectors_of_different_length_cannot_be_used_together(model, write, content):
    path = write("run.mat", content(short=np.ones(50)))
    assert "column short is not used" in read_recording(path, model).notes
    with pytest.raises(InputError, match=r"differ in their number of rows: .*short has 50"):
        read_recording(path, model, {"accel": "short"})


def test_a_file_of_cells_alone_says_so(public_file, model):
    path = public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    with pytest.raises(InputError, match=r"no sensor .* \(columns: Time_id\.1, .*Y_id\.1\.1, .*\)"):
        read_recording(path, model)


def test_a_file_of_a_machine_with_the_other_byte_order(write):
    def element(kind: int, data: bytes) -> bytes:
        return struct.pack(">II", kind, len(data)) + data.ljust(-(-len(data) // 8) * 8, b"\0")

    parts = element(6, struct.pack(">II", 6, 0))  # flags: an array of doubles
    parts += element(5, struct.pack(">ii", 3, 1)) + element(1, b"x")  # size and name
    parts += element(9, struct.pack(">3d", 1.5, 2.5, -3.5))
    header = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x01\x00MI"
    (column,) = read_table(write("run.mat", header + element(14, parts))).columns
    assert column.name == "x"
    np.testing.assert_array_equal(column.values, [1.5, 2.5, -3.5])


@pytest.mark.parametrize("compressed", [False, True])
def test_every_cut_is_seen(content, compressed):
    whole = content(compressed)
    assert read_mat(whole, "run.mat").names() == ["t", "f", "laser", "accel"]
    said, fewer = [], []
    for length in [*range(1, 200), *range(200, len(whole), 37), len(whole) - 1]:
        try:
            fewer.append(read_mat(whole[:length], "run.mat").names())
        except InputError as error:
            said.append(str(error))
    assert all("is cut off" in text or "is not a MAT file" in text for text in said)
    # a cut between two variables leaves a valid file with fewer of them
    assert len(fewer) <= 3
    assert all(len(names) < 4 for names in fewer)


def test_damage_inside_is_one_sentence(content):
    whole, said = bytearray(content(compressed=True)), []
    for place in range(140, len(whole), 211):
        broken = whole.copy()
        broken[place] ^= 0xFF
        try:
            read_mat(bytes(broken), "run.mat")
        except InputError as error:
            said.append(str(error))
    assert said
    assert all("damaged" in text or "cut off" in text for text in said)


@pytest.mark.parametrize("junk", [b"t,f\n0,1\n", b"\0" * 1000, bytes(range(256)) * 9])
def test_what_is_no_mat_file(write, junk):
    with pytest.raises(
        InputError, match=r"is not a MAT file of version 5 or 7\.3|the file is empty"
    ):
        read_table(write("run.mat", junk))
