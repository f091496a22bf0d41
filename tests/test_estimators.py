"""The estimators: known laws come out, scikit-learn's habits hold, networks fade as in a model."""

import pickle
import re

import casadi as ca
import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.model_selection import GridSearchCV, KFold
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import check_estimator

from symhyb.estimators import NetworkForce, SparseForce
from symhyb.model.expression import parse_expression
from symhyb.numeric.lowered.network import force_of

RANDOM = np.random.default_rng(4)
SEEN = pd.DataFrame({"x": RANDOM.normal(0, 0.02, 400), "x'": RANDOM.normal(0, 3.0, 400)})
FORCE = 2.0 - 0.5 * SEEN["x'"] + 4e4 * SEEN["x"] ** 3 + 1e-3 * RANDOM.normal(size=400)


def test_a_known_law_comes_out_with_its_values() -> None:
    law = SparseForce(degree=3, threshold=0.005).fit(SEEN, FORCE)
    found = {term: value for term, value in zip(law.terms_, law.coef_, strict=True) if value}
    assert found.keys() == {"1", "x'", "x**3"}
    assert found["1"] == pytest.approx(2.0, abs=1e-3)
    assert found["x'"] == pytest.approx(-0.5, abs=1e-3)
    assert found["x**3"] == pytest.approx(4e4, rel=1e-3)
    np.testing.assert_allclose(law.predict(SEEN), FORCE, atol=5e-3)
    assert law.score(SEEN, FORCE) > 0.9999
    assert parse_expression(law.formula())
    assert re.fullmatch(r"[12]\.\d+ - 0\.\d+\*x' \+ \d+(\.\d+)?\*x\*\*3", law.formula())


def test_a_law_does_not_depend_on_the_units_of_its_features() -> None:
    metres = SparseForce(degree=3, threshold=0.005).fit(SEEN, FORCE)
    fine = SEEN * [1000.0, 1.0]
    millimetres = SparseForce(degree=3, threshold=0.005).fit(fine, FORCE)
    np.testing.assert_allclose(millimetres.predict(fine), metres.predict(SEEN), rtol=1e-9)


def test_terms_that_others_give_are_left_out() -> None:
    twice = SEEN.assign(again=2 * SEEN["x"])
    law = SparseForce(degree=1).fit(twice, FORCE)
    assert law.terms_ == ("1", "x", "x'")
    few = SparseForce(degree=3).fit(SEEN.head(5), FORCE.head(5))
    assert len(few.terms_) == 4
    nothing = SparseForce().fit(SEEN, np.zeros(400))
    assert not nothing.predict(SEEN).any()
    assert nothing.formula() == "0"


def test_it_takes_part_in_grids_and_pipelines() -> None:
    grid = GridSearchCV(SparseForce(threshold=0.005), {"degree": [1, 2, 3]}, cv=KFold(4))
    assert grid.fit(SEEN, FORCE).best_params_ == {"degree": 3}
    chain = make_pipeline(StandardScaler(), SparseForce(degree=3, threshold=1e-3))
    assert chain.fit(SEEN, FORCE).score(SEEN, FORCE) > 0.999
    assert clone(SparseForce(degree=5)).get_params() == {"degree": 5, "threshold": 0.05}
    with pytest.raises(NotFittedError):
        SparseForce().predict(SEEN)
    with pytest.raises(ValueError, match="feature names"):
        SparseForce().fit(SEEN, FORCE).predict(SEEN.rename(columns={"x": "y"}))


def test_a_network_learns_and_fades_as_it_does_in_a_model() -> None:
    speed = np.linspace(-2.0, 2.0, 300)
    seen = np.column_stack([speed, np.full(300, 7.0)])  # a feature that never changes
    law = NetworkForce(width=6, members=1).fit(seen, np.tanh(3 * speed))
    assert law.score(seen, np.tanh(3 * speed)) > 0.99
    wide = np.column_stack([np.linspace(-3.0, 3.0, 61), np.full(61, 7.0)])
    x = ca.SX.sym("x", 1)
    force = force_of(law.weights_, ((-2.0, 2.0),), x)
    same = ca.Function("f", [x], [force]).map(61)(wide[:, 0])
    np.testing.assert_allclose(law.predict(wide), np.asarray(same).ravel(), atol=1e-12)
    assert law.predict([[2.5, 7.0]]) == 0.0
    assert NetworkForce(6, 1, fade=False).fit(seen, np.tanh(3 * speed)).predict([[2.5, 7.0]]) > 0.5
    again = pickle.loads(pickle.dumps(law))
    np.testing.assert_array_equal(again.predict(wide), law.predict(wide))
    np.testing.assert_array_equal(law.trust_, [[-2.0, 2.0], [7.0, 7.0]])


def test_a_network_of_what_never_changes_is_that() -> None:
    law = NetworkForce().fit(np.ones((20, 2)), np.full(20, 3.0))
    np.testing.assert_array_equal(law.predict(np.zeros((2, 2))), [3.0, 3.0])


@pytest.mark.slow
@pytest.mark.parametrize("law", [SparseForce(), NetworkForce(width=4, members=1)])
def test_the_habits_of_scikit_learn_hold(law: object) -> None:
    check_estimator(law, on_skip=None)  # arrays of other libraries are not asked for
