"""Beside a force without a name its parts have none either; what is no part keeps its own."""

from typing import Any

import numpy as np
import pytest

from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.correction.adequacy.unnamed import (
    changing_themselves,
    parts_of_bent,
    parts_of_class,
    parts_of_unnamed,
)
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.read import parse_model
from symhyb.model.types import On
from tests.builders import DRIVEN_MASS

X, Y = On("x"), On("y")


def law(kind: str, term: str, place: On = X) -> Hypothesis:
    return Hypothesis(kind, place, (term,), (False,))


SPRING, DAMPER, DRAG = law("spring", "stiffness"), law("damper", "damping"), law("drag", "drag")
CONSTANT, FRICTION = law("constant", "constant"), law("friction", "coulomb")
MASS, WAVE = law("added_mass", "mass"), law("harmonic", "cosine")
MAXWELL = law("relaxation", "stiffness")
NUMBER = Hypothesis("parameter", None, ("value",), (False,), path="k")
GAIN = Hypothesis("gain", None, ("value",), (False,), path="laser.gain")
KEPT = {FRICTION, MASS, WAVE, MAXWELL, law("damper", "damping", Y)}
EVERY = (SPRING, DAMPER, DRAG, CONSTANT, NUMBER, GAIN, *KEPT)


def curve(over: str) -> Hypothesis:
    points = tuple((x, x, 0.0) for x in (-1.0, 0.0, 1.0))
    return Hypothesis("curve", X, (), (), options=(("over", over),), points=points)


def empirical(formula: str) -> Hypothesis:
    return Hypothesis("law", X, ("coefficient",), (False,), path=formula)


def test_causes_stand_where_every_force_has_a_name() -> None:
    assert parts_of_unnamed(EVERY, False) == frozenset()


def test_beside_a_certain_class_numbers_may_be_parts_and_laws_stand() -> None:
    assert parts_of_unnamed(EVERY, True) == {NUMBER, GAIN}


@pytest.mark.parametrize(
    ("over", "laws"), [("stretch", {SPRING, CONSTANT}), ("rate", {DAMPER, DRAG, CONSTANT})]
)
def test_a_curve_holds_parts_over_its_own_quantity(over: str, laws: set[Hypothesis]) -> None:
    found = curve(over)
    assert parts_of_unnamed((*EVERY, found), False) == {*laws, NUMBER, GAIN}
    assert parts_of_unnamed((found, FRICTION), False) == frozenset()


@pytest.mark.parametrize("over", ["stretch", "rate"])
def test_beside_a_curve_a_bent_law_is_another_one(over: str) -> None:
    bent = [
        law(kind, key) for kind, key in (("damper_kinked", "damping"), ("power", "coefficient"))
    ]
    elsewhere = law("damper_kinked", "damping", Y)
    assert parts_of_unnamed((*bent, elsewhere), False) == frozenset()
    assert parts_of_unnamed((curve(over), *bent, elsewhere), False) == set(bent)


def test_beside_a_bent_law_a_number_of_its_quantity_at_its_place_has_no_value_of_its_own() -> None:
    model = parse_model(DRIVEN_MASS)  # a spring of k and a damper of d on x
    k, d = (Hypothesis("parameter", None, ("value",), (False,), path=name) for name in "kd")
    kinked, power = law("damper_kinked", "damping"), law("power", "coefficient")
    assert parts_of_bent(model, (k, d, GAIN, DRAG)) == frozenset()
    assert parts_of_bent(model, (k, d, GAIN, kinked)) == {d}
    assert parts_of_bent(model, (k, d, GAIN, power, FRICTION)) == {d}
    assert parts_of_bent(model, (k, d, law("damper_kinked", "damping", Y))) == frozenset()


@pytest.mark.parametrize(
    ("generic", "probability", "parts"),
    [
        (Generic("hidden mode", X, (), np.zeros(0)), 0.98, {"k", "d"}),
        (Generic("hidden mode", X, (), np.zeros(0)), 0.3, set()),
        (Generic("hidden mode", Y, (), np.zeros(0)), 0.98, set()),
        (Generic("law", X, (), np.zeros(0)), 0.98, {"k", "d"}),
        (Generic("law", X, (), np.zeros(0), over="rate"), 0.98, {"d"}),
        (Generic("lag", "f", (), np.zeros(0)), 0.98, set()),
    ],
)
def test_beside_a_class_a_number_at_its_place_has_no_value_of_its_own(
    generic: Generic, probability: float, parts: set[str]
) -> None:
    """Also where the class explains no more than the better part of what acts."""
    model = parse_model(DRIVEN_MASS)  # a spring of k and a damper of d on x
    k, d = (Hypothesis("parameter", None, ("value",), (False,), path=name) for name in "kd")
    found = parts_of_class(model, (k, d, GAIN, DRAG), [Likely(generic, probability, whole=False)])
    assert {one.path for one in found} == parts


def test_an_empirical_law_alone_stands_and_beside_its_parts_is_one() -> None:
    cubic, mixed = empirical("x'**3"), empirical("x**2*x'")
    assert parts_of_unnamed((cubic, SPRING, FRICTION), False) == frozenset()
    assert parts_of_unnamed((cubic, DRAG, SPRING), False) == {cubic, DRAG}
    assert parts_of_unnamed((cubic, NUMBER), False) == {cubic, NUMBER}
    assert parts_of_unnamed((mixed, DRAG, SPRING), False) == {mixed, DRAG, SPRING}


@pytest.mark.parametrize(
    ("kind", "where", "does", "gone"),
    [
        ("sensor", "laser", "fades", {GAIN}),
        ("input", "laser", "fades", {GAIN}),
        ("time-varying", "k", "", {NUMBER}),
        ("sensor", "laser", "drifts", set()),  # of its offset, not of its gain
        ("sensor", "laser", "bends", set()),
        ("input", "f", "fades", set()),
    ],
)
def test_a_number_that_a_class_says_to_change_has_no_one_value(
    kind: Any, where: str, does: Any, gone: set[Hypothesis]
) -> None:
    one = Generic(kind, where, (), np.zeros(0), does=does)
    assert changing_themselves(EVERY, [one]) == gone
    assert changing_themselves(EVERY, []) == frozenset()
