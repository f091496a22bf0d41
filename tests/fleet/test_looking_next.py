"""What is worth looking at next, in order and with its reason."""

from pathlib import Path

import numpy as np
import pytest
from fleets import write_fits

from symhyb.fleet.looking_next import worth_looking
from symhyb.tasks.folder import Entry, Listed
from symhyb.tasks.outcome import FAILED, FINISHED, NOT_RUN, Number, Outcome, Outcomes, read_outcomes

COVARIANCE = np.diag([0.5, 0.01, 0.0005]) ** 2


def test_of_a_fleet_those_that_deviate_come_before_what_is_not_run(tmp_path: Path) -> None:
    chance = np.random.default_rng(0)
    values = np.array([100.0, 2.0, 1.0]) + np.array([2.0, 0.05, 0.003]) * chance.standard_normal(
        (43, 3)
    )
    values[8, 0] += 40
    left = np.ones(43)
    left[9] = 6.0
    groups = [{"warm": str(20 + i % 5)} for i in range(40)]
    groups += [{"warm": "23.4"}, {"warm": "60"}, {"warm": "58"}]
    states = {39: "no such column", 40: "", 41: "", 42: ""}
    folder = write_fits(tmp_path, values, COVARIANCE, groups, left, states)
    found = worth_looking(read_outcomes(folder), "", ["warm"])
    assert [(one.why, one.unit) for one in found] == [
        ("structure", "r9.csv"),
        ("numbers", "r8.csv"),
        ("failed", "r39.csv"),
        ("not run", "r41.csv"),
        ("not run", "r42.csv"),  # at 58, two from the one before it; the other is at 23.4
        ("not run", "r40.csv"),
    ]
    assert "no such column" in found[2].sentence
    assert "warm 60" in found[3].sentence
    assert found[1].recordings == ("r8.csv",)


def diagnosed(name: str, verdict: str, *causes: str) -> Outcome:
    entry = Entry(name, (("recordings", name),), "0" * 64, (Listed(name, (("unit", name),)),))
    found = {cause: Number(1.0, 0.1, "N") for cause in causes}
    return Outcome(entry, FINISHED, verdict=verdict, found=found, classes={"x.memory": 0.7})


def test_of_diagnoses_the_undecided_and_the_unusual_are_listed() -> None:
    tasks = [diagnosed(f"a{i}", "missing physics", "x.coulomb") for i in range(4)]
    tasks += [diagnosed("b", "undecided"), diagnosed("c", "missing physics", "x.drag")]
    waiting = Entry("d", (("recordings", "d"),), "1" * 64, (Listed("d", (("unit", "d"),)),))
    failed = Entry("e", (("recordings", "e"),), "2" * 64, (Listed("e", (("unit", "e"),)),))
    tasks += [Outcome(waiting, NOT_RUN), Outcome(failed, FAILED, "unreadable")]
    found = worth_looking(Outcomes("", tuple(tasks)), "unit")
    assert [(one.unit, one.why) for one in found] == [
        ("b", "undecided"),
        ("c", "other cause"),
        ("e", "failed"),
        ("d", "not run"),
    ]
    assert "likeliest is x.memory, 0.7" in found[0].sentence
    assert "finds x.drag, as 1 of 5 do; most find x.coulomb" in found[1].sentence


@pytest.mark.parametrize("unit", ["", "unit"])
def test_where_nothing_stands_out_nothing_is_listed(unit: str) -> None:
    tasks = tuple(diagnosed(f"a{i}", "missing physics", "x.coulomb") for i in range(3))
    assert worth_looking(Outcomes("", tasks), unit) == ()
