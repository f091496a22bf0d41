"""What the model has at a place, and what a cause there adds to."""

from dataclasses import replace

from builders import damper, oscillator, spring

from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import quantities_of
from symhyb.discrepancy.places.standing import alike, taken_over
from symhyb.model.types import On

X = On("x")
D = {"d": (1.5, "N*s/m")}
SIDED = Hypothesis("damper", X, ("damping", "skew"), (True, False))


def test_what_stands_at_a_place_is_of_the_same_kind_there() -> None:
    model = oscillator({"hold": spring("k"), "oil": damper("d")}, {"k": (9.0, "N/m")} | D)
    assert [one.name for one in alike(model, "damper", X)] == ["oil"]
    assert alike(model, "damper", On("2*x")) == ()
    assert alike(model, "friction", X) == ()


def test_friction_is_a_function_of_the_stretch_where_it_has_a_slope() -> None:
    assert quantities_of("friction", ("coulomb", "transition")) == {"rate"}
    assert quantities_of("friction", ("coulomb", "slope", "transition")) == {"rate", "stretch"}


def test_a_cause_takes_over_the_parameters_of_the_keys_that_both_have() -> None:
    model = oscillator({"hold": spring("k"), "oil": damper("2*d")}, {"k": (9.0, "N/m")} | D)
    assert taken_over(model, SIDED) == {"d"}
    cubic = Hypothesis("spring", X, ("cubic",), (False,))
    assert taken_over(model, cubic) == frozenset()
    plain = Hypothesis("damper", X, ("damping",), (True,))
    assert taken_over(model, plain) == frozenset()  # it is what d may be
    assert taken_over(model, replace(SIDED, place=On("2*x"))) == frozenset()


def test_a_parameter_of_an_element_is_meant_by_its_path() -> None:
    own = {**damper("d"), "parameters": {"d": {"value": 1.5, "unit": "N*s/m"}}}
    assert taken_over(oscillator({"oil": own}), SIDED) == {"oil.d"}
