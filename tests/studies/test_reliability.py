"""The fuzzing of readers: inputs follow from their number, every sort of failure is seen."""

import json
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from symhyb.errors import InputError, Problem
from tests.scripts import scripts

NAMES = ("grammar", "mutate", "readers", "fuzz", "supply")
QUICK = ("unit", "expression", "model", "machine", "study", "expected", "weights", "csv", "json")
Study = Mapping[str, ModuleType]


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The scripts as modules."""
    with scripts("reliability", NAMES) as found:
        yield found


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What readers leave in a cache is not kept."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def reader(study: Study, name: str) -> Any:
    return next(one for one in study["readers"].readers() if one.name == name)


def worked(study: Study, reader: Any, count: int, folder: Path) -> tuple[list[str], int, int]:
    """Failures, and how many inputs were read and refused, without a process of its own."""
    fuzz = study["fuzz"]
    state, log = folder / "state", folder / "failures"
    state.write_bytes(fuzz._STATE.pack(0, 0, 0))
    log.write_text("")
    fuzz.work(reader, 0, count, state)
    number, accepted, refused = fuzz._STATE.unpack(state.read_bytes())
    assert number == count
    rows = [json.loads(line) for line in log.read_text().splitlines()]
    return [f"{row['number']}: {row['what']}" for row in rows], accepted, refused


@pytest.mark.parametrize("name", QUICK)
def test_inputs_that_hurt_end_in_sentences(study: Study, tmp_path: Path, name: str) -> None:
    failures, accepted, refused = worked(study, reader(study, name), 150, tmp_path)
    assert failures == []
    assert accepted > 0
    assert refused > 0


@pytest.mark.parametrize("name", ["model", "unit", "csv", "mat"])
def test_an_input_follows_from_its_number(study: Study, name: str) -> None:
    one, an_input = reader(study, name), study["readers"].an_input
    first, again = ([an_input(one, number) for number in range(20)] for _ in range(2))
    assert first == again
    assert len(set(first)) > 10


def planted(study: Study, take: Any) -> Any:
    return replace(reader(study, "unit"), take=take)


def test_every_sort_of_failure_is_seen(study: Study, tmp_path: Path) -> None:
    def refuse(text: str) -> Any:
        def take(data: bytes) -> None:
            raise InputError(Problem(text) if text else ())

        return take

    def fail(data: bytes) -> None:
        raise KeyError("k")

    ends = {"": "says nothing", "a\n": "", "b" * 99: ""}
    for text, said in ends.items():
        failures, _, refused = worked(study, planted(study, refuse(text)), 1, tmp_path)
        assert [said in one for one in failures] == [True] * bool(said)
        assert refused == 1
    (failure,), _, _ = worked(study, planted(study, fail), 1, tmp_path)
    assert failure.startswith("0: KeyError 'k'")
    unclear = study["fuzz"]._unclear
    assert "control characters" in unclear(ValueError("a\x1b[31m"))
    assert "control characters" in unclear(ValueError("a\u202eb"))
    assert "a sentence of 3000 letters" in unclear(ValueError("a" * 3000))


def test_an_input_that_takes_too_long_is_seen(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study["fuzz"], "SECONDS", 1)
    (failure,), _, _ = worked(study, planted(study, lambda data: time.sleep(30)), 1, tmp_path)
    assert failure.startswith("0: more than 1 s")


def test_a_worker_that_ends_is_started_again_behind_the_input(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A crash of a native reader is contained, of any other it is a failure."""
    fuzz = study["fuzz"]
    ends = iter(["ended by SIGSEGV", ""] * 2)

    def watched(name: str, first: int, last: int, state: Path, scratch: str) -> str:
        end = next(ends)
        number = first + 2 if end else last
        state.write_bytes(fuzz._STATE.pack(number, 1, number - first - 1))
        return end

    monkeypatch.setattr(fuzz, "_watched", watched)
    total = fuzz.supervised(reader(study, "mat"), 0, 10, tmp_path)
    assert (total["accepted"], total["refused"], total["contained"]) == (2, 7, 1)
    assert total["failures"] == []
    total = fuzz.supervised(reader(study, "csv"), 0, 10, tmp_path)
    assert [one["number"] for one in total["failures"]] == [2]
    assert (tmp_path / "failures" / "csv-2").exists()


@pytest.mark.slow
def test_a_run_goes_on_where_it_was_and_writes_its_table(study: Study, tmp_path: Path) -> None:
    fuzz, unit = study["fuzz"], reader(study, "unit")
    assert fuzz.run(unit, 20, 1, tmp_path)["inputs"] == 20
    again = fuzz.run(unit, 40, 2, tmp_path)
    assert again["accepted"] + again["refused"] == again["inputs"] == 40
    assert "| unit | 40 | " in fuzz.table(tmp_path, ["unit", "model"])
    assert fuzz.line_of(again).startswith("unit: 40 inputs")


def test_every_package_is_pinned_and_of_an_accepted_licence(study: Study) -> None:
    supply = study["supply"]
    packages = supply.installed("symhyb", frozenset(["formats", "fmi", "urdf"]))
    assert {"casadi", "numpy", "sympy", "pysindy", "scikit-learn", "h5py"} <= packages.keys()
    assert list(supply.complaints(packages, supply.pinned())) == []


def test_what_is_wrong_with_a_package_is_said(study: Study) -> None:
    supply = study["supply"]
    packages = supply.installed("symhyb", frozenset())
    one = {"numpy": packages["numpy"]}
    assert next(supply.complaints(one, {})).startswith("numpy ")
    assert "pinned is 0.1" in next(supply.complaints(one, {"numpy": "0.1"}))
