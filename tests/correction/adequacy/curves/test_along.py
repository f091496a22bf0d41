"""The linear problem of a curve in place of one that a structure has."""

import numpy as np
import pytest

from symhyb.correction.adequacy.curves.along import force_of, without_last
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On


def test_what_is_left_without_a_force_is_what_is_explained_in_its_place() -> None:
    random = np.random.default_rng(5)
    forces, old, left = (
        random.normal(size=(50, 3)),
        random.normal(size=(50, 1)),
        random.normal(size=50),
    )
    given = np.column_stack([forces, old, left])
    wanted = np.column_stack([forces, left - old[:, 0]])
    ((gram, likely), (again, other)) = without_last(
        [(given.T @ given, 0.0), (0.5 * given.T @ given, 2.0)]
    )
    assert gram == pytest.approx(wanted.T @ wanted)
    assert again == pytest.approx(0.5 * wanted.T @ wanted)
    assert likely == 0.0
    # ln L without the forces: half the squares that are left, less, for each size of the noise
    more = 0.5 * float(left @ left - gram[-1, -1])
    assert other == pytest.approx(2.0 + 0.5 * more - more)


def test_a_product_pushes_as_both_of_its_curves_say() -> None:
    cause = Hypothesis(
        "curve",
        On("x"),
        ("f1", "f2"),
        (False, False),
        options=(("over", "rate"),),
        points=((-1.0, -2.0, 0.0), (1.0, 2.0, 0.0)),
        by_stretch=((0.0, 1.0, 0.0), (1.0, 3.0, 0.0)),
    )
    s, r = np.array([0.0, 0.5, 1.0]), np.array([1.0, -0.5, 0.25])
    assert force_of(cause, s, r) == pytest.approx([2.0, -2.0, 1.5])
