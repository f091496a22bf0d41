"""Events as lines, and a log that a kill does not spoil."""

import json
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.monitoring.events import Amount, Event, Log

CHANGED = Event("changed", "It has.", 12.5, 11.0, "a gain", (Amount("g", 0.03, 0.001, "1"),))


def test_an_event_is_a_line_without_what_it_does_not_have() -> None:
    line = CHANGED.json()
    assert "\n" not in line
    assert json.loads(line) == {
        "kind": "changed",
        "sentence": "It has.",
        "at_s": 12.5,
        "since_s": 11.0,
        "cause": "a gain",
        "amounts": [{"name": "g", "value": 0.03, "sd": 0.001, "unit": "1"}],
    }


def test_a_number_that_is_not_finite_is_left_out() -> None:
    unknown = Event("named", "It has.", 1.0, amounts=(Amount("g", 0.03, float("inf"), "1"),))
    assert json.loads(unknown.json())["amounts"] == [{"name": "g", "value": 0.03, "unit": "1"}]


def test_a_log_grows_and_a_torn_line_stays_one_line(tmp_path: Path) -> None:
    file = tmp_path / "log.jsonl"
    with Log(file) as log:
        log.add(CHANGED)
    file.write_text(file.read_text() + '{"kind": "cha')
    with Log(file) as log:
        log.add(Event("ended", "End.", 20.0))
    first, torn, last = file.read_text().splitlines()
    assert json.loads(first)["kind"] == "changed"
    assert torn == '{"kind": "cha'
    assert json.loads(last)["kind"] == "ended"


def test_what_was_said_is_on_the_disk_before_the_log_is_closed(tmp_path: Path) -> None:
    file = tmp_path / "log.jsonl"
    with Log(file) as log:
        log.add(CHANGED)
        assert json.loads(file.read_text())["at_s"] == 12.5


def test_a_log_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError):
        Log(tmp_path / "none" / "log.jsonl")
