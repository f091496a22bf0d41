"""Expressions in SymPy mean what they mean in numbers, and names reach the right symbols."""

import numpy as np
import pytest
import sympy as sp
from builders import damper, oscillator, push

from symhyb.mechanics.symbols import reading_symbol, symbols_of, to_sympy
from symhyb.model.expression import evaluate, parse_expression, readings

TEXTS = [
    "a + b*c - x/2",
    "-a**2 + 2**-c",
    "(a*b)**3/c",
    "x'**2 - x''",
    "sqrt(c) + exp(a) - log(c)",
    "sin(a)*cos(b) + tan(x)",
    "asin(a) + acos(a) + atan(b) + atan2(b, c)",
    "sinh(a) - cosh(b)*tanh(c)",
    "abs(b)*sign(b)",
    "min(a, b, c) - max(a, b, 0.25)",
    "2*pi*a",
    "1e-3*a + 12345.678*b + 70",
    "c**0.5 - c**-1.5",
]
VALUES = {"a": 0.3, "b": -1.7, "c": 2.5, ("x", 0): 0.4, ("x", 1): -0.6, ("x", 2): 1.1}


@pytest.mark.parametrize("text", TEXTS)
def test_an_expression_has_the_same_value_in_sympy(text: str) -> None:
    tree = parse_expression(text).tree
    scope, numbers = {}, {}
    for key, number in VALUES.items():
        name, order = (key, 0) if isinstance(key, str) else key
        scope[name, order] = sp.Symbol(name + "'" * order, real=True)
        numbers[scope[name, order]] = number
    value = float(to_sympy(tree, scope).subs(numbers))
    assert value == pytest.approx(float(evaluate(tree, VALUES)), rel=1e-12)


def test_whole_exponents_stay_whole() -> None:
    x = sp.Symbol("x", real=True)
    assert to_sympy(parse_expression("x**3"), {("x", 0): x}) == x**3


def test_a_name_that_is_not_declared_is_a_key_error() -> None:
    with pytest.raises(KeyError, match="oops"):
        to_sympy(parse_expression("2*oops"), {})


def test_an_element_sees_its_own_parameter_before_that_of_the_model() -> None:
    own = {**damper("d"), "parameters": {"d": (7.0, "N*s/m")}}
    model = oscillator({"near": own, "far": damper("d")}, {"d": (3.0, "N*s/m")})
    symbols = symbols_of(model)
    assert symbols.within("near")["d", 0] == symbols.p[-1]
    assert symbols.within("far")["d", 0] == symbols.scope["d", 0] == symbols.p[2]
    assert [item.path for item in model.all_parameters()] == ["m", "far", "d", "near.d"]


def test_an_input_stands_for_what_acts() -> None:
    """acting = gain·recorded + offset; the symbol in u is the recorded signal."""
    inputs = {"f": {"unit": "N", "gain": 1.1, "offset": {"value": 0.2, "unit": "N"}}}
    symbols = symbols_of(oscillator({"motor": push("f")}, inputs=inputs))
    gain, offset = symbols.p[-2:]
    assert (gain.name, offset.name) == ("f.gain", "f.offset")
    assert symbols.scope["f", 0] == gain * symbols.u[0] + offset
    assert np.all([symbol.is_real for symbol in (*symbols.q, *symbols.v, *symbols.p)])


def test_elements_that_remember_have_an_inner_state_in_their_order() -> None:
    damped = {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"}
    bent = {"kind": "hysteresis", "on": "x", "stiffness": "k"}
    model = oscillator(
        {"late": damped, "oil": damper("d"), "bent": bent},
        {"k": (5.0, "N/m"), "d": (1.0, "N*s/m")},
    )
    symbols = symbols_of(model)
    assert list(symbols.z) == ["late", "bent"]
    assert [str(z) for states in symbols.z.values() for z in states] == ["z(late)", "z(bent)"]


def test_the_inner_states_of_one_element_stand_side_by_side() -> None:
    load = {"kind": "mode", "on": "x", "mass": "m_h", "frequency": "f_h"}
    model = oscillator({"load": load}, {"m_h": (0.2, "kg"), "f_h": (7.0, "Hz")})
    assert [str(z) for z in symbols_of(model).z["load"]] == ["e(load)", "w(load)"]


def test_readings_of_instruments_are_symbols_until_they_are_lowered() -> None:
    tree = parse_expression("2*force(oil) - reaction(x)*sin(orientation(arm))")
    found = readings(tree)
    assert [str(reading_symbol(r)) for r in found] == [
        "force(oil)",
        "reaction(x)",
        "orientation(arm)",
    ]
    force, reaction, angle = map(reading_symbol, found)
    assert to_sympy(tree, {}) == 2 * force - reaction * sp.sin(angle)
    assert not readings(parse_expression("a*b"))
