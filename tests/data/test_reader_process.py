"""A reader in a process of its own: what it reads comes back, what it breaks is a sentence."""

import os
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from symhyb.data.files import apart
from symhyb.data.files.apart import read_apart
from symhyb.data.files.table import Column, Table, refusal
from symhyb.errors import InputError, Problem

Reader = Callable[[bytes, str], Table]


def reading(content: bytes, file: str) -> Table:
    values = np.frombuffer(content, float)
    problem = Problem("is no number: ‘x’\u001b", "b", file, 3)
    columns = (
        Column("laser [mm]", values),
        Column("b", np.array(np.nan), problem, part="run.1", inside="b [m]"),
        Column("none", np.zeros(0)),
    )
    return Table(file, columns, ("left out: größe",))


def refusing(content: bytes, file: str) -> Table:
    raise refusal(file, f"has {len(content)} bytes too many")


def crashing(content: bytes, file: str) -> Table:
    os.kill(os.getpid(), signal.SIGSEGV)
    return Table(file, ())


def raising(content: bytes, file: str) -> Table:
    raise RuntimeError("not foreseen")


def hungry(content: bytes, file: str) -> Table:
    return Table(file, (Column("x", np.ones(1 << 28)),))  # 2 GiB


def endless(content: bytes, file: str) -> Table:
    while True:
        pass


def talking(content: bytes, file: str) -> Table:
    print("something that a parser prints")
    return Table(file, (Column("x", np.ones(2)),))


def gone(content: bytes, file: str) -> Table:
    os._exit(0)


def test_a_table_comes_back_as_it_is() -> None:
    content = np.array([0.1, -np.inf, np.nan, 1e-320]).tobytes()
    here, there = reading(content, "a.mat"), read_apart(reading, content, "a.mat")
    assert (there.file, there.notes, there.names()) == (here.file, here.notes, here.names())
    for mine, other in zip(here.columns, there.columns, strict=True):
        np.testing.assert_array_equal(mine.values, other.values)
        assert mine.values.shape == other.values.shape
        assert (mine.problem, mine.part, mine.inside) == (other.problem, other.part, other.inside)


@pytest.mark.parametrize(
    ("reader", "said"),
    [
        (refusing, "a.mat: has 3 bytes too many"),
        (crashing, "a.mat: its reader ended by signal SIGSEGV: the file is damaged"),
        (raising, "a.mat: its reader ended with exit status 1: the file is damaged"),
        (hungry, "a.mat: needs more than the 1.5 GiB of memory that a file of its size gets"),
        (gone, "a.mat: its reader gave back what is no table: the file is damaged"),
    ],
)
def test_what_a_reader_breaks_is_one_sentence(
    reader: Reader, said: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(InputError) as caught:
        read_apart(reader, b"abc", "a.mat")
    assert str(caught.value).startswith(said)
    assert len(caught.value.problems) == 1
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(("seconds", "waits"), [(1, 60), (60, 0.05)], ids=["processor", "clock"])
def test_a_reader_without_end_is_ended(
    monkeypatch: pytest.MonkeyPatch, seconds: int, waits: float
) -> None:
    monkeypatch.setattr(apart, "READER_SECONDS", seconds)
    monkeypatch.setattr(apart, "READER_WAITS", waits)
    with pytest.raises(InputError, match=r"a\.mat: takes longer to read than the \d"):
        read_apart(endless, b"abc", "a.mat")


def test_a_module_beside_the_recording_is_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("numpy", "scipy", "json"):
        (tmp_path / f"{name}.py").write_text("open('code_ran_here', 'w').close()\n")
    monkeypatch.chdir(tmp_path)
    read_apart(talking, b"", "a.mat")
    assert not (tmp_path / "code_ran_here").exists()


def test_what_a_parser_prints_is_not_taken_for_the_table(tmp_path: Path) -> None:
    assert read_apart(talking, b"", "a.mat").columns[0].values.tolist() == [1.0, 1.0]
