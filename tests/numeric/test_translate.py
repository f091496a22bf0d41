"""SymPy lowered to CasADi: every function of the language, each shared node once."""

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from builders import double_pendulum, value

from symhyb.mechanics.equations import derive
from symhyb.mechanics.symbols import to_sympy
from symhyb.model.expression import evaluate, parse_expression
from symhyb.numeric.lowered.translate import Lowered, Lowering

TEXTS = [
    "sin(a)",
    "cos(a)",
    "tan(a)",
    "asin(a)",
    "acos(a)",
    "atan(a)",
    "atan2(b, a)",
    "sinh(a)",
    "cosh(a)",
    "tanh(a)",
    "exp(a)",
    "log(a)",
    "sqrt(a)",
    "abs(b)",
    "sign(b)",
    "min(a, b, 0.1)",
    "max(a, b, 0.1)",
    "a**b",
    "a**-1",
    "1/sqrt(a)",
    "a**3",
    "a**-3",
    "a**9",
    "a**2.5",
    "2**a",
    "a - b/a*0.7",
    "pi*a",
    "-b",
    "a**0.5*b + a*b + 3",
]


@pytest.mark.parametrize("text", TEXTS)
def test_lowered_expressions_have_the_value_of_the_text(text: str) -> None:
    names = sp.symbols("a b", real=True)
    symbols = [ca.SX.sym("a"), ca.SX.sym("b")]
    scope = {(name.name, 0): name for name in names}
    lowered = Lowering(dict(zip(names, symbols, strict=True)))(
        to_sympy(parse_expression(text), scope)
    )
    function = ca.Function("f", symbols, [lowered])
    for a, b in ((0.3, -1.7), (0.9, 0.4)):
        expected = evaluate(parse_expression(text).tree, {"a": a, "b": b})
        assert value(function, a, b) == pytest.approx(float(expected), rel=1e-14)


def test_what_sympy_holds_in_another_form_is_lowered_too() -> None:
    x = sp.Symbol("x", real=True)
    column = ca.SX.sym("x")
    lowered = Lowering({x: column})(sp.sqrt(x**2) + sp.pi * sp.Rational(1, 3) + sp.E)
    assert value(ca.Function("f", [column], [lowered]), -2.0) == pytest.approx(
        2.0 + np.pi / 3 + np.e
    )


def test_an_unknown_function_is_refused_by_name() -> None:
    x = sp.Symbol("x", real=True)
    with pytest.raises(TypeError, match="gamma"):
        Lowering({x: ca.SX.sym("x")})(sp.gamma(x))


def test_shared_nodes_are_lowered_once() -> None:
    """CasADi does not look for repetitions; a sine that occurs three times is to be one node."""
    x = sp.Symbol("x", real=True)
    column = ca.SX.sym("x")
    lowered = Lowering({x: column})(sp.exp(sp.sin(x)) + sp.cosh(sp.sin(x)) + sp.tanh(sp.sin(x)))
    function = ca.Function("f", [column], [lowered])
    operations = [function.instruction_id(i) for i in range(function.n_instructions())]
    assert operations.count(ca.OP_SIN) == 1


def test_the_equations_of_a_machine_keep_their_shapes() -> None:
    low = Lowered(derive(double_pendulum()))
    assert low.q.shape == low.v.shape == low.a.shape == (2, 1)
    assert low.u.shape == (0, 1)
    assert low.p.shape == (5, 1)
    assert low.outputs(ca.SX(2, 1), ["alpha", "beta"]).shape == (0, 1)
    assert low.z.shape == low.inner.shape == low.rest.shape == (0, 1)
    assert (low.forces, low.stored, low.pathways, low.strengths) == ([], [], [], {})
