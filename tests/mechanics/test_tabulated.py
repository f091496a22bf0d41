"""Curves as SymPy functions: exact slopes, values of numbers, text for people."""

import numpy as np
import pytest
import sympy as sp
from builders import model_of

from symhyb.laws.characteristic import through
from symhyb.mechanics.show import show_equations
from symhyb.mechanics.tabulated import TabulatedBase, tabulated
from symhyb.mechanics.tidy import along

CURVE = through("pad", [-1.0, 0.0, 0.5, 2.0], [-2.0, 0.0, 3.0, 3.5])
X = sp.Symbol("x", real=True)


def values(expression: sp.Expr, at: np.ndarray) -> np.ndarray:
    names = {node.func.__name__: node.characteristic for node in expression.atoms(TabulatedBase)}
    calls = {node: sp.Symbol(f"c{i}") for i, node in enumerate(expression.atoms(TabulatedBase))}
    assert len(names) == len(calls)
    function = sp.lambdify([X, *calls.values()], expression.xreplace(calls))
    inner = [sp.lambdify(X, node.args[0]) for node in calls]
    known = [node.characteristic(f(at)) for node, f in zip(calls, inner, strict=True)]
    return np.asarray(function(at, *known))


def test_slopes_are_those_of_the_pieces() -> None:
    expression = X * tabulated(CURVE)(2 * X)
    at = np.linspace(-2, 2, 401)
    expected = CURVE(2 * at) + 2 * at * CURVE.slope()(2 * at)
    assert values(sp.diff(expression, X), at) == pytest.approx(expected)
    assert values(along({X: sp.Integer(1)})(expression), at) == pytest.approx(expected)
    second = 4 * CURVE.slope()(2 * at) + 4 * at * CURVE.slope().slope()(2 * at)
    assert values(sp.diff(expression, X, 2), at) == pytest.approx(second)


def test_of_a_number_it_is_a_number() -> None:
    assert float(tabulated(CURVE)(sp.Rational(1, 2))) == pytest.approx(3.0)
    assert tabulated(CURVE)(sp.pi).is_Float
    assert tabulated(CURVE)(X).is_real


def test_curves_of_one_name_are_two_functions() -> None:
    other = through("pad", [0.0, 1.0], [0.0, 1.0])
    assert tabulated(CURVE)(X) == tabulated(CURVE)(X)
    assert tabulated(CURVE)(X) != tabulated(other)(X)
    assert tabulated(CURVE)(X) - tabulated(other)(X) != 0


def test_equations_name_the_curve_and_say_what_it_runs_through() -> None:
    pad = {
        "kind": "curve",
        "on": "x",
        "over": "rate",
        "scale": "n",
        "units": ["mm/s", "kN"],
        "points": [[-100, -2], [0, 0], [300, 4]],
        "extrapolation": "hold",
    }
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "n": (2.0, "1")},
        bodies={"mass": {"mass": "m", "at": ["x", "0"]}},
        elements={"pad": pad},
    )
    text, latex = show_equations(model), show_equations(model, latex=True)
    assert "= k_e  elements.pad  -n*curve(elements.pad, x')\n" in text
    said = "3 points from -100 to 300 mm/s, in kN; monotone cubics between them, the last value"
    assert f"curve(elements.pad, .)  {said} beyond" in text
    assert r"\mathrm{curve}\left(\text{elements.pad}, \dot{x}\right)" in latex
    assert f"% curve(elements.pad, .): {said} beyond" in latex
