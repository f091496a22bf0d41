"""Bent laws are tried in place of several smooth laws of one speed, and of nothing else."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symhyb.correction.search import series
from symhyb.correction.search.selection import Problem, without
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On

X, Y = On("x"), On("y")


def law(kind: str, key: str, place: On = X, path: str = "") -> Hypothesis:
    return Hypothesis(kind, place, (key,), (False,), path=path)


DRAG, DAMPER, SPRING, FRICTION = (
    law("drag", "drag"),
    law("damper", "damping"),
    law("spring", "stiffness"),
    law("friction", "coulomb"),
)
ELSEWHERE = law("drag", "drag", Y)
CUBE, JUMP = (
    law("law", "coefficient", X, "x'**3"),
    law("law", "coefficient", X, "x*tanh(x'/transition)"),
)
WIDE = Hypothesis("friction", X, ("coulomb",), (True,), (("transition", 0.1),), ("transition",))
NUMBER = Hypothesis("parameter", None, ("value",), (True,), path="d")
BENT = Hypothesis("power", X, ("coefficient",), (True,), (("exponent", 1.5),), ("exponent",))
KNOWN = (DRAG, DAMPER, SPRING, FRICTION, ELSEWHERE, CUBE, JUMP, WIDE, NUMBER, BENT)
LAST = len(KNOWN) - 1


def problem() -> Problem:
    """One force of size 3 in the unit of the bent law, which cannot be chosen."""
    gram = np.eye(LAST + 2)
    gram[LAST, -1] = gram[-1, LAST] = 3.0
    gram[-1, -1] = 10.0
    open_to_all = Problem(
        gram,
        gram,
        KNOWN,
        tuple((i,) for i in range(LAST + 1)),
        (),
        np.zeros(LAST + 1),
        np.full(LAST + 1, -np.inf),
        np.full(LAST + 1, np.inf),
        np.zeros(LAST + 1),
    )
    return without(open_to_all, {LAST})


def offered(monkeypatch: pytest.MonkeyPatch, *causes: Hypothesis) -> list[tuple[Any, Any]]:
    rows = [{one.keys[0]: float(i + 1)} for i, one in enumerate(causes)]
    monkeypatch.setattr(series, "grouped", lambda _: rows)
    trials: Any = SimpleNamespace(
        known=list(KNOWN),
        equals=((KNOWN.index(NUMBER), KNOWN.index(DAMPER)),),
        setting=SimpleNamespace(hypotheses=KNOWN, bent=frozenset((LAST,))),
        causes=lambda trial: tuple(map(KNOWN.index, trial.causes)),
    )
    base: Any = SimpleNamespace(causes=causes)
    return list(series.instead_of_series(trials, base, problem()))


@pytest.mark.parametrize("pair", [(DRAG, DAMPER), (DRAG, CUBE), (DRAG, NUMBER)])
def test_two_smooth_laws_of_the_speed_may_be_one(
    pair: tuple[Hypothesis, Hypothesis], monkeypatch: pytest.MonkeyPatch
) -> None:
    ((causes, rows),) = offered(monkeypatch, pair[0], SPRING, pair[1])
    assert causes == (KNOWN.index(SPRING), LAST)
    assert rows == [{"stiffness": 2.0}, {"coefficient": 3.0, "exponent": 1.5}]


@pytest.mark.parametrize("other", [SPRING, FRICTION, ELSEWHERE, JUMP, WIDE])
def test_one_of_them_beside_something_else_stays(
    other: Hypothesis, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert offered(monkeypatch, DRAG, other) == []
