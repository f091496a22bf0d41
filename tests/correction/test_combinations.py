"""Parameters that a motion shows only together are said to be so, with the combination."""

import numpy as np
import pytest
from builders import model_of, recording

import symhyb as sh
from symhyb.correction.advice.combinations import base_of

RANDOM = np.random.default_rng(6)


def test_a_column_that_is_a_sum_of_others_is_determined_together_with_them() -> None:
    columns = 30 * RANDOM.standard_normal((400, 2))
    joined = np.column_stack([columns, 0.5 * columns[:, 0] - 0.25 * columns[:, 1]])
    base = base_of(joined.T @ joined)
    assert base.determined == (0, 1)
    assert base.together == (2,)
    assert base.nothing == ()
    np.testing.assert_allclose(base.factors[:, 0], [0.5, -0.25], rtol=1e-9)


def test_what_is_known_no_better_than_before_is_no_part_of_anything() -> None:
    information = np.diag([50.0, 0.5, 2.0])
    base = base_of(information)
    assert (base.determined, base.nothing, base.together) == ((0, 2), (1,), ())
    assert base.factors.shape == (2, 0)


def test_columns_that_differ_by_more_than_the_prior_are_determined_separately() -> None:
    """Almost alike, but the difference alone tells each to a third of what was known."""
    first = 100 * RANDOM.standard_normal(400)
    other = first + 0.5 * RANDOM.standard_normal(400)
    joined = np.column_stack([first, other])
    assert base_of(joined.T @ joined).determined == (0, 1)


@pytest.mark.parametrize("weighed", [True, False])
def test_two_masses_on_one_coordinate_are_told_together(weighed: bool) -> None:
    """Where neither mass is known only their sum shows; one beside a known one is determined."""
    t = np.arange(600) / 100
    force = 4 * np.sin(9 * t) + 3 * np.sin(15 * t + 1)
    # (m + M) x'' + k x = f, at rest in both waves
    k, total = 200.0, 1.5
    waves = [(4, 9.0, 0.0), (3, 15.0, 1.0)]
    x = sum(a / (k - total * w**2) * np.sin(w * t + phase) for a, w, phase in waves)
    sd = {} if weighed else {"sd": 0.5}
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        inputs={"f": {"unit": "N"}},
        parameters={
            "m": {"value": 1.0, "unit": "kg", "sd": 0.3},
            "load": {"value": 0.5, "unit": "kg", **sd},
            "k": {"value": k, "unit": "N/m", "sd": 20.0},
        },
        bodies={"one": {"mass": "m", "at": ["x", "0"]}, "two": {"mass": "load", "at": ["x", "0"]}},
        elements={
            "hold": {"kind": "spring", "on": "x", "stiffness": "k"},
            "push": {"kind": "force", "on": "x", "force": "f"},
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    noisy = x + 1e-3 * x.std() * np.random.default_rng(2).normal(size=t.size)
    answer = sh.diagnose(model, recording(t, {"f": force}, place=noisy))
    said = [note for note in answer.notes if "separately" in note]
    if weighed:
        assert said == []
    else:
        assert said == [
            "These recordings do not determine m separately, only in load + 1 m (numbers in the "
            "units of the model file)."
        ]
