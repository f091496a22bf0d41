"""MATLAB files of version 7.3, written here as MATLAB writes them: transposed, with references."""

import io

import numpy as np
import pytest
from scipy.io import savemat

from symhyb.data.files.formats import read_table
from symhyb.data.files.mat_file import read_mat
from symhyb.data.recording import read_recording
from symhyb.errors import InputError

h5py = pytest.importorskip("h5py", reason="the extra mat73 is not installed")


class Archive:
    """Writes variables as MATLAB's ``save -v7.3`` does."""

    def __init__(self):
        self.buffer = io.BytesIO()
        self.file = h5py.File(self.buffer, "w", userblock_size=512)
        self.refs = self.file.create_group("#refs#")

    def put(self, where, name, value):
        """Write an array, a text, a dict (structure) or a list (cells) under ``name``."""
        if isinstance(value, dict):
            group = where.create_group(name)
            group.attrs["MATLAB_class"] = np.bytes_("struct")
            for key, item in value.items():
                self.put(group, key, item)
            return group
        if isinstance(value, list):
            item = where.create_dataset(name, (1, len(value)), dtype=h5py.ref_dtype)
            for k, one in enumerate(value):
                item[0, k] = self.put(self.refs, f"r{len(self.refs)}", one).ref
            item.attrs["MATLAB_class"] = np.bytes_("cell")
            return item
        if isinstance(value, str):
            item = where.create_dataset(name, data=np.array([[ord(c)] for c in value], np.uint16))
            item.attrs["MATLAB_class"] = np.bytes_("char")
            return item
        item = where.create_dataset(name, data=np.atleast_2d(value).T)
        item.attrs["MATLAB_class"] = np.bytes_("double")
        return item

    def put_structures(self, name, structures):
        """Write an array of structures: a group whose fields are arrays of references."""
        group = self.file.create_group(name)
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        for key in structures[0]:
            field = group.create_dataset(key, (1, len(structures)), dtype=h5py.ref_dtype)
            for k, one in enumerate(structures):
                field[0, k] = self.put(self.refs, f"r{len(self.refs)}", one[key]).ref

    def content(self, **variables):
        """Write these variables too, and return the bytes of the file."""
        for name, value in variables.items():
            self.put(self.file, name, value)
        self.file.close()
        raw = bytearray(self.buffer.getvalue())
        raw[:128] = b"MATLAB 7.3 MAT-file, made for a test".ljust(124) + b"\x00\x02IM"
        return bytes(raw)


@pytest.fixture
def archive():
    return Archive()


def standing(signals):
    return {name: values[:, None] for name, values in signals.items()}


def test_vectors_are_columns_and_numbers_may_be_used(model, write, archive, signals):
    path = write("run.mat", archive.content(**standing(signals), gain=2.5, row=signals["f"]))
    recording = read_recording(path, model, {"f": "gain*row"})
    np.testing.assert_array_equal(recording.inputs["f"], 2.5 * signals["f"])
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    assert recording.notes == ("column f is not used",)


def test_structures_cells_and_matrices_are_called_as_in_version_5(write, archive, signals):
    both = np.stack([signals["f"], signals["laser"]], axis=1)
    nested = {"run": {"t": signals["t"][:, None], "in": {"f": signals["f"][:, None]}}}
    cells = [signals["f"][:, None], both, both.T]
    newer = archive.content(**nested, angles=cells, both=both, dt=0.01)
    older = io.BytesIO()
    boxed = np.empty((1, 3), dtype=object)
    boxed[0, :] = cells
    savemat(older, nested | {"angles": boxed, "both": both, "dt": 0.01})
    new = read_table(write("new.mat", newer))
    old = read_table(write("old.mat", older.getvalue()))
    assert (
        sorted(new.names())
        == sorted(old.names())
        == [
            "angles.1",
            "angles.2.1",
            "angles.2.2",
            "angles.3.1",
            "angles.3.2",
            "both.1",
            "both.2",
            "dt",
            "run.in.f",
            "run.t",
        ]
    )
    for column in new.columns:
        (partner,) = old.find(column.header)
        np.testing.assert_array_equal(column.values, partner.values)
        assert (column.part, column.inside) == (partner.part, partner.inside)


def test_an_array_of_structures_is_a_part_each(model, write, archive, signals):
    half = {name: values[:50, None] for name, values in signals.items()}
    rest = {name: values[50:, None] for name, values in signals.items()}
    archive.put_structures("runs", [half, rest])
    path = write("run.mat", archive.content())
    recording = read_recording(f"{path}#runs.2", model)
    np.testing.assert_array_equal(recording.t, signals["t"][50:])
    assert recording.name == "run.mat#runs.2"


def test_what_is_no_vector_of_numbers_is_said_and_left_out(model, write, archive, signals):
    archive.file["elsewhere"] = h5py.ExternalLink("other.mat", "/secret")
    archive.file.create_dataset("z", data=np.zeros((1, 3), dtype=[("real", "f8"), ("imag", "f8")]))
    empty = archive.file.create_dataset("nothing", data=np.array([0, 0], dtype=np.uint64))
    empty.attrs["MATLAB_empty"] = np.uint8(1)
    big = np.ones((100, 70))
    path = write("run.mat", archive.content(**standing(signals), text="hello", big=big))
    assert set(read_recording(path, model).notes) == {
        "variable elsewhere is a link to something else: left out",
        "variable z is complex: left out",
        "variable nothing is empty: left out",
        "variable text is text: left out",
        "variable big is a matrix (100 x 70), not a vector: left out",
    }


def test_a_cell_that_refers_to_itself_ends_in_a_sentence(write, archive):
    loop = archive.file.create_dataset("loop", (1, 1), dtype=h5py.ref_dtype)
    loop[0, 0] = loop.ref
    loop.attrs["MATLAB_class"] = np.bytes_("cell")
    (note,) = read_table(write("run.mat", archive.content())).notes
    assert "is nested too deeply: left out" in note


def test_every_cut_is_one_sentence(archive, signals):
    whole = archive.content(**standing(signals))
    for length in [513, 520, 600, len(whole) // 2, len(whole) - 1]:
        with pytest.raises(InputError, match=r"damaged or cut off MAT file of version 7\.3"):
            read_mat(whole[:length], "run.mat")


def test_damage_inside_is_one_sentence(archive, signals):
    whole, said = bytearray(archive.content(**standing(signals))), []
    for place in range(512, len(whole), 97):
        broken = whole.copy()
        broken[place] ^= 0xFF
        try:
            read_mat(bytes(broken), "run.mat")
        except InputError as error:
            said.append(str(error))
    assert said
    assert all("damaged or cut off" in text and text.count("\n") == 0 for text in said)
