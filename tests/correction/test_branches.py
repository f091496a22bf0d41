"""Further branches are tried at a place where there is one, and nowhere else."""

from types import SimpleNamespace
from typing import Any

import pytest

from symhyb.correction.search import branches
from symhyb.discrepancy.places.hypotheses import Hypothesis, families_of
from symhyb.model.types import On

X, Y = On("x"), On("y")


def branch(time_s: float, place: On = X) -> Hypothesis:
    shape = (("damping", time_s),)
    return Hypothesis(
        "relaxation", place, ("stiffness",), (True,), shape, ("damping",), tied=("damping",)
    )


DAMPER = Hypothesis("damper", X, ("damping",), (True,))
GAIN = Hypothesis("gain", None, ("value",), (False,), path="f.gain")
Offer = tuple[set[Any], dict[str, float]]


def offered(monkeypatch: pytest.MonkeyPatch, *causes: tuple[Hypothesis, Any]) -> list[Offer]:
    """The causes that are kept beside each new branch, and where that begins."""
    known = [cause for cause, _ in causes]
    monkeypatch.setattr(branches, "grouped", lambda _: [row for _, row in causes])

    def index(cause: Hypothesis) -> int:
        if cause not in known:
            known.append(cause)
        return known.index(cause)

    trials: Any = SimpleNamespace(causes=lambda _: tuple(range(len(causes))), index=index)
    base: Any = SimpleNamespace(causes=[cause for cause, _ in causes])
    return [
        ({known[i] for i in which[:-1]}, rows[-1])
        for which, rows in branches.branches_of(trials, base)
    ]


SLOW = branch(1.0), {"stiffness": 10.0, "damping": 5.0}
QUICK = branch(0.1), {"stiffness": 20.0, "damping": 0.2}


def time_of(row: dict[str, float]) -> float:
    return row["damping"] / row["stiffness"]


def test_a_faster_and_a_slower_one_are_tried_beside_a_branch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = offered(monkeypatch, SLOW)
    assert [kept for kept, _ in found] == [{SLOW[0]}] * 2
    assert [time_of(row) for _, row in found] == pytest.approx([0.5 / 6, 0.5 * 6])
    assert [row["stiffness"] for _, row in found] == pytest.approx([1.0, 1.0])


def test_between_two_that_are_far_apart_one_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    times = [time_of(row) for _, row in offered(monkeypatch, SLOW, QUICK)]
    assert times == pytest.approx([0.01 / 6, 3.0, (0.01 * 0.5) ** 0.5])


def test_a_faster_branch_comes_in_place_of_a_damper(monkeypatch: pytest.MonkeyPatch) -> None:
    faster, slower = offered(monkeypatch, (DAMPER, {"damping": 0.3}), SLOW)
    assert faster[0] == {SLOW[0]}
    assert faster[1]["damping"] == pytest.approx(0.3)
    assert slower[0] == {DAMPER, SLOW[0]}


def test_a_number_may_only_stand_for_a_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = [one for one, _ in offered(monkeypatch, SLOW, (GAIN, {"value": 1.01}))]
    assert kept == [{SLOW[0], GAIN}, {SLOW[0]}] * 2


def test_no_more_than_three_and_none_without_one(monkeypatch: pytest.MonkeyPatch) -> None:
    third = branch(9.0), {"stiffness": 1.0, "damping": 9.0}
    assert not offered(monkeypatch, SLOW, QUICK, third)
    assert not offered(monkeypatch, (DAMPER, {"damping": 0.3}))
    elsewhere = branch(9.0, Y), {"stiffness": 1.0, "damping": 9.0}
    assert len(offered(monkeypatch, SLOW, QUICK, elsewhere)) == 5


def test_two_branches_are_another_answer_than_one() -> None:
    assert families_of([SLOW[0], QUICK[0]]) != families_of([SLOW[0]])
    assert families_of([SLOW[0], DAMPER]) == families_of([DAMPER, QUICK[0]])
