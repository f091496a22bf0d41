"""What is left of a fault of symhyb itself can be sent: it says where, and nothing of the data."""

import os
from pathlib import Path

import pytest

from symhyb.fault import NAME, fault_text, leave_fault


def caught() -> Exception:
    try:
        try:
            [][3]
        except IndexError as error:
            raise ValueError(
                "column 'secret [mm]' of /data/me/rig.csv holds 3.25 and -1e-5\n\x1b[2J"
            ) from error
    except ValueError as error:
        error.add_note("while fitting the last values")
        error.add_note("a note of another library with 17")
        return error


def test_it_says_where_and_what_was_being_done() -> None:
    text = fault_text(caught())
    assert "versions: Python 3." in text
    assert "casadi 3." in text
    assert "\nwhile fitting the last values\n" in text
    assert "ValueError: column … of … holds # and #" in text
    assert "IndexError: list index out of range" in text
    assert "test_fault.py:16 in caught" in text


@pytest.mark.parametrize("part", ["secret", "/data", "rig.csv", "3.25", "1e-5", "\x1b", "17"])
def test_it_holds_nothing_of_the_data(part: str) -> None:
    assert part not in fault_text(caught()).split("while fitting")[1]


def test_it_is_left_where_it_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, spare = tmp_path / "here", tmp_path / "spare"
    here.mkdir()
    spare.mkdir()
    monkeypatch.chdir(here)
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(spare))
    assert leave_fault(caught()) == str(here / NAME)
    (here / NAME).unlink()
    (here / NAME).mkdir()  # nothing can be written there
    assert leave_fault(caught()) == str(spare / NAME)
    (spare / NAME).unlink()
    (spare / NAME).mkdir()
    assert leave_fault(caught()) == ""
    assert os.listdir(here) == [NAME]
