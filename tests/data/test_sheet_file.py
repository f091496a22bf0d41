"""Excel: sheets are parts, the first row names the columns, whatever the suffix says."""

import datetime
import io
import struct
import zipfile

import numpy as np
import pytest

from symhyb.data.files.formats import read_table
from symhyb.data.recording import read_recording
from symhyb.errors import InputError

openpyxl = pytest.importorskip("openpyxl", reason="the extra excel is not installed")


def book(**sheets):
    """The bytes of a workbook with these rows a sheet."""
    workbook = openpyxl.Workbook()
    workbook.remove(workbook.active)
    for name, rows in sheets.items():
        sheet = workbook.create_sheet(name)
        for row in rows:
            sheet.append(row)
    buffer = io.BytesIO()
    workbook.save(buffer)
    return buffer.getvalue()


def rows_of(signals, names=None):
    names = names or list(signals)
    columns = [signals[name].tolist() for name in names]
    return [names, *(list(row) for row in zip(*columns, strict=True))]


@pytest.mark.parametrize("suffix", ["xlsx", "XLSX", "xls"])
def test_one_sheet_is_the_whole_file(model, write, signals, suffix):
    path = write(f"run.{suffix}", book(Sheet1=rows_of(signals), Sheet2=[]))
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"] / 1e3)
    assert recording.notes == ()


def test_the_old_format_of_excel(model, write, signals):
    """The oldest one, as it needs no container: records of a kind, a length and a content."""
    pytest.importorskip("xlrd")
    records = [(0x0009, struct.pack("<HH", 2, 0x10))]
    for column, (name, values) in enumerate(signals.items()):
        text = name.encode()
        records.append((0x0004, struct.pack("<HH3xB", 0, column, len(text)) + text))
        records += [
            (0x0003, struct.pack("<HH3xd", row, column, value))
            for row, value in enumerate(values, start=1)
        ]
    records.append((0x000A, b""))
    content = b"".join(struct.pack("<HH", kind, len(data)) + data for kind, data in records)
    recording = read_recording(write("run.xls", content), model)
    np.testing.assert_array_equal(recording.inputs["f"], signals["f"])
    np.testing.assert_array_equal(recording.t, signals["t"])


def test_rows_above_and_columns_beside_the_table(model, write, signals):
    rows = [[None, *row] for row in rows_of(signals)]
    rows[0][2] = "f [kN]"
    path = write("run.xlsx", book(Sheet1=[[], [], *rows, [], []]))
    recording = read_recording(path, model)
    np.testing.assert_allclose(recording.inputs["f"], 1e3 * signals["f"])
    assert read_table(path).names() == ["t", "f", "laser", "accel"]


@pytest.mark.slow
def test_a_sheet_is_chosen_behind_the_name_of_the_file(model, write, signals):
    twice = {name: 2 * values for name, values in signals.items()}
    content = book(**{"first run": rows_of(signals), "second run": rows_of(twice)})
    path = write("run.xlsx", content)
    recording = read_recording(f"{path}#second run", model)
    np.testing.assert_allclose(recording.t, 2 * signals["t"])
    assert recording.name == "run.xlsx#second run"
    with pytest.raises(InputError, match=r"is in 2 parts .* as in f=first run\.f, or read one"):
        read_recording(path, model)
    with pytest.raises(InputError, match=r"has no part 'secnd run'; did you mean 'second run'"):
        read_recording(f"{path}#secnd run", model)
    with pytest.raises(
        InputError, match=r"'#2' counts runs and not parts: .* as in '.*#first run'"
    ):
        read_recording(f"{path}#2", model)
    with pytest.raises(InputError, match=r"'#3' follows '#1', but a run has no parts"):
        read_recording(f"{path}#second run#1#3", model)
    with pytest.raises(InputError, match=r"no run of that number: time never .*; leave '#2' out"):
        read_recording(f"{path}#second run#2", model)


def test_sheets_of_different_rates_are_merged(model, write, signals):
    slow = {name: values[::5] for name, values in signals.items()}
    content = book(fast=rows_of(signals, ["t", "f", "laser"]), slow=rows_of(slow, ["t", "accel"]))
    recording = read_recording(write("run.xlsx", content), model)
    np.testing.assert_allclose(recording.t, signals["t"])
    assert np.isfinite(recording.sensors["accel"]).sum() == 20
    assert "sensor accel: 20 Hz beside rows at 100 Hz; missing in between" in recording.notes


@pytest.mark.slow
def test_runs_below_one_another_are_numbered(model, write, signals):
    rows = rows_of(signals)
    path = write("run.xlsx", book(Sheet1=[*rows, *rows[1:61]]))
    with pytest.raises(InputError, match=r"if these are 2 runs, read one of them, as in '.*#2'"):
        read_recording(path, model)
    recording = read_recording(f"{path}#2", model)
    np.testing.assert_array_equal(recording.t, signals["t"][:60])
    assert recording.notes == ("run 2 of 2 in the file",)
    with pytest.raises(
        InputError, match=r"no part '3', and no run of that number: it holds 2 runs"
    ):
        read_recording(f"{path}#3", model)


def test_dates_are_counted_from_the_first(model, write, signals):
    start = datetime.datetime(2024, 5, 1, 12)
    rows = rows_of(signals)
    for row in rows[1:]:
        row[0] = start + datetime.timedelta(seconds=2 * round(100 * row[0]))
    recording = read_recording(write("run.xlsx", book(Sheet1=rows)), model)
    np.testing.assert_allclose(recording.t, 2 * np.arange(100), atol=1e-5)
    assert recording.notes[0].startswith("column t holds dates: counted in s from the first, 2024")


def test_words_among_the_numbers_name_their_row(model, write, signals):
    rows = rows_of(signals)
    rows[4][2] = "ERR"
    with pytest.raises(InputError, match=r"column 'laser': 'ERR' is not a number, in row 5$"):
        read_recording(write("run.xlsx", book(Sheet1=rows)), model)


def test_a_header_twice_is_no_column(model, write, signals):
    rows = rows_of(signals)
    rows[0][3] = "laser"
    with pytest.raises(InputError, match=r"column 'laser': stands more than once in the header"):
        read_recording(write("run.xlsx", book(Sheet1=rows)), model)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"t,f\n0,1\n", r"not an Excel file, although its name ends in \.xlsx; if it is text"),
        (b"\xd0\xcf\x11\xe0" + b"\0" * 600, r"is a damaged or cut off Excel file"),
        (
            b"\xd0\xcf\x11\xe0" + "EncryptedPackage".encode("utf-16-le"),
            r"is encrypted; save it without a password",
        ),
        (book(one=[], two=[]), r"all sheets are empty"),
        (book(one=[[1, 2], [3, 4]]), r"no sheet has a row with the names of the columns"),
        (book(one=[["t", "f"]]), r"no sheet has a row with the names of the columns"),
    ],
)
def test_what_cannot_be_used(write, content, message):
    with pytest.raises(InputError, match=message):
        read_table(write("run.xlsx", content))


@pytest.mark.slow
def test_cuts_and_other_archives_are_one_sentence(write, signals):
    whole = book(Sheet1=rows_of(signals))
    other = io.BytesIO()
    with zipfile.ZipFile(other, "w") as archive:
        archive.writestr("a.txt", "hello")
    for content in (whole[:300], whole[: len(whole) // 2], whole[:-10], other.getvalue()):
        with pytest.raises(InputError, match=r"is a damaged or cut off Excel file") as caught:
            read_table(write("run.xlsx", content))
        assert "\n" not in str(caught.value)


def test_an_archive_that_unpacks_to_far_more_than_a_table_is_not_unpacked(write):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("xl/worksheets/sheet1.xml", bytes(30_000_000))
    with pytest.raises(InputError, match="unpacks to 30 MB, more than 200 times its own size"):
        read_table(write("run.xlsx", stream.getvalue()))
