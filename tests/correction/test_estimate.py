"""A number that is not the same in both halves of the recordings, and what is still known of it."""

import numpy as np
import pytest
from builders import model_of, spring

from symhyb.correction.search.fleet import Outlier
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.verdict.estimate import drifted
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build

X = On("x")
MACHINE = build(
    model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (6.0, "N/m")},
        energy={"kinetic": "m*x'**2/2"},
        elements={"spring": spring("k")},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
)
DAMPER = Hypothesis("damper", X, ("damping",), (True,))
RIPPLE = Hypothesis(
    "ripple", X, ("sine", "cosine"), (False, False), (("period", 0.02),), ("period",)
)


def fitted(cause: Hypothesis, *values: float) -> Refined:
    """A cause with its numbers, each known to 1e-3 of it."""
    spread = np.diag((1e-3 * np.array(values)) ** 2)
    one = np.ones(1)
    fit = Fit(np.array(values), spread, one, 100 * one, one > 2, 1.0, ())
    paths = tuple(f"cause0.{key}" for key in cause.keys)
    return Refined((cause,), MACHINE, paths, MACHINE.values.copy(), fit)


def halves(key: str, first: float, second: float) -> Outlier:
    return Outlier(1, 0, key, (second, 1e-4), (first, 1e-4), 100.0, 0.0)


@pytest.mark.parametrize(("first", "second", "doubtful"), [(0.9, 1.1, False), (0.4, 1.6, True)])
def test_a_strength_that_changes_by_as_much_as_it_is_is_in_doubt(
    first: float, second: float, doubtful: bool
) -> None:
    final, doubt, (said,) = drifted(fitted(DAMPER, 1.0), halves("damping", first, second), False)
    assert doubt == ({DAMPER} if doubtful else frozenset())
    assert ("something else looks like it" in said) == doubtful
    deviation = np.sqrt(final.fit.covariance[0, 0])
    assert deviation == pytest.approx(1e-3 if doubtful else 0.1)


def test_a_period_that_may_be_anything_leaves_its_law_in_doubt() -> None:
    ripple = fitted(RIPPLE, 0.46, 0.3, 0.02)
    assert drifted(ripple, halves("period", -0.198, 0.0183), False)[1] == {RIPPLE}
    assert drifted(ripple, halves("period", 0.0199, 0.0201), False)[1] == frozenset()


def test_a_law_that_always_acts_alike_is_in_doubt_where_more_is_left() -> None:
    moved = halves("damping", 0.9, 1.1)
    assert drifted(fitted(DAMPER, 1.0), moved, True)[1] == frozenset()
    constant = Hypothesis("constant", X, ("constant",), (False,))
    moved = halves("constant", 0.9, 1.1)
    assert drifted(fitted(constant, 1.0), moved, False)[1] == frozenset()
    assert drifted(fitted(constant, 1.0), moved, True)[1] == {constant}


def test_what_does_not_drift_stays_as_it_is() -> None:
    final = fitted(DAMPER, 1.0)
    assert drifted(final, None, True) == (final, frozenset(), ())
