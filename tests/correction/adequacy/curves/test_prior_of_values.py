"""What is known of the values of a curve before a recording."""

import numpy as np
import pytest

from symhyb.correction.adequacy.classes.columns import LENGTHS, SIZE
from symhyb.correction.adequacy.curves.prior import covariance, factor, of_curve
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import value_name
from symhyb.model.types import On

X = np.array([-0.4, -0.1, 0.0, 0.05, 0.6])


def matern(a: float, b: float, length: float) -> float:
    far = np.sqrt(5.0) * abs(a - b) / length
    return float((1 + far + far**2 / 3) * np.exp(-far))


@pytest.mark.parametrize("length", LENGTHS)
def test_it_is_a_smooth_line_beside_a_straight_one(length: float) -> None:
    z = (X - 0.1) / 0.5  # of a range from −0.4 to 0.6
    by_hand = [[SIZE**2 * matern(a, b, length) + 3 * a * b for b in z] for a in z]
    assert covariance(X, length) == pytest.approx(np.array(by_hand))


def test_it_does_not_depend_on_the_unit_of_the_quantity() -> None:
    assert covariance(1e3 * X, 0.4) == pytest.approx(covariance(X, 0.4))


def test_of_what_goes_through_zero_it_is_conditional() -> None:
    whole = covariance(X, 0.4)
    by_hand = whole - np.outer(whole[2], whole[2]) / whole[2, 2]
    found = covariance(X, 0.4, 0.0)
    assert found == pytest.approx(by_hand, abs=1e-12)
    assert np.abs(found[2]).max() < 1e-12


def test_many_sets_of_points_have_one_each() -> None:
    both = np.stack([X, 2 * X + 1])
    found = factor(both, 1.0)
    for row, one in zip(both, found, strict=True):
        assert one @ one.T == pytest.approx(covariance(row, 1.0), abs=1e-6)


@pytest.mark.parametrize("through_zero", [False, True])
def test_a_curve_has_that_of_its_unknown_values(through_zero: bool) -> None:
    keys = [value_name(i) for i in range(X.size) if not (through_zero and i == 2)]
    points = tuple((float(x), 0.0, 0.0) for x in X)
    over = (("over", "rate"),)
    curve = Hypothesis(
        "curve", On("x"), tuple(keys), (False,) * len(keys), options=over, points=points
    )
    rows = [i for i in range(X.size) if not (through_zero and i == 2)]
    whole = covariance(X, 0.12, 0.0 if through_zero else None)
    assert of_curve(curve, 0.12) == pytest.approx(whole[np.ix_(rows, rows)], abs=1e-6)
