"""Numbers with their unit in place: what belongs to the unit, what it is worth, what is refused."""

import re

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.mechanics.show import show_equations
from symhyb.model.expression import (
    ExpressionError,
    Operation,
    Quantity,
    evaluate,
    names,
    parse_expression,
    quantities,
    show,
    unit_of,
)
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.units import ONE, Unit, parse_unit
from tests.builders import DRIVEN_MASS

UNITS: dict[str, Unit] = {"x": parse_unit("m"), "m": parse_unit("kg"), "phi": parse_unit("rad")}
VALUES: dict[tuple[str, int] | str, float] = {"x": 0.4, "m": 3.0, "phi": 0.2, ("x", 1): 7.0}


def unit(text: str) -> str:
    found = unit_of(parse_expression(text), lambda n: UNITS[n.name] / parse_unit("s") ** n.order)
    return "any" if found is None else (found / ONE).text


@pytest.mark.parametrize(
    ("text", "value", "said"),
    [
        ("2 kg", 2.0, "kg"),
        ("32 cm + x", 0.72, "cm"),
        ("9.81 m/s^2", 9.81, "m/s^2"),
        ("-1.5e3 mm", -1.5, "mm"),
        (".5 kN*m/rad", 500.0, "kN*m/rad"),
        ("5 1/s", 5.0, "1/s"),
        ("180 deg", np.pi, "deg"),
        ("2 N*m", 2.0, "N*m"),
        ("2 N * m", 6.0, "N*kg"),
        ("2 N *m", 6.0, "N*kg"),
        ("2 N/ m", 2 / 3, "N/kg"),
        ("2 N*(m + 1 kg)", 8.0, "N*kg"),
        ("2 N*3", 6.0, "N"),
        ("2 N*x'", 14.0, "N*m/s"),
        ("2 N*sin(phi)", 2 * np.sin(0.2), "N"),
        ("(3 mm)**2", 9e-6, "mm^2"),
        ("x**2/4 m", 0.04, "m"),
        ("sin(90 deg)", 1.0, "1"),
        ("max(2 mm, x)", 0.4, "mm"),
        ("0 m", 0.0, "m"),
        ("2 in", 0.0508, "in"),
        ("3 min", 180.0, "min"),
        ("2 lbf*ft", 2 * 4.4482216152605 * 0.3048, "lbf*ft"),
    ],
)
def test_value_and_unit(text: str, value: float, said: str) -> None:
    tree = parse_expression(text)
    assert evaluate(tree, VALUES) == pytest.approx(value, rel=1e-12)
    assert unit(text) == said
    again = parse_expression(show(tree.tree))
    assert evaluate(again, VALUES) == pytest.approx(value, rel=1e-12)
    assert unit_of(again, lambda n: UNITS[n.name] / parse_unit("s") ** n.order) is not None


def test_a_division_binds_after_the_unit() -> None:
    """In ``x**2/4 m`` the 4 m are one number: what is read is x²/(4 m)."""
    tree = parse_expression("x**2/4 m").tree
    assert isinstance(tree, Operation)
    assert tree.arguments[1] == Quantity(4.0, parse_unit("m"))
    assert show(tree) == "x**2/(4 m)"


def test_the_units_are_no_names() -> None:
    expression = parse_expression("2 kg*m + 3 s * x")
    assert {name.name for name in names(expression)} == {"x"}
    assert [str(one) for one in quantities(expression)] == ["2 kg*m", "3 s"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("2 kg*x", "'2 kg*x' has no readable unit: 'x' is not a known unit"),
        ("2 kg*x", "a product is '2 kg * x', with blanks, or '2*…'"),
        ("2 x", "'x' is not a known unit"),
        ("2 x", "a product is '2*x'"),
        ("2 m**2", "in a unit the power is '^', as in m^2"),
        ("2 m^2e9", "'2 m^2e9': a power in a unit is a whole number, as in m^2"),
        ("2 m^2.5", "a power in a unit is a whole number"),
        ("2 m^2 (x)", "a power in a unit is a whole number"),
        ("2 kg > x", "'2 kg > x' stands in no where(...)"),
        ("2 m 3 kg", "'2 m 3 kg' is not an expression"),
        ("2 m2", "a power is written with '^', as in m^2"),
        ("20 degC", "a scale with an offset"),
        ("2kg", "'2kg' is not an expression"),
        ("x kg", "'x kg' is not an expression"),
        ("2 kg 3", "is not an expression"),
        ("2 m^0.5", "a power in a unit is a whole number"),
        ("2^3", "'^' is not allowed in '2^3'; power is '**'"),
        ("2 m + x^2", "'^' is not allowed in '2 m + x^2'; power is '**'"),
        ("1e308 km", "a number is not finite"),
        ("2 lambda", "'lambda' is a reserved word"),
        ("\u02bc0\u02bc", "is not allowed"),
        ("2 m + \u02bc0\u02bc", "is not allowed"),
    ],
)
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(ExpressionError, match=re.escape(said)):
        parse_expression(text)


def test_units_are_checked_as_everywhere() -> None:
    with pytest.raises(InputError, match=r"'2 kg' is kg, needs N/m"):
        parse_model(DRIVEN_MASS.replace('stiffness = "k"', 'stiffness = "2 kg"'))
    with pytest.raises(InputError, match=r"adds 'x' in m and '1 s' in s"):
        parse_model(DRIVEN_MASS.replace('measures = "x"', 'measures = "x + 1 s"'))


def test_what_could_be_read_in_two_ways_is_refused() -> None:
    """A declared length m behind a sign of the unit. Of a mass m the units would not agree."""
    length = DRIVEN_MASS.replace(
        'm = { value = 1.0, unit = "kg" }', "m = { value = 2, unit = 'm' }"
    )
    length = length.replace('mass = "m"', 'mass = "1 kg"')
    said = "'3 N/m' can be read in two ways, as m is a declared name; write a product with blanks"
    with pytest.raises(InputError, match=re.escape(said)):
        parse_model(length.replace('stiffness = "k"', 'stiffness = "3 N/m"'))
    (spring, *_) = parse_model(length.replace('"k"', '"3 N / m"')).elements
    assert spring.values[0][1].text == "3 N / m"
    assert parse_model(DRIVEN_MASS.replace('"k"', '"3 N/m"'))


def test_a_model_with_numbers_in_place_is_the_one_with_parameters() -> None:
    plain = parse_model(DRIVEN_MASS)
    text = DRIVEN_MASS.replace('stiffness = "k"', 'stiffness = "0.025 N/mm"')
    text = text.replace('damping = "d"', 'damping = "600 N*s/km"').replace(
        'mass = "m"', 'mass = "1000 g"'
    )
    placed = parse_model(text.replace('measures = "x"', 'measures = "x - 5 cm"'))
    t = np.linspace(0, 2, 101)
    given = Scenario(t, np.array([0.1]), np.zeros(1), t, np.sin(3 * t)[:, None])
    one, other = (simulate(build(model), given) for model in (plain, placed))
    np.testing.assert_allclose(other.q, one.q, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(other.y, one.y - 0.05, rtol=1e-9, atol=1e-12)
    assert parse_model(render(placed)).elements == placed.elements
    assert "-25.0*x" in show_equations(placed) or "-25*x" in show_equations(placed)


def test_a_place_may_count_from_a_length() -> None:
    text = DRIVEN_MASS.replace('on = "x"\nstiffness', 'on = "x - 20 mm"\nstiffness')
    machine = build(parse_model(text))
    t = np.linspace(0, 1, 11)
    run = simulate(machine, Scenario(t, np.array([0.02]), np.zeros(1), t, 0 * t[:, None]))
    np.testing.assert_allclose(run.q, 0.02, atol=1e-12)
