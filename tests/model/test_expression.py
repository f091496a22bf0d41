"""Expressions: what they mean, and that nothing else than arithmetic gets in."""

import math
import time

import numpy as np
import pytest

from symhyb.model.expression import (
    ExpressionError,
    Name,
    Number,
    Operation,
    Reading,
    evaluate,
    names,
    parse_expression,
    readings,
    show,
    tables_in,
    unit_of,
)
from symhyb.units import ONE, Unit, parse_unit

VALUES: dict[tuple[str, int] | str, float] = {
    "a": 0.3,
    "b": -1.7,
    "c": 2.5,
    ("x", 0): 0.4,
    ("x", 1): -0.6,
    ("x", 2): 1.1,
}

TEXTS = [
    ("a + b*c", 0.3 - 1.7 * 2.5),
    ("-a**2", -(0.3**2)),
    ("2**-a", 2**-0.3),
    ("a - (b - c)", 0.3 + 1.7 + 2.5),
    ("a/(b*c)/a", 1 / (-1.7 * 2.5)),
    ("-(a - b)", -2.0),
    ("c**2**0.5", 2.5 ** (2**0.5)),
    ("(c**2)**0.5", 2.5),
    ("min(a, b, c) + max(a, c)", 0.8),
    ("atan2(b, a)", math.atan2(-1.7, 0.3)),
    ("sgn(b) + sign(a)", 0.0),
    ("2*pi*abs(x')", 2 * math.pi * 0.6),
    ("x'' + x' + x", 0.9),
    ("exp(log(c)) + sqrt(c*c)", 5.0),
    ("tanh(a)*cosh(a) - sinh(a)", 0.0),
    ("sin(a)/cos(a) - tan(a)", 0.0),
    ("asin(a) + acos(a) - 2*atan(1)", 0.0),
    ("+1e-3", 1e-3),
    ("a\n  + b", -1.4),
]


@pytest.mark.parametrize(("text", "value"), TEXTS)
def test_value_of_text_and_of_what_is_shown(text: str, value: float) -> None:
    tree = parse_expression(text).tree
    assert evaluate(tree, VALUES) == pytest.approx(value, abs=1e-15)
    assert parse_expression(show(tree)).tree == tree


def test_trees_are_plain_values() -> None:
    assert parse_expression("x'' * 2").tree == Operation("*", (Name("x", 2), Number(2.0)))
    assert parse_expression("sgn(x)").tree == Operation("sign", (Name("x"),))
    assert parse_expression("pi").tree == Number(math.pi)


@pytest.mark.parametrize("number", [0, 3, -2.5, 1e-9])
def test_a_number_reads_back_from_its_text(number: float) -> None:
    expression = parse_expression(number)
    assert evaluate(expression, {}) == number
    assert parse_expression(expression.text) == expression


def test_names_come_with_their_order() -> None:
    assert names(parse_expression("sin(x)*x' + k")) == {Name("x"), Name("x", 1), Name("k")}
    assert names(parse_expression("2*pi")) == frozenset()


def test_arrays_go_through() -> None:
    x = np.linspace(-1.0, 1.0, 5)
    value = evaluate(parse_expression("k*x + abs(x)"), {"k": 2.0, "x": x})
    np.testing.assert_allclose(value, 2 * x + np.abs(x))


def test_what_has_no_value_is_not_finite_and_not_a_warning() -> None:
    assert np.isnan(evaluate(parse_expression("log(0 - 1)"), {}))
    assert np.isinf(evaluate(parse_expression("1/0"), {}))


def test_a_name_without_value_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        evaluate(parse_expression("a + q"), VALUES)


HOSTILE = [
    "__import__('os').system('true')",
    "a.__class__",
    "x'.real",
    "(1).__class__.__bases__",
    "open(a)",
    "exec(a)",
    "eval(a)",
    "getattr(a, b)",
    "lambda: 1",
    "(lambda x: x)(1)",
    "[a for a in b]",
    "(a for a in b)",
    "{a: b}",
    "a[0]",
    "'text'",
    "x'text'",
    '"text"',
    "f'{a}'",
    "b'0'",
    "a if b else c",
    "a and b",
    "not a",
    "a == b",
    "a < b",
    "(a := 1)",
    "a, b",
    "()",
    "...",
    "None",
    "True",
    "1j",
    "a @ b",
    "a % b",
    "a // b",
    "a << b",
    "~a",
    "a; b",
    "yield a",
    "await a",
    "import os",
    "sin(a, b)",
    "sin()",
    "sin(x=a)",
    "sin(*a)",
    "min(a)",
    "sin",
    "a'b",
    "a'''",
    "pi(2)",
    "a(b)",
    "a^2",
    "2a",
    "1e999",
    "nan^nan",
    "",
    "  ",
    "a +",
    "(a",
    "φ",
    "a\\b",
    "a # b",
    "a\x00b",
    "lambda",
]


@pytest.mark.parametrize("text", HOSTILE)
def test_everything_but_arithmetic_is_refused(text: str) -> None:
    with pytest.raises(ExpressionError):
        parse_expression(text)


@pytest.mark.parametrize(
    "text",
    [
        "(" * 300 + "a" + ")" * 300,
        "-" * 1500 + "a",
        "+".join(["a"] * 900),
        "sin(" * 100 + "a" + ")" * 100,
        "a" * 2001,
        "9" * 1999,
        "a**" * 600 + "a",
    ],
    ids=["parentheses", "minus", "sum", "calls", "long", "digits", "powers"],
)
def test_deep_long_and_large_is_refused_at_once(text: str) -> None:
    begin = time.process_time()
    with pytest.raises(ExpressionError):
        parse_expression(text)
    assert time.process_time() - begin < 1.0


def test_a_huge_power_does_not_hang() -> None:
    begin = time.process_time()
    assert np.isinf(evaluate(parse_expression("9**9**9**9**9"), {}))
    assert time.process_time() - begin < 1.0


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a^2", "power is '**'"),
        ("ssin(a)", "did you mean 'sin'"),
        ("sin", "'sin(x)'"),
        ("(a", "parentheses do not match"),
        ("a.b", "'a.b' is not allowed"),
        ("x'''", "second derivative is the highest"),
        ("lambda*2", "'lambda' is a reserved word"),
        ("atan2(a)", "takes 2 arguments, not 1"),
    ],
)
def test_messages_quote_the_part_and_say_the_cure(text: str, sentence: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text)
    assert sentence in str(caught.value)


def unit(name: Name) -> Unit:
    units = {"x": "m", "k": "N/m", "phi": "rad", "m": "kg", "n": "1", "l": "mm", "y": "V"}
    return parse_unit(units[name.name]) / parse_unit("s") ** name.order


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("k*x", "N"),
        ("m*x''", "N"),
        ("k*x + m*x''", "N"),
        ("x + l", "m"),
        ("0 + x", "m"),
        ("sin(phi) + cos(n) + 1", "1"),
        ("sqrt(k/m)", "1/s"),
        ("(k/m)**0.5", "1/s"),
        ("x**-2", "1/m^2"),
        ("x**(1/2)*x**(3/2)", "m^2"),
        ("abs(x')*x'", "m^2/s^2"),
        ("sign(x')*k", "N/m"),
        ("max(x, 0)", "m"),
        ("atan2(x, l)", "1"),
        ("n**phi", "1"),
        ("y**3", "V^3"),
        ("-x", "m"),
    ],
)
def test_unit_of_an_expression(text: str, expected: str) -> None:
    found = unit_of(parse_expression(text), unit)
    assert found is not None
    assert found.same_dimension(parse_unit(expected))


def test_a_literal_zero_fits_every_unit() -> None:
    assert unit_of(parse_expression("0"), unit) is None
    assert unit_of(parse_expression("-0"), unit) is None
    assert unit_of(parse_expression("2"), unit) == ONE


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x + m", "adds 'x' in m and 'm' in kg"),
        ("x - 1", "subtracts 'x' in m and '1' in 1"),
        ("min(x, m)", "min() compares"),
        ("sin(x)", "sin() needs a plain number, but 'x' is in m"),
        ("exp(k*x)", "'k*x' is in N"),
        ("2**x", "the power 'x' is in m"),
        ("x**n", "'x' is in m"),
        ("x**0.123", "'x' is in m"),
        ("atan2(x, m)", "compares"),
        ("((x**20)**20)**20", "no readable unit"),
    ],
)
def test_units_that_do_not_fit_are_said(text: str, sentence: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        unit_of(parse_expression(text), unit)
    assert sentence in str(caught.value)


def test_readings_are_calls_with_names() -> None:
    tree = parse_expression("distance(a, wall) - l").tree
    assert tree == Operation("-", (Reading("distance", ("a", "wall")), Name("l")))
    assert show(tree) == "distance(a, wall) - l"
    assert parse_expression(show(tree)).tree == tree
    assert names(tree) == {Name("l")}
    assert readings(parse_expression("2*reaction(x) - force(rail)*reaction(x)")) == (
        Reading("reaction", ("x",)),
        Reading("force", ("rail",)),
    )
    assert readings(Name("x")) == ()


def test_a_parameter_may_have_the_name_of_a_reading() -> None:
    tree = parse_expression("force*force(force)").tree
    assert names(tree) == {Name("force")}
    assert readings(tree) == (Reading("force", ("force",)),)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("distance(a)", r"'distance' takes 2 names, not 1; write distance\(<point>, <point>\)"),
        ("reaction()", r"'reaction' takes 1 name, not 0; write reaction\(<coordinate>\)"),
        ("reaction(x')", r"'reaction' takes names, not 'x''; write reaction\(<coordinate>\)"),
        ("force(2*rail)", r"'force' takes names, not '2 \* rail'; write force\(<element>\)"),
        ("gyroscope(gyroscope(a))", r"'gyroscope' takes names, not 'gyroscope\(a\)'"),
        ("distanc(a, b)", "'distanc' is not a known function; did you mean 'distance'"),
        ("distance(a, b=c)", "is not allowed"),
    ],
)
def test_readings_take_names_alone(text: str, sentence: str) -> None:
    with pytest.raises(ExpressionError, match=sentence):
        parse_expression(text)


def test_a_reading_has_no_value_and_only_the_unit_that_it_is_given() -> None:
    expression = parse_expression("1 + distance(a, b)")
    with pytest.raises(ExpressionError, match=r"'distance\(a, b\)' is what a sensor shows"):
        evaluate(expression, {})
    with pytest.raises(ExpressionError, match=r"only sensors may use distance\(a, b\)"):
        unit_of(expression, lambda name: ONE)
    metres = parse_expression("2*distance(a, b)**2")
    assert unit_of(metres, lambda name: ONE, lambda reading: parse_unit("m")) == parse_unit("m^2")
    power = parse_expression("x**distance(a, b)")
    with pytest.raises(ExpressionError, match="its power must be a whole number"):
        unit_of(power, lambda name: parse_unit("m"), lambda reading: ONE)


def test_a_curve_is_a_name_and_a_value() -> None:
    tree = parse_expression("2*curve(valve, x' - curve(cam, phi))").tree
    inner = Operation("curve", (Name("phi"),), "cam")
    value = Operation("-", (Name("x", 1), inner))
    assert tree == Operation("*", (Number(2.0), Operation("curve", (value,), "valve")))
    assert show(tree) == "2*curve(valve, x' - curve(cam, phi))"
    assert parse_expression(show(tree)).tree == tree
    assert names(tree) == {Name("x", 1), Name("phi")}
    assert tables_in(tree) == (("curve", "valve"), ("curve", "cam"))
    assert tables_in(Name("curve")) == ()
    assert names(parse_expression("curve*curve(curve, curve)")) == {Name("curve")}


@pytest.mark.parametrize(
    "text", ["curve(valve)", "curve()", "curve(valve, x, y)", "curve(x', x)", "curve(2, x)"]
)
def test_a_curve_without_its_name_or_value_is_refused(text: str) -> None:
    with pytest.raises(ExpressionError, match=r"as in curve\(<name>, x\)"):
        parse_expression(text)


def test_a_curve_has_a_value_where_it_is_known() -> None:
    expression = parse_expression("1 + curve(c, 2*x)")
    x = np.array([0.0, 1.0, 3.0])
    assert evaluate(expression, {"x": x}, {("curve", "c"): np.square}) == pytest.approx(
        1 + 4 * x**2
    )
    with pytest.raises(KeyError):
        evaluate(expression, {"x": x})


def test_a_curve_takes_one_unit_and_gives_another() -> None:
    units = {("curve", "valve"): (parse_unit("mm/s"), parse_unit("N"))}

    def unit(text: str) -> Unit | None:
        speed = parse_unit("m/s")
        return unit_of(parse_expression(text), lambda name: speed, None, lambda *at: units[at])

    assert unit("2*curve(valve, v)") == parse_unit("N")
    assert unit("curve(valve, 0)") == parse_unit("N")
    with pytest.raises(ExpressionError, match=r"'valve' takes mm/s, but 'v\*\*2' is in m\^2/s\^2"):
        unit("curve(valve, v**2)")
    with pytest.raises(ExpressionError, match="its power must be a whole number"):
        unit("v**(curve(valve, v)/curve(valve, v))")
    with pytest.raises(LookupError):
        unit("curve(other, v)")
    with pytest.raises(ExpressionError, match="stands in a model file alone"):
        unit_of(parse_expression("curve(valve, v)"), lambda name: ONE)


def test_a_map_is_a_name_and_two_values() -> None:
    tree = parse_expression("-map(strut, x, curve(valve, x'))").tree
    inner = Operation("curve", (Name("x", 1),), "valve")
    assert tree == Operation("neg", (Operation("map", (Name("x"), inner), "strut"),))
    assert show(tree) == "-map(strut, x, curve(valve, x'))"
    assert parse_expression(show(tree)).tree == tree
    assert tables_in(tree) == (("map", "strut"), ("curve", "valve"))
    assert names(parse_expression("map*map(map, map, 2)")) == {Name("map")}


@pytest.mark.parametrize(
    "text", ["map(a)", "map()", "map(a, x)", "map(a, x, y, z)", "map(x', x, y)", "map(2, x, y)"]
)
def test_a_map_without_its_name_or_values_is_refused(text: str) -> None:
    with pytest.raises(ExpressionError, match=r"as in map\(<name>, x, y\)"):
        parse_expression(text)


def test_a_map_has_a_value_where_it_is_known() -> None:
    expression = parse_expression("1 + map(c, 2*x, y)")
    x, y = np.array([0.0, 1.0, 3.0]), np.array([2.0, -1.0, 0.5])
    made = evaluate(expression, {"x": x, "y": y}, {("map", "c"): np.subtract})
    assert made == pytest.approx(1 + 2 * x - y)
    with pytest.raises(KeyError):
        evaluate(expression, {"x": x, "y": y}, {("curve", "c"): np.square})


def test_a_map_takes_two_units_and_gives_a_third() -> None:
    given = {("map", "strut"): (parse_unit("mm"), parse_unit("m/s"), parse_unit("kN"))}
    metre, speed = parse_unit("m"), parse_unit("m/s")

    def unit(text: str) -> Unit | None:
        known = {"x": metre, "v": speed}
        return unit_of(
            parse_expression(text), lambda name: known[name.name], None, lambda *at: given[at]
        )

    assert unit("2*map(strut, x, v)") == parse_unit("kN")
    assert unit("map(strut, 0, 2*v)") == parse_unit("kN")
    with pytest.raises(ExpressionError, match="the map 'strut' takes m/s, but 'x' is in m"):
        unit("map(strut, x, x)")
    with pytest.raises(ExpressionError, match="the map 'strut' takes mm, but 'v' is in m/s"):
        unit("map(strut, v, x)")
    with pytest.raises(LookupError):
        unit("curve(strut, x)")
    with pytest.raises(ExpressionError, match=r"map\(strut, …\) stands in a model file alone"):
        unit_of(parse_expression("map(strut, x, v)"), lambda name: metre)
