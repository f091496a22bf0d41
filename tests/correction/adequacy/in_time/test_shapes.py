"""Courses as expressions of a model are the courses that they state."""

import numpy as np
import pytest

from symhyb.correction.adequacy.in_time.shapes import Shape, free_factor, numbers_of, stated
from symhyb.model.expression import evaluate, parse_expression
from symhyb.model.read import parse_model
from tests.builders import DRIVEN_MASS

T = np.linspace(-1.0, 12.0, 400)
SHAPES = [
    Shape("step", (3.0, 3.4), (1.0, 0.8)),
    Shape("step", (3.0, 3.4), (1.0, 0.8), held=True),
    Shape("drift", (0.0, 10.0), (1.0, 1.3)),
    Shape("free", (0.0, 2.0, 5.0, 10.0), (1.0, 1.2, 0.7, 0.9)),
    Shape("period", (), (1.05, 0.2, 0.7, -0.4)),
]


@pytest.mark.parametrize("shape", SHAPES)
def test_the_expression_with_its_numbers_is_the_course(shape: Shape) -> None:
    values = {f"c_{key}": value for key, value in numbers_of(shape)}
    found = evaluate(parse_expression(free_factor(shape, "c")), {**values, "t": T})
    assert found == pytest.approx(shape.at(T), abs=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_what_a_file_states_is_the_course(shape: Shape) -> None:
    one = stated(shape, parse_model(DRIVEN_MASS), "k")
    values = {item.name: item.si for item in one.parameters}
    curves = {("curve", curve.name): curve.characteristic for curve in one.curves}
    found = evaluate(parse_expression(one.factor), {**values, "t": T}, curves)
    assert found == pytest.approx(shape.at(T), abs=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_moves_to_other_numbers(shape: Shape) -> None:
    other = np.array([value for _, value in numbers_of(shape)]) * 1.1
    assert [value for _, value in numbers_of(shape.moved(other))] == pytest.approx(other.tolist())


def test_a_step_moves_as_a_whole_or_with_its_duration() -> None:
    free, held = SHAPES[:2]
    assert [key for key, _ in numbers_of(free)] == ["at1", "at2", "time", "duration"]
    assert held.moved(np.array([1.0, 0.8, 5.2])).times == pytest.approx((5.0, 5.4))
    assert free.moved(np.array([1.0, 0.8, 5.2, 0.2])).times == pytest.approx((5.1, 5.3))


def test_a_name_that_is_taken_is_not_used_again() -> None:
    text = DRIVEN_MASS.replace("[inputs]", 'k_course = { value = 1.0, unit = "1" }\n[inputs]')
    one = stated(SHAPES[2], parse_model(text), "k")
    assert one.curves[0].name == "k_course_"
