"""where(condition, a, b): its value against NumPy, its units, and what is refused."""

import re

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.model.expression import (
    ExpressionError,
    Number,
    evaluate,
    parse_expression,
    show,
    unit_of,
)
from symhyb.model.jumps import jumps
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.switching import left_smooth
from symhyb.units import Unit, parse_unit
from tests.builders import DRIVEN_MASS

X = np.linspace(-2.0, 2.0, 17)
V = np.cos(5 * X)
VALUES: dict[tuple[str, int] | str, np.ndarray] = {("x", 0): X, ("x", 1): V, ("a", 0): 0 * X + 3}


def unit(name: str, order: int = 0) -> Unit:
    return parse_unit({"x": "m", "a": "N", "k": "N/m"}[name]) / parse_unit("s") ** order


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("where(x > 0.3, 2*x, -x)", np.where(X > 0.3, 2 * X, -X)),
        ("where(x < 0.3, 2*x, -x)", np.where(X < 0.3, 2 * X, -X)),
        ("where(x >= 30 cm, x, 0)", np.where(X >= 0.3, X, 0)),
        ("where(not x <= 0.3, 0, x)", np.where(X <= 0.3, X, 0)),
        ("where(-1.1 < x <= 1.1, 5, 7)", np.where((X > -1.1) & (X < 1.1), 5, 7)),
        ("where(x > 0.3 and x' < 0.1, 5, 7)", np.where((X > 0.3) & (V < 0.1), 5, 7)),
        ("where(x > 0.3 or x' < 0.1 or x < -1.9, 5, 7)", np.where((X > 0.3) | (V < 0.1), 5, 7)),
        ("where(not (x > 0.3 or x' < 0.1), 5, 7)", np.where((X > 0.3) | (V < 0.1), 7, 5)),
        (
            "where(x > 1.1, 1, where(x > -1.1, 2, 3))",
            np.where(X > 1.1, 1, np.where(X > -1.1, 2, 3)),
        ),
        ("1 + 2*where(x > 0.3, a, a/2)", 1 + 2 * np.where(X > 0.3, 3, 1.5)),
        ("where(x > 0, 2, 4)", np.where(X > 0, 2, np.where(X < 0, 4, 3))),
        ("where(x > 0, 0, 0)", 0 * X),
    ],
)
def test_its_value_is_that_of_numpy(text: str, expected: np.ndarray) -> None:
    """At equality it is the mean of both."""
    tree = parse_expression(text).tree
    np.testing.assert_array_equal(evaluate(tree, VALUES) + 0 * X, expected)
    np.testing.assert_allclose(evaluate(parse_expression(show(tree)), VALUES) + 0 * X, expected)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("where(x > 1 mm, a, 2 N)", "N"),
        ("where(x > 1 mm, k*x, 0)", "N"),
        ("where(x > 1 mm, 0, k*x)", "N"),
    ],
)
def test_its_unit_is_that_of_the_values(text: str, said: str) -> None:
    found = unit_of(parse_expression(text), lambda name: unit(name.name, name.order))
    assert found is not None
    assert found.same_dimension(parse_unit(said))


@pytest.mark.parametrize("text", ["where(x > a, 1, 2)", "where(x > 0, a, x)"])
def test_units_that_differ_are_found(text: str) -> None:
    with pytest.raises(ExpressionError, match=r"subtracts|adds"):
        unit_of(parse_expression(text), lambda name: unit(name.name, name.order))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("where(x, 1, 2)", "'where' takes a comparison with < or >"),
        ("where(x > 1, 2)", "here it has 2 arguments"),
        ("where(x == 1, 2, 3)", "two values are never exactly equal"),
        ("where(x > 1, 2, y=3)", "is not allowed"),
        ("x > 1", "'x > 1' stands in no where(...)"),
        ("x and y", "'x and y' stands in no where(...)"),
        ("where(where(x > 0, 1, 2) > 1, 3, 4)", "a condition of 'where' holds no other 'where'"),
        ("where(x > 1, 2, 3", "the parentheses do not match"),
        ("wher(x > 1, 2, 3)", "'wher' is not a known function; did you mean 'where'?"),
        ("x = 1", "is not an expression"),
        ("where(x > 0, 1, " * 70 + "0" + ")" * 70, "nested too deeply"),
    ],
)
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(ExpressionError, match=re.escape(said)):
        parse_expression(text)


def test_many_in_each_other_stay_small() -> None:
    text = "where(x > 0, 1, " * 25 + "0" + ")" * 25
    assert len(show(parse_expression(text).tree)) < 100 * 25
    assert parse_expression("where(x > 0, 0, 0)").tree == Number(0.0)


def test_a_parameter_may_have_the_name() -> None:
    text = DRIVEN_MASS.replace("k = {", "where = {").replace('"k"', '"where"')
    assert parse_model(text).parameters["where"].value == 25.0


def test_it_is_written_as_it_was_read_and_its_jumps_are_known() -> None:
    text = DRIVEN_MASS.replace('force = "f"', 'force = "where(x > 10 mm, f, f/2)"')
    model = parse_model(text)
    assert parse_model(render(model)).elements == model.elements
    assert [jump.name for jump in jumps(model)] == ["push"]
    assert left_smooth(model) == ()
    relay = '[states]\nr = { unit = "N", rate = "where(x > 0, f - r, -r)/(1 s)" }\n'
    assert [jump.name for jump in jumps(parse_model(DRIVEN_MASS + relay))] == ["states.r"]


def test_a_place_needs_a_speed() -> None:
    text = DRIVEN_MASS.replace('on = "x"\nstiffness', 'on = "where(x > 0 m, x, 2*x)"\nstiffness')
    with pytest.raises(InputError, match="has no smooth speed, which a place needs"):
        parse_model(text)
