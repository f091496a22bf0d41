"""A curve on trial is the element that it becomes."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.adequacy.curves.fitted_curve import restated, values_of
from symhyb.correction.naming.curve_points import (
    Through,
    curve_element,
    curve_values,
    value_estimates,
)
from symhyb.correction.naming.findings import Named, found_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import factor_name, value_name
from symhyb.model.types import Element, On, Place
from symhyb.model.vocabulary import Words
from symhyb.model.write import append_elements
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from tests.pushed import pushed_model

POINTS = ((-2.0, -1.5, 0.01), (-0.5, -1.0, 0.0), (0.1, 0.2, 0.03), (1.5, 2.0, 0.0))
X, Y, SHIFT = zip(*POINTS, strict=True)
FITTED = {value_name(i): (y, 0.04) for i, y in enumerate(Y)}
BY_STRETCH = ((-1.0, 0.2, 0.01), (0.0, 1.0, 0.0), (2.0, 0.6, 0.02))
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
    curve = Through(PLACE, options, POINTS)
    estimates = value_estimates(model, curve, FITTED)
    element = curve_element(model, "c", curve, estimates, None, (("by", "sparse"),))
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
    item = Named("curve", On("x"), (0,), FITTED, RATE, points=POINTS)
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
    points = tuple((one, 0.0, 0.0) for one in x)
    item = Named("curve", On("x"), (0,), values, RATE, points=points)
    found = found_of(pushed_model(), item, "c", (), None, None)
    assert "steep at small speeds and flatter at large ones" in found.sentence


def test_damping_that_changes_with_place_is_in_units_of_damping() -> None:
    item = Named("curve", On("x"), (0,), FITTED, DAMPING, points=POINTS)
    found = found_of(pushed_model(), item, "found_curve", (("by", "sparse"),), 0.8, None)
    assert {one.unit for one in found.estimates} == {"N*s/m"}
    assert {one.at_unit for one in found.estimates} == {"m"}
    assert "damping that changes with the stretch" in found.sentence


def product() -> Hypothesis:
    """A loss of which more acts at one place than at another; none at rest."""
    terms = (*(value_name(i) for i in (0, 1, 3)), factor_name(0), factor_name(2))
    points = (*POINTS[:2], (0.0, 0.0, 0.0), POINTS[3])
    return Hypothesis(
        "curve", PLACE, terms, (False,) * 5, options=RATE, points=points, by_stretch=BY_STRETCH
    )


def forces(element: Element) -> np.ndarray:
    model = pushed_model()
    machine = build(replace(model, elements=(*model.elements, element)))
    grid = [(x, v) for x in np.linspace(-2.5, 3, 9) for v in np.linspace(-3, 3, 9)]
    return np.array(
        [
            call(
                machine.elements,
                (np.array([x]), np.array([v]), np.zeros(0), np.zeros(1), 0.0, machine.values),
            )[0][-1]
            for x, v in grid
        ]
    )


def test_a_product_acts_as_it_is_written_and_changes_with_its_factors() -> None:
    model, trial = pushed_model(), product()
    assert trial.unknown.keys() | trial.factors.keys() == {*trial.terms}
    still = values_of(trial)
    reported = curve_values(trial, {key: (value, 0.04) for key, value in still.items()})
    assert reported["w1"] == (0.2, 0.04)
    assert reported["w3"] == (0.6, 0.04)
    curve = Through(PLACE, RATE, trial.points, trial.by_stretch)
    estimates = value_estimates(model, curve, reported)
    assert [one.name for one in estimates] == ["F_1", "F_2", "F_4", "w_1", "w_3"]
    element = curve_element(model, "c", curve, estimates, None, (("by", "sparse"),))
    as_tried = forces(trial.element(model, "c", still))
    assert as_tried == pytest.approx(forces(element), abs=1e-12)
    # a small change of a value or of a factor is what the product changes by, to first order
    for key in trial.terms:
        changed = {**still, key: still[key] + 1e-4}
        tried = forces(trial.element(model, "c", changed))
        again = forces(
            restated(trial, changed).element(model, "c", values_of(restated(trial, changed)))
        )
        assert np.abs(tried - as_tried).max() > 1e-5
        assert tried == pytest.approx(again, abs=1e-7)


def test_a_product_is_said_with_both_of_its_curves() -> None:
    trial = product()
    values = curve_values(trial, {key: (value, 0.04) for key, value in values_of(trial).items()})
    item = Named("curve", PLACE, (0,), values, RATE, points=trial.points, by_stretch=BY_STRETCH)
    found = found_of(pushed_model(), item, "c", (("by", "sparse"),), None, None)
    assert found.law == "by_stretch(s)*curve(s')"
    assert "force of the rate that changes with the stretch resists the motion" in found.sentence
    assert "0.20 ± 0.04 at −1" in found.sentence
    again = append_elements(pushed_model(), [found.element]).elements[-1]
    assert again.by_stretch == found.element.by_stretch
    assert dict(again.found)["sd"] == (0.04, 0.04, 0.0, 0.04)
    assert dict(again.found)["sd_by_stretch"] == (0.04, 0.0, 0.04)
