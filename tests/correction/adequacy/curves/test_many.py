"""More laws of one quantity at one place than may stand for a curve, and which count."""

import pytest

from symhyb.correction.adequacy.curves.answer import many_of_one
from symhyb.correction.adequacy.curves.courses import Form
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On, Place

X, Y = On("x"), On("y")


def law(kind: str, *terms: str, place: Place = X) -> Hypothesis:
    return Hypothesis(kind, place, terms, (False,) * len(terms))


SPRINGS = [law("spring", key) for key in ("stiffness", "quadratic", "cubic")]
STOP, RIPPLE = law("gap", "stiffness", "clearance"), law("ripple", "amplitude", "phase", "period")
LOSSES = [law("damper", "damping"), law("drag", "drag"), law("friction", "coulomb")]
REMEMBERS, CARRIED = law("hysteresis", "stiffness", "beta"), law("added_mass", "mass")
NUMBER = Hypothesis("parameter", None, ("value",), (True,), path="k")


def test_four_laws_of_the_stretch_at_one_place_are_many() -> None:
    assert many_of_one([NUMBER, *SPRINGS, STOP]) == (X, Form("stretch"))
    assert many_of_one([*SPRINGS, RIPPLE, *LOSSES]) == (X, Form("stretch"))


def test_so_are_four_of_the_rate() -> None:
    cube = Hypothesis("law", X, ("coefficient",), (False,), path="x'**3")
    assert many_of_one([*LOSSES, cube]) == (X, Form("rate"))


@pytest.mark.parametrize(
    "more",
    [
        LOSSES[0],
        REMEMBERS,
        CARRIED,
        law("gap", "stiffness", "clearance", "damping"),
        law("ripple", "amplitude", "phase", "period", place=Y),
        law("harmonic", "amplitude", "phase", "frequency"),
    ],
)
def test_what_is_no_function_of_that_quantity_there_does_not_count(more: Hypothesis) -> None:
    assert many_of_one([*SPRINGS, more]) is None
