"""What else may be: each rival once, and with it what it holds beside what is exchanged."""

from symhyb.correction.naming.findings import alternatives_of, rivals_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from tests.correction.test_probability import DAMPER, DRAG, FRICTION, X, decided, trial
from tests.rigs import spring_model

PUSH = Hypothesis("constant", X, ("constant",), (False,))
SPRING = Hypothesis("spring", X, ("cubic",), (False,))


def test_a_rival_that_begins_at_other_values_is_one() -> None:
    steeper = Hypothesis("damper", X, ("damping",), (True,), (("transition", 1e-3),))
    chosen = decided(trial(FRICTION), trial(DAMPER, worse=5.0), trial(steeper, worse=3.0))
    ((change, evidence, _),) = rivals_of(chosen)
    assert change.fresh == (steeper,)
    assert 0.0 < evidence < 4.0


def test_what_is_found_stays_unsaid_beside_a_rival() -> None:
    """Dry friction is in both structures, so it is found, and only the other cause is open."""
    chosen = decided(trial(FRICTION, DAMPER), trial(FRICTION, DRAG))
    rows = alternatives_of(spring_model(), chosen, {FRICTION: "dry"})
    assert [(row.kind, row.together) for row in rows] == [("damper", 0), ("drag", 0)]


def test_parts_of_the_best_structure_that_are_in_doubt_hold_together() -> None:
    """Nothing is found: either the spring and the damper act, or the spring and the drag."""
    chosen = decided(trial(SPRING, DAMPER), trial(SPRING, DRAG))
    rows = alternatives_of(spring_model(), chosen, {}, doubt=[SPRING])
    assert [(row.kind, row.together) for row in rows] == [
        ("spring", 1),
        ("damper", 1),
        ("spring", 2),
        ("drag", 2),
    ]


def test_a_rival_of_several_laws_holds_with_all_of_them() -> None:
    chosen = decided(trial(DAMPER, worse=7.0), trial(PUSH, DRAG))
    rows = alternatives_of(spring_model(), chosen, {})
    assert [(row.kind, row.together) for row in rows] == [
        ("damper", 0),
        ("constant", 1),
        ("drag", 1),
    ]
