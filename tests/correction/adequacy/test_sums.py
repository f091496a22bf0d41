"""Laws of one quantity that have a shape together are held against a smooth function of it."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.adequacy.sums import functions_instead, is_sum, of_one, sums_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On, Place
from tests.pushed import decided, resisted

X, Y = On("x"), On("y")


def law(kind: str, *terms: str, place: Place = X) -> Hypothesis:
    return Hypothesis(kind, place, terms, (False,) * len(terms))


STIFF, QUADRATIC, CUBIC = (law("spring", key) for key in ("stiffness", "quadratic", "cubic"))
RIPPLE = law("ripple", "amplitude", "phase", "period")
STOP = law("gap", "stiffness", "clearance")
DAMPER, DRAG, FRICTION = law("damper", "damping"), law("drag", "drag"), law("friction", "coulomb")
KINKED, CONSTANT = law("damper_kinked", "damping", "knee"), law("constant", "constant")
NUMBER = Hypothesis("parameter", None, ("value",), (True,), path="k")
REMEMBERS, CARRIED = law("hysteresis", "stiffness", "beta"), law("added_mass", "mass")
WAVE, LEAKY = (
    law("harmonic", "amplitude", "phase", "frequency"),
    law("gap", "stiffness", "clearance", "damping"),
)


def found(*causes: Hypothesis) -> list[tuple[str, set[Hypothesis]]]:
    return [(one.over, set(one.laws)) for one in sums_of(causes)]


def test_laws_with_two_numbers_of_one_quantity_have_a_shape() -> None:
    assert found(STIFF, CUBIC) == [("stretch", {STIFF, CUBIC})]
    assert found(NUMBER, DAMPER, DRAG) == [("rate", {DAMPER, DRAG})]
    assert found(KINKED) == [("rate", {KINKED})]
    assert found(STIFF, CUBIC, DAMPER, DRAG) == [
        ("stretch", {STIFF, CUBIC}),
        ("rate", {DAMPER, DRAG}),
    ]
    assert is_sum([KINKED])
    assert not is_sum([CUBIC])


@pytest.mark.parametrize("causes", [(CUBIC,), (CUBIC, DAMPER), (NUMBER, CUBIC), (DAMPER, CONSTANT)])
def test_one_number_of_each_quantity_has_none(causes: tuple[Hypothesis, ...]) -> None:
    assert found(*causes) == []


@pytest.mark.parametrize(
    "more", [REMEMBERS, CARRIED, LEAKY, WAVE, law("spring", "quadratic", place=Y)]
)
def test_what_is_no_function_of_that_quantity_there_is_no_part(more: Hypothesis) -> None:
    assert not of_one(more, X, "stretch")
    assert found(CUBIC, more) == []


def test_what_jumps_may_stay_and_may_go() -> None:
    assert found(FRICTION, DAMPER, DRAG) == [
        ("rate", {DAMPER, DRAG}),
        ("rate", {FRICTION, DAMPER, DRAG}),
    ]
    assert found(FRICTION, DAMPER) == []
    assert found(STOP) == []


def test_a_constant_goes_with_the_shape_that_it_is_beside() -> None:
    assert found(STIFF, CUBIC, CONSTANT) == [("stretch", {STIFF, CUBIC, CONSTANT})]
    assert found(FRICTION, DAMPER, CONSTANT) == []


def test_what_each_recording_has_of_its_own_is_no_part() -> None:
    own = replace(CUBIC, own=("cubic",))
    assert found(STIFF, own) == []


def saturates(x: float, v: float) -> float:
    return float(2.0 * np.tanh(x / 0.15))


def hardens(x: float, v: float) -> float:
    return 4.0 * x + 30.0 * x**3


def test_a_function_is_likelier_than_laws_that_only_follow_it() -> None:
    rows = {"stiffness": 8.0}, {"cubic": -20.0}
    ground, base = decided(
        resisted(2, saturates), ("spring", "stiffness"), ("spring", "cubic"), rows=rows
    )
    (instead,) = functions_instead(ground, base)
    assert instead.causes == ()
    assert instead.extra is not None
    assert instead.extra.over == "stretch"
    assert instead.evidence > base.evidence + 5


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_laws_that_act_are_likelier_than_any_function(seed: int) -> None:
    rows = {"stiffness": 4.0}, {"cubic": 30.0}
    ground, base = decided(
        resisted(seed, hardens), ("spring", "stiffness"), ("spring", "cubic"), rows=rows
    )
    assert all(one.evidence < base.evidence - 5 for one in functions_instead(ground, base))
