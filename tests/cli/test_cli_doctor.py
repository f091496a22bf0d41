"""``symhyb doctor`` as a person calls it, and what it says where something is amiss."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from command import Call

from symhyb.console import doctor
from symhyb.console.doctor import EXTRAS, LIBRARIES, Finding, healthy, tried
from symhyb.numeric.kernels.compiled import find_compiler

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_a_working_installation_is_in_order(symhyb: Call) -> None:
    done = symhyb("doctor", "--json")
    assert done.status == 0, done.out
    facts = json.loads(done.out)
    found = {one["name"]: one for one in facts["findings"]}
    assert facts["ok"] is True
    assert found["symhyb"]["text"].startswith(PROJECT["version"])
    assert "comes back as" in found["self-test"]["text"]
    assert {*EXTRAS, "compiler", "cache", "processors", "libraries"} <= found.keys()


def test_a_broken_self_test_ends_with_status_1(
    symhyb: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails() -> str:
        raise ArithmeticError("a simulation is off")

    monkeypatch.setattr(doctor, "self_test", fails)
    done = symhyb("doctor")
    assert done.status == 1
    assert re.search(r"BROKEN +self-test +failed: ArithmeticError: a simulation is off", done.out)


def test_what_is_lacking_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a compiler and an extra it works, and says what that costs and what to do."""
    monkeypatch.setenv("SYMHYB_CC", "")
    find_compiler.cache_clear()
    try:
        lacking = doctor._compiler()
    finally:
        monkeypatch.undo()
        find_compiler.cache_clear()
    assert lacking.good is None
    assert "several times as long" in lacking.text
    monkeypatch.setitem(EXTRAS, "excel", ("Excel files", ("no_such_module",)))
    missing = doctor._extra("excel")
    assert (missing.good, missing.cure) == (None, 'pip install "symhyb[excel]"')
    assert healthy([lacking, missing])
    assert not healthy([Finding("a", "b", False)])


def test_the_time_of_the_self_test_is_said() -> None:
    assert re.fullmatch(r"fine \(\d+\.\d s\)", tried(lambda: "fine").text)


def test_extras_and_libraries_are_those_of_the_project() -> None:
    own = {"formats", "test", "dev", "hosts", "masters"}  # of others, or for tests
    assert set(EXTRAS) == set(PROJECT["optional-dependencies"]) - own
    needed = {re.split(r"[>=]", one)[0] for one in PROJECT["dependencies"]}
    assert set(LIBRARIES) <= needed
