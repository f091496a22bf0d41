"""A curve on trial is the element that it becomes."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.naming.curve_points import curve_element, value_estimates
from symhyb.correction.naming.findings import Named, found_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import value_name
from symhyb.model.types import On, Place
from symhyb.model.vocabulary import Words
from symhyb.model.write import append_elements
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from tests.pushed import pushed_model

POINTS = ((-2.0, -1.5, 0.01), (-0.5, -1.0, 0.0), (0.1, 0.2, 0.03), (1.5, 2.0, 0.0))
X, Y, SHIFT = zip(*POINTS, strict=True)
FITTED = [(y, 0.04) for y in Y]
PLACE: Place = On("x")
STRETCH: Words = (("over", "stretch"),)
RATE: Words = (("over", "rate"),)
DAMPING: Words = (*STRETCH, ("times", "rate"))
DRAG: Words = (*STRETCH, ("times", "square"))


def on_trial(options: Words, place: Place = PLACE) -> Hypothesis:
    return Hypothesis(
        "curve",
        place,
        tuple(map(value_name, range(len(POINTS)))),
        (False,) * len(POINTS),
        options=options,
        points=POINTS,
    )


@pytest.mark.parametrize("options", [STRETCH, RATE, DAMPING, DRAG])
def test_it_acts_as_the_curve_that_is_written(options: Words) -> None:
    model, trial = pushed_model(), on_trial(options)
    values = dict(zip(trial.terms, Y, strict=True))
    tried = build(replace(model, elements=(*model.elements, trial.element(model, "c", values))))
    estimates = value_estimates(model, On("x"), options, X, FITTED)
    element = curve_element(model, "c", On("x"), options, estimates, None, (("by", "sparse"),))
    written = build(append_elements(model, [element]))
    for x in np.linspace(-3, 3, 13):
        q, v, u, z = np.array([0.3]), np.array([0.4]), np.zeros(1), np.zeros(0)
        (v if options == RATE else q)[0] = x
        one, other = (
            call(machine.elements, (q, v, z, u, 0.0, machine.values))[0][-1]
            for machine in (tried, written)
        )
        assert one == pytest.approx(other, abs=1e-12)


def test_its_values_are_told_with_where_they_hold() -> None:
    values = dict(zip(on_trial(RATE).terms, FITTED, strict=True))
    item = Named("curve", On("x"), (0,), values, RATE, points=X)
    found = found_of(pushed_model(), item, "found_curve", (("by", "sparse"),), 0.8, None)
    assert [one.name for one in found.estimates] == ["F_1", "F_2", "F_3", "F_4"]
    assert [one.at for one in found.estimates] == list(X)
    assert {one.at_unit for one in found.estimates} == {"m/s"}
    assert found.law == "curve(s')"

    assert found.sentence.startswith("On x, a force of the rate")
    assert "resists the motion" in found.sentence
    assert "0.20 ± 0.04 N at 0.1 m/s" in found.sentence
    assert "goes on straight" in found.sentence
    assert dict(found.element.found)["sd"] == (0.04,) * 4
    again = append_elements(pushed_model(), [found.element]).elements[-1]
    assert again.curve == found.element.curve
    assert again.found == found.element.found


def test_a_bent_curve_is_said_to_be_bent() -> None:
    x, y = (-2.0, -0.5, 0.0, 0.5, 2.0), (-1.4, -1.0, 0.0, 1.0, 1.4)
    values = {value_name(i): (one, 0.01) for i, one in enumerate(y)}
    item = Named("curve", On("x"), (0,), values, (("over", "rate"),), points=x)
    found = found_of(pushed_model(), item, "c", (), None, None)
    assert "steep at small speeds and flatter at large ones" in found.sentence


def test_damping_that_changes_with_place_is_in_units_of_damping() -> None:
    values = dict(zip(on_trial(DAMPING).terms, FITTED, strict=True))
    item = Named("curve", On("x"), (0,), values, DAMPING, points=X)
    found = found_of(pushed_model(), item, "found_curve", (("by", "sparse"),), 0.8, None)
    assert {one.unit for one in found.estimates} == {"N*s/m"}
    assert {one.at_unit for one in found.estimates} == {"m"}
    assert "damping that changes with the stretch" in found.sentence
