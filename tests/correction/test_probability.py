"""What the fitted structures have together: a cause that all good ones hold is certain, and rivals
share."""

import numpy as np
import pytest

from symhyb.correction.naming.findings import doubtful
from symhyb.correction.naming.probability import probabilities
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import PROBABLE
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build
from tests.rigs import spring_model

X = On("x")
FRICTION = Hypothesis("friction", X, ("coulomb",), (True,), (("transition", 1e-4),))
FINE = Hypothesis("friction", X, ("coulomb",), (True,), (("transition", 1e-3),))
DAMPER = Hypothesis("damper", X, ("damping",), (True,))
DRAG = Hypothesis("drag", X, ("drag",), (True,))
MACHINE = build(spring_model())
W, EACH = 12, 100


def trial(*causes: Hypothesis, worse: float = 0.0) -> Refined:
    """Causes that leave noise and so much χ² more."""
    size = len(causes)
    chi2 = np.full(W, EACH + worse / W)
    fit = Fit(
        np.ones(size), 1e-4 * np.eye(size), chi2, np.full(W, EACH), np.zeros(W, bool), 1.0, ()
    )
    paths = tuple(f"cause{i}.{key}" for i, one in enumerate(causes) for key in one.keys)
    return Refined(causes, MACHINE, paths, MACHINE.values, fit)


def decided(selected: Refined, *others: Refined) -> Decision:
    nothing = trial(worse=1e4)
    return Decision(selected, nothing, (nothing, selected, *others), (), ())


def test_a_cause_without_a_rival_is_certain() -> None:
    assert probabilities(decided(trial(FRICTION))) == pytest.approx((1.0,))


def test_a_rival_as_good_has_half_and_leaves_doubt() -> None:
    chosen = decided(trial(FRICTION), trial(DAMPER))
    assert probabilities(chosen) == pytest.approx((0.5,))
    assert doubtful(chosen) == (FRICTION,)


def test_several_rivals_share_what_each_alone_would_not_take() -> None:
    """At 7 each a rival has 3 %; three of them leave less than is asked for."""
    one = decided(trial(FRICTION), trial(DAMPER, worse=7.0))
    assert probabilities(one)[0] == pytest.approx(1 / (1 + np.exp(-3.5)), rel=1e-3)
    assert probabilities(one)[0] > PROBABLE
    many = (
        trial(cause, worse=7.0)
        for cause in (DAMPER, DRAG, Hypothesis("spring", X, ("stiffness",), (False,)))
    )
    assert probabilities(decided(trial(FRICTION), *many))[0] < PROBABLE


def test_a_cause_that_every_good_structure_holds_stays_certain() -> None:
    chosen = decided(trial(FRICTION, DAMPER), trial(FRICTION, DRAG))
    friction, damper = probabilities(chosen)
    assert friction == pytest.approx(1.0)
    assert damper == pytest.approx(0.5)


def test_another_shape_of_the_law_is_the_law() -> None:
    assert probabilities(decided(trial(FRICTION), trial(FINE))) == pytest.approx((1.0,))


def test_a_structure_that_could_not_be_compared_takes_no_share() -> None:
    chosen = decided(trial(FRICTION), trial(DAMPER, worse=np.inf))
    assert probabilities(chosen) == pytest.approx((1.0,))
