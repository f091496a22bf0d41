"""The picture of damping that changes with the stretch."""

import pytest

from symhyb.correction.naming.findings import Named, found_of
from symhyb.discrepancy.results import Found
from symhyb.laws.curve import value_name
from symhyb.model.types import On
from symhyb.model.vocabulary import Words
from symhyb.report.coefficient_figure import coefficient_figure, coefficient_of
from tests.pushed import pushed_model

X, Y = (-2.0, -0.5, 0.1, 1.5), (0.1, 3.0, 1.0, 0.2)


def found(*words: tuple[str, str]) -> Found:
    options: Words = (("over", "stretch"), *words)
    values = {value_name(i): (y, 0.04) for i, y in enumerate(Y)}
    points = tuple((x, 0.0, 0.0) for x in X)
    item = Named("curve", On("x"), (0,), values, options, points=points)
    return found_of(pushed_model(), item, "found_curve", (("by", "sparse"),), 0.8, None)


@pytest.mark.parametrize(("times", "word"), [("rate", "damping"), ("square", "drag")])
def test_a_factor_of_the_speed_has_a_name(times: str, word: str) -> None:
    assert coefficient_of(found(("times", times))) == word


def test_a_force_has_none() -> None:
    assert coefficient_of(found()) == ""


def test_it_says_its_units() -> None:
    drawn = coefficient_figure(found(("times", "rate"))).decode()
    assert "damping [N*s/m]" in drawn
    assert "stretch [m]" in drawn
    assert drawn.startswith("<?xml") or drawn.startswith("<svg")


def test_a_product_is_drawn_as_two_curves() -> None:
    points = ((-2.0, -1.5, 0.01), (0.0, 0.0, 0.0), (1.5, 2.0, 0.02))
    factors = ((-1.0, 0.2, 0.01), (2.0, 1.0, 0.0))
    values = {"f1": (-1.5, 0.04), "f3": (2.0, 0.04), "w1": (0.2, 0.01)}
    options: Words = (("over", "rate"),)
    item = Named("curve", On("x"), (0,), values, options, points=points, by_stretch=factors)
    both = found_of(pushed_model(), item, "found_curve", (("by", "sparse"),), 0.8, None)
    assert coefficient_of(both) == "loss"
    drawn = coefficient_figure(both).decode()
    assert "force where the factor is 1 [N]" in drawn
    assert "rate [m/s]" in drawn
    assert "stretch [m]" in drawn
