r"""A hidden mode that is a mass on a spring and a damper at its place becomes a law; others do not.

wall |--/\/\/--[1 kg]--▶ x ──/\/\/──[m_h]
"""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.signal import lsim

from symhyb.correction.adequacy.beyond import NOTHING
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.named_mode import modes_instead
from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.correction.search.trajectory import grouped
from symhyb.correction.verdict.in_place_of_class import holds, one_value
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import ClassName
from symhyb.model.types import On
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, judged, pushing

Mode = tuple[float, float, float]
"""Mass, kg, frequency, Hz, and damping ratio."""
PLACE = On("x")


def ridden(modes: Sequence[Mode], seed: int, link: bool = False, samples: int = 1000) -> Recording:
    """The pushed mass with modes; with a ``link`` the push acts on the first hidden mass instead.
    By SciPy, linear, first-order hold between samples."""
    n = 1 + len(modes)
    mass, stiffness, damping = np.eye(n), np.zeros((n, n)), np.zeros((n, n))
    stiffness[0, 0], damping[0, 0] = STIFFNESS, DAMPING
    for i, (m, line, ratio) in enumerate(modes, 1):
        pace, apart = 2 * np.pi * line, np.zeros(n)
        apart[[0, i]] = 1, -1
        mass[i, i] = m
        stiffness += m * pace**2 * np.outer(apart, apart)
        damping += 2 * ratio * m * pace * np.outer(apart, apart)
    push = np.eye(n)[:, [1 if link else 0]]
    inverse = np.linalg.inv(mass)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    B = np.concatenate([np.zeros((n, 1)), inverse @ push])
    t = STEP * np.arange(samples)
    force = pushing(np.random.default_rng(seed), t)
    _, x, _ = lsim((A, B, np.eye(1, 2 * n), np.zeros((1, 1))), force, t)
    seen = x + NOISE * np.random.default_rng(900 + seed).standard_normal(samples)
    return Recording("made.csv", t, {"f": force}, {"laser": seen}, (), "")


def test_a_mass_on_a_spring_becomes_a_mode_with_its_numbers() -> None:
    true = 0.15, 2.9, 0.05
    ground, found = judged(ridden([true], 3))
    assert found.certain("hidden mode") == PLACE
    answer = modes_instead(ground, found)
    assert answer is not None
    (mode,) = answer.causes
    assert (mode.kind, mode.place) == ("mode", PLACE)
    deviations = np.sqrt(np.diag(answer.fit.covariance))[:3]
    assert np.all(np.abs(answer.fit.values[:3] - true) < 3.5 * deviations)
    assert np.all(deviations < 0.2 * np.array(true))
    assert answer.evidence > found.by_class.evidence  # type: ignore[union-attr]


@pytest.mark.slow
def test_of_two_masses_each_is_a_mode() -> None:
    true = [(0.3, 1.1, 0.03), (0.1, 2.9, 0.03)]
    ground, found = judged(ridden(true, 5))
    answer = modes_instead(ground, found)
    assert answer is not None
    rows = sorted(grouped(answer), key=lambda row: row["frequency"])
    assert [cause.kind for cause in answer.causes] == ["mode", "mode"]
    for row, (mass, line, ratio) in zip(rows, true, strict=True):
        assert row["frequency"] == pytest.approx(line, rel=0.02)
        assert row["mass"] == pytest.approx(mass, rel=0.1)
        assert row["damping_ratio"] == pytest.approx(ratio, rel=0.3)


@pytest.mark.slow
def test_what_the_push_reaches_through_a_spring_is_no_mode_at_the_place() -> None:
    ground, found = judged(ridden([(0.5, 2.5, 0.03)], 7, link=True))
    assert modes_instead(ground, found) is None


def test_where_nothing_acts_there_is_no_mode() -> None:
    ground, found = judged(ridden([], 9))
    assert found.certain("hidden mode") is None
    assert modes_instead(ground, found) is None


@pytest.mark.parametrize(("line", "same"), [(2.92, True), (2.99, False)])
def test_windows_and_innovations_must_give_one_value(line: float, same: bool) -> None:
    shape = (("frequency", 2.9), ("damping_ratio", 0.05))
    mode = Hypothesis("mode", PLACE, ("mass",), (True,), shape, ("frequency", "damping_ratio"))

    def fitted(line: float) -> Any:
        spread = np.diag([0.01, 0.02, 0.01]) ** 2
        return SimpleNamespace(
            causes=(mode,),
            fit=SimpleNamespace(values=np.array([0.2, line, 0.05]), covariance=spread),
        )

    assert one_value(fitted(2.9), fitted(line)) == same
    assert not one_value(fitted(2.9), None)


def likely(kind: ClassName, probability: float = 0.99, whole: bool = True) -> Adequacy:
    generic = Generic(kind, PLACE, (), np.ones(1))
    return Adequacy(NOTHING, (Likely(generic, probability, whole),))


def test_only_a_hidden_mode_that_is_certain_is_asked_for_one() -> None:
    assert likely("hidden mode").certain("hidden mode") == PLACE
    assert likely("hidden mode", probability=0.9).certain("hidden mode") is None
    assert likely("hidden mode", whole=False).certain("hidden mode") is None
    assert likely("law").certain("hidden mode") is None
    assert Adequacy(NOTHING).certain("hidden mode") is None


def test_a_choice_with_a_mode_holds_where_the_class_is_gone() -> None:
    shape = (("frequency", 2.9), ("damping_ratio", 0.05))
    mode = Hypothesis("mode", PLACE, ("mass",), (True,), shape, ("frequency", "damping_ratio"))
    choice: Any = SimpleNamespace(
        decision=SimpleNamespace(selected=SimpleNamespace(causes=(mode,)))
    )
    before = likely("hidden mode")
    assert holds(choice, Adequacy(NOTHING), before)
    assert not holds(choice, before, before)
    assert not holds(choice, Adequacy(NOTHING, doubt=frozenset({mode})), before)
