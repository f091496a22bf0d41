"""A force of stretch or of rate that no listed law is becomes a curve; others do not."""

from collections.abc import Callable

import numpy as np
import pytest

from symhyb.correction.adequacy.curves.answer import instead_of_class
from symhyb.laws.characteristic import through
from symhyb.model.types import On
from tests.pushed import judged, resisted

Force = Callable[[float, float], float]


def rubber(x: float, v: float) -> float:
    return float(0.5 * (np.exp(x / 0.35) - 1))


@pytest.mark.slow
def test_a_force_without_a_name_becomes_a_curve() -> None:
    ground, found = judged(resisted(2, rubber))
    assert found.certain("law") == On("x")
    answer = instead_of_class(ground, found)
    assert answer is not None
    (curve,) = answer.causes
    assert curve.options == (("over", "stretch"),)
    assert answer.evidence > found.structure.evidence  # type: ignore[union-attr]
    x = np.array([x for x, _, _ in curve.points])
    grid = np.linspace(x[0], x[-1], 50)
    made = through("c", x.tolist(), answer.fit.values[: x.size].tolist())(grid)
    true = np.array([rubber(g, g) for g in grid])
    assert np.sqrt(np.mean((made - true) ** 2)) < 0.15 * np.std(true)


@pytest.mark.parametrize(
    ("force", "kinds"),
    [
        pytest.param(
            lambda x, v: 1.5 * x**2 * v,
            [("curve", (("over", "stretch"), ("times", "rate")))],
            marks=pytest.mark.slow,
            id="damping over the stretch",
        ),
        pytest.param(
            lambda x, v: rubber(x, v) + 0.4 * np.arcsinh(6 * v),
            [("curve", (("over", "rate"),)), ("curve", (("over", "stretch"),))],
            marks=pytest.mark.thorough,
            id="two curves",
        ),
        pytest.param(
            lambda x, v: rubber(x, v) + 0.4 * v * abs(v),
            [("curve", (("over", "stretch"),)), ("drag", ())],
            marks=pytest.mark.thorough,
            id="a curve and a law by name",
        ),
    ],
)
def test_a_force_of_both_is_a_factor_or_a_sum(
    force: Force, kinds: list[tuple[str, tuple[tuple[str, str], ...]]]
) -> None:
    ground, found = judged(resisted(3, force))
    assert found.certain("law") == On("x")
    answer = instead_of_class(ground, found)
    assert answer is not None
    assert sorted((cause.kind, cause.options) for cause in answer.causes) == kinds


@pytest.mark.thorough
def test_a_force_that_is_no_product_and_no_sum_is_no_curve() -> None:
    ground, found = judged(resisted(3, lambda x, v: 0.5 * np.tanh(3 * (x + 0.3 * v))))
    assert found.certain("law") == On("x")
    assert instead_of_class(ground, found) is None


@pytest.mark.thorough
def test_a_sharp_knee_has_as_many_points_as_it_needs() -> None:
    """Beside nothing the unknown force hides the knee: points are chosen along the curve's own
    motion."""
    ground, found = judged(resisted(2, lambda x, v: 2.0 * float(np.tanh(x / 0.08))))
    assert found.certain("law") == On("x")
    answer, by_class = instead_of_class(ground, found), found.by_class
    assert answer is not None
    assert by_class is not None
    assert [cause.kind for cause in answer.causes] == ["curve"]
    assert answer.evidence > by_class.evidence - 5
    assert len(answer.causes[0].points) > 5


@pytest.mark.slow
def test_a_listed_law_is_told_by_name() -> None:
    ground, found = judged(resisted(4, lambda x, v: 0.3 * abs(v) * v))
    answer = instead_of_class(ground, found) if found.certain("law") else None
    assert answer is None or [cause.kind for cause in answer.causes] == ["drag"]


@pytest.mark.slow
def test_where_nothing_acts_there_is_no_curve() -> None:
    ground, found = judged(resisted(5, lambda x, v: 0.0))
    assert found.certain("law") is None
    assert instead_of_class(ground, found) is None
