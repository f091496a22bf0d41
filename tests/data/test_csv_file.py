"""Delimited text as machines and spreadsheets write it, and everything that is not one."""

import numpy as np
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


def refused(path) -> str:
    with pytest.raises(InputError) as caught:
        read_table(path)
    (problem,) = caught.value.problems
    return str(problem).removeprefix(str(path)).lstrip(":")


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_delimiters_are_found_in_the_header(model, write, table, signals, delimiter):
    recording = read_recording(write("run.csv", table(signals, delimiter)), model)
    np.testing.assert_allclose(recording.sensors["accel"], signals["accel"], rtol=1e-14)


def test_a_header_with_another_delimiter_in_a_name(write):
    columns = read_table(write("run.csv", "t;force, filtered;x\n0;1;2\n")).columns
    assert [column.name for column in columns] == ["t", "force, filtered", "x"]


def test_a_decimal_comma_is_understood_and_noted(model, write, table, signals):
    text = table(signals, ";").replace(".", ",")
    recording = read_recording(write("run.csv", text), model)
    np.testing.assert_allclose(recording.inputs["f"], signals["f"], rtol=1e-14)
    assert recording.notes == ("numbers are written with a decimal comma",)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_encodings_of_spreadsheets(write, encoding):
    text = "t [s],Weg [µm]\r\n0,1\r\n1,2\r\n"
    columns = read_table(write("run.csv", text.encode(encoding))).columns
    assert [column.header for column in columns] == ["t [s]", "Weg [µm]"]
    np.testing.assert_array_equal(columns[1].values, [1, 2])


def test_quoted_names_blank_lines_and_delimiters_at_the_end(write):
    table = read_table(write("run.csv", '\n"V1", "V 2",\n\n1,2,\n3,4,\n   \n'))
    assert [column.name for column in table.columns] == ["V1", "V 2"]
    np.testing.assert_array_equal(table.columns[1].values, [2, 4])
    assert table.row(1) == "line 5"


@pytest.mark.parametrize("cell", ["", "NaN", "nan", "NA", "  "])
def test_empty_cells_are_missing_samples(write, cell):
    column = read_table(write("run.csv", f"t,x\n0,1\n1,{cell}\n2,3\n")).columns[1]
    assert column.problem is None
    np.testing.assert_array_equal(column.values, [1, np.nan, 3])


def test_numbers_are_read_to_the_last_digit(write):
    exact = [0.1 + 0.2, 1 / 3, 1.7976931348623157e308, 5e-324, -2.2250738585072014e-308]
    text = "t,x\n" + "".join(f"{k},{value!r}\n" for k, value in enumerate(exact))
    np.testing.assert_allclose(read_table(write("run.csv", text)).columns[1].values, exact, 1e-15)


def test_a_column_of_text_matters_only_if_it_is_wanted(model, write, signals):
    lines = ["t,f,laser,remark"] + [f"{t},0,{t},{'ok' if t else '7'}" for t in signals["t"]]
    path = write("run.csv", "\n".join(lines))
    assert "column remark is not used" in read_recording(path, model).notes
    with pytest.raises(InputError) as caught:
        read_recording(path, model, {"accel": "remark"})
    assert str(caught.value) == (f"{path}:3: column 'remark': 'ok' is not a number (99 such cells)")


def test_a_cell_that_is_no_number_is_shown_with_line_and_column(model, write, table, signals):
    lines = table(signals).splitlines()
    lines[41] = lines[41].rsplit(",", 1)[0] + ",1.2.3"
    path = write("run.csv", "\n".join(lines))
    with pytest.raises(InputError) as caught:
        read_recording(path, model)
    assert str(caught.value) == f"{path}:42: column 'accel': '1.2.3' is not a number"


def test_a_name_that_stands_twice_cannot_be_used(model, write, signals):
    lines = ["t,f,laser,laser", *(f"{t},1,2,3" for t in signals["t"])]
    with pytest.raises(InputError, match="column 'laser': stands more than once in the header"):
        read_recording(write("run.csv", "\n".join(lines)), model)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", " the file is empty"),
        (b"\n  \n\t\n", " the file is empty"),
        (b"t,f,laser\n", " there is a header but no row below it"),
        (b"0,1,2\n1,2,3\n", "1: a first line with the names of the columns is required"),
        (b",,\n1,2,3\n", "1: a first line with the names of the columns is required"),
        (b"t x\n0 1\n1 2\n", "1: no comma, semicolon or tab separates the names"),
        (b"t,x\n0,1\n1,2,3\n2,3\n", "3: has 3 cells, the header has 2"),
        (b"t,x\n0,1\n1\n2\n2,3\n", "3: has 1 cell, the header has 2; 1 more line like this"),
        (b"t,x\n0,1\n1,2\n2", "4: has 1 cell, the header has 2; it is the last line, perhaps cut"),
        (b'"t","x"\n"0,1\n1,2\n', "2: has 1 cell, the header has 2"),
        (bytes(range(256)) * 40, " is not a text file, although its name ends in .csv"),
        (b"\x89PNG\r\n\x1a\n" + b"\xff" * 100, " is not a text file"),
        (b"PK\x03\x04 a spreadsheet", " is not a text file"),
    ],
)
def test_what_is_no_table_is_refused_in_one_sentence(write, content, message):
    said = refused(write("run.csv", content))
    assert any(said.startswith(part) or part in said for part in message.split("|"))


def test_noise_called_csv_never_ends_in_another_error(write):
    for seed in range(30):
        content = np.random.default_rng(seed).bytes(300)
        assert refused(write("run.csv", content))


def test_a_missing_file_with_a_near_name(write, tmp_path):
    write("sweep_03.csv", "t\n0\n")
    assert refused(tmp_path / "sweep_3.csv") == " does not exist; did you mean 'sweep_03.csv'?"
    assert "there is no folder" in refused(tmp_path / "lost" / "sweep.csv")


def test_a_folder_is_no_recording(tmp_path):
    assert refused(tmp_path) == " is a folder, not a recording"


@pytest.mark.parametrize("name", ["run.ods", "run.txt", "run", "run.csv.gz"])
def test_an_unknown_format_names_the_readable_ones(write, name):
    said = refused(write(name, "t,x\n0,1\n"))
    assert "is not a readable format; readable are .csv, .mat" in said


def test_a_suffix_in_capitals_is_the_same(write):
    assert read_table(write("RUN.CSV", "t,x\n0,1\n")).names() == ["t", "x"]


def test_a_file_that_may_not_be_read(write, monkeypatch):
    def forbidden(path, mode):
        raise PermissionError(13, "Permission denied")

    path = write("run.csv", "t,x\n0,1\n")
    monkeypatch.setattr("symhyb.limits.open", forbidden, raising=False)
    assert refused(path) == " cannot be read: Permission denied"


def test_a_number_that_no_float_holds_is_infinite(write):
    rows = "".join(f"{i},{i}\n" for i in range(3))
    (_, x) = read_table(write("run.csv", f"t,x\n{rows}3,{'9' * 400}\n4,-{'9' * 400}\n")).columns
    assert x.values.tolist() == [0.0, 1.0, 2.0, np.inf, -np.inf]


def test_names_of_columns_do_nothing_to_a_terminal(write):
    path = write("run.csv", "t,x\u202e [m],\x9by\n0,1,2\n")
    assert read_table(path).names() == ["t", "x\\u202e", "\\u009by"]


def test_more_columns_than_any_rig_has_are_refused(write):
    header = ",".join(["t", *(f"c{number}" for number in range(10_000))])
    with pytest.raises(InputError, match="has 10001 columns; at most 10000 are read"):
        read_table(write("run.csv", header + "\n0" + ",1" * 10_000 + "\n"))
