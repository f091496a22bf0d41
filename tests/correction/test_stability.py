"""The Bayesian bootstrap of windows: evidence that many windows share stays, that of one does not
outweigh all others."""

import numpy as np
import pytest

from symhyb.correction.naming.stability import stabilities, weakest
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build
from tests.rigs import spring_model

X = On("x")
FRICTION = Hypothesis("friction", X, ("coulomb",), (True,), (("transition", 1e-4),))
DAMPER = Hypothesis("damper", X, ("damping",), (True,))
MACHINE = build(spring_model())
W = 18


def trial(cause: Hypothesis | None, chi2: np.ndarray) -> Refined:
    causes = () if cause is None else (cause,)
    size = len(causes)
    fit = Fit(
        np.ones(size), 1e-4 * np.eye(size), chi2, np.full(W, 100), np.arange(W) % 3 == 2, 1.0, ()
    )
    paths = tuple(f"cause0.{key}" for one in causes for key in one.keys)
    return Refined(causes, MACHINE, paths, MACHINE.values, fit)


def decision(rival: np.ndarray, nothing: np.ndarray | None = None) -> Decision:
    """Friction that leaves noise, against a damper and the bare model by window."""
    bare = trial(None, np.full(W, 400.0) if nothing is None else nothing)
    selected, other = trial(FRICTION, np.full(W, 100.0)), trial(DAMPER, rival)
    return Decision(selected, bare, (bare, selected, other), (), ())


def test_evidence_of_all_windows_is_stable() -> None:
    chosen = decision(np.full(W, 103.0))
    assert stabilities(chosen) == (1.0,)


def test_evidence_of_one_window_against_all_others_is_doubt() -> None:
    rival = np.full(W, 98.0)
    rival[4] += 60.0
    (share,) = stabilities(decision(rival))
    assert share is not None
    assert 0.2 < share < 0.8


def test_an_effect_that_few_windows_show_is_not_lost_by_the_draw() -> None:
    nothing = np.full(W, 100.0)
    nothing[:2] = 5000.0
    (share,) = stabilities(decision(np.full(W, 300.0), nothing))
    assert share == pytest.approx(1.0, abs=0.01)


def test_the_weakest_cause_speaks_for_an_effect() -> None:
    assert weakest({FRICTION: 0.99, DAMPER: 0.93}, (FRICTION, DAMPER)) == 0.93
    assert weakest({FRICTION: None}, (FRICTION,)) is None
