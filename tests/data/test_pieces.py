"""Recordings larger than memory: pieces that overlap, whatever the format."""

import itertools
import subprocess

import numpy as np
import pytest

from symhyb.data import pieces
from symhyb.data.pieces import pieces_of
from symhyb.data.recording import read_recording
from symhyb.errors import InputError


@pytest.fixture
def long_signals():
    t = np.arange(5000) / 100
    wave = np.sin(2 * np.pi * 0.3 * t)
    return {"t": t, "f": 5 * wave, "laser": 2 * wave + 0.1 * np.cos(9 * t), "accel": -3 * wave}


@pytest.fixture(autouse=True)
def here(request, monkeypatch):
    """Read in this process, which is quicker, but for the tests that are marked ``apart``."""
    if "apart" not in request.fixturenames:
        monkeypatch.setattr(
            pieces, "pieces_apart", lambda reader, path, file, rows, _: reader(path, file, rows)
        )


@pytest.fixture
def apart():
    """The reader has a process of its own, as it has for people."""


@pytest.fixture(params=["csv", "parquet", "mf4"])
def path(request, tmp_path, long_signals):
    """The same samples in every format."""
    file = tmp_path / f"run.{request.param}"
    if request.param == "csv":
        rows = np.column_stack(list(long_signals.values()))
        np.savetxt(file, rows, "%.17g", ",", header=",".join(long_signals), comments="")
    elif request.param == "parquet":
        arrow = pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
        parquet = pytest.importorskip("pyarrow.parquet")
        parquet.write_table(arrow.table(long_signals), file, row_group_size=700)
    else:
        asammdf = pytest.importorskip("asammdf", reason="the extra mdf is not installed")
        t = long_signals["t"]
        names = [name for name in long_signals if name != "t"]
        with asammdf.MDF() as measurement:
            group = [asammdf.Signal(long_signals[n], t, name=n) for n in names]
            measurement.append(group, common_timebase=True)
            measurement.save(file)
    return file


@pytest.mark.parametrize(("rows", "overlap"), [(600, 1), (1000, 30), (10_000, 5)])
def test_every_sample_is_of_one_piece(path, model, long_signals, rows, overlap):
    found = list(pieces_of(path, model, rows=rows, overlap=overlap))
    own = [
        one.recording.t[(one.recording.t >= one.first) & (one.recording.t < one.last)]
        for one in found
    ]
    whole = read_recording(path, model)
    np.testing.assert_array_equal(np.concatenate(own), whole.t)
    np.testing.assert_allclose(whole.t, long_signals["t"], atol=1e-12)
    for one in found:
        at = np.searchsorted(whole.t, one.recording.t)
        for name in one.recording.channels:
            np.testing.assert_array_equal(one.recording[name], whole[name][at])
    for one, other in itertools.pairwise(found):
        assert other.first == one.last
        assert one.recording.t[-1] == pytest.approx(one.last + overlap / 100)
        assert other.recording.t[0] <= one.last


def test_all_pieces_but_the_last_are_as_long(path, model):
    sizes = [one.recording.t.size for one in pieces_of(path, model, rows=600, overlap=50)]
    assert set(sizes[:-1]) == {700}
    assert 700 <= sizes[-1] <= 2 * 700


def test_an_index_goes_on(path, model, long_signals):
    found = pieces_of(path, model, {"t": "index/100"}, rows=900)
    times = [one.recording.t[one.recording.t >= one.first] for one in found]
    assert times[0][0] == 0
    assert times[-1][-1] == pytest.approx(long_signals["t"][-1])


def test_a_span_is_read_and_no_more(path, model):
    found = list(pieces_of(path, model, rows=500, span=(12.0, 31.0)))
    assert found[0].recording.t[0] == 12.0
    assert found[-1].recording.t[-1] == 31.0


def test_a_span_without_samples_is_refused(path, model):
    with pytest.raises(InputError, match=r"no sample in the span"):
        list(pieces_of(path, model, rows=500, span=(100.0, 200.0)))


def test_other_formats_are_refused(write, model):
    with pytest.raises(InputError, match=r"'\.mat' is not read in pieces; \.parquet, \.csv"):
        list(pieces_of(write("run.mat", b"x"), model, rows=100))
    with pytest.raises(InputError, match="there is no such file"):
        list(pieces_of("absent.csv", model, rows=100))


def test_what_stands_above_the_rows_holds_for_every_piece(write, model, long_signals):
    rows = zip(*long_signals.values(), strict=True)
    lines = ["logger 7", "t;f;laser;accel", "s;N;um;m/s²"]
    lines += [";".join(f"{x:.6f}".replace(".", ",") for x in row) for row in rows]
    path = write("run.csv", "\n".join(lines))
    found = list(pieces_of(path, model, rows=800))
    laser = found[-1].recording.sensors["laser"]
    np.testing.assert_allclose(laser[-5:], long_signals["laser"][-5:] * 1e-6, atol=1e-11)


def test_a_bad_cell_is_told_with_its_line(write, model, long_signals):
    lines = ["t,f,laser,accel"]
    lines += [",".join(f"{x:.6f}" for x in row) for row in zip(*long_signals.values(), strict=True)]
    lines[4321] = "43.20,1,2,broken"
    with pytest.raises(InputError, match=r"'broken' is not a number") as refused:
        list(pieces_of(write("run.csv", "\n".join(lines)), model, rows=600))
    assert refused.value.problems[0].line == 4322


def test_time_that_starts_anew_is_refused(write, model, long_signals):
    lines = ["t,f,laser,accel"]
    rows = list(zip(*long_signals.values(), strict=True))
    lines += [",".join(map(str, row)) for row in [*rows[:2000], *rows[:2000]]]
    with pytest.raises(InputError, match=r"time (goes|does not increase)"):
        list(pieces_of(write("run.csv", "\n".join(lines)), model, rows=500))


def test_a_file_that_is_cut_off_is_refused(tmp_path, model, long_signals):
    arrow = pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
    parquet = pytest.importorskip("pyarrow.parquet")
    whole, cut = tmp_path / "whole.parquet", tmp_path / "cut.parquet"
    parquet.write_table(arrow.table(long_signals), whole)
    cut.write_bytes(whole.read_bytes()[:-20])
    with pytest.raises(InputError, match="cut off"):
        list(pieces_of(cut, model, rows=500))
    broken = bytearray(whole.read_bytes())
    broken[100:3000] = bytes(2900)
    cut.write_bytes(broken)
    with pytest.raises(InputError, match=r"damaged|does not"):
        list(pieces_of(cut, model, rows=500))


@pytest.mark.usefixtures("apart")
def test_a_process_of_its_own_reads_the_same(path, model):
    whole = read_recording(path, model)
    *_, last = pieces_of(path, model, rows=2000, overlap=3)
    np.testing.assert_array_equal(last.recording.t, whole.t[-last.recording.t.size :])
    np.testing.assert_array_equal(
        last.recording.sensors["laser"], whole.sensors["laser"][-last.recording.t.size :]
    )


@pytest.mark.usefixtures("apart")
def test_what_a_process_refuses_is_told(write, model):
    with pytest.raises(InputError, match="is not a Parquet file"):
        list(pieces_of(write("run.parquet", b"t,f\n0,1\n"), model, rows=500))


@pytest.mark.usefixtures("apart")
def test_a_process_that_is_not_asked_on_ends(path, model, monkeypatch):
    plain, started = subprocess.Popen, []

    def popen(*arguments, **options):
        started.append(plain(*arguments, **options))
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", popen)
    found = pieces_of(path, model, rows=600)
    next(found)
    found.close()
    assert [one.poll() is not None for one in started] == [True]
