"""Force laws against their formulas, and their energy class."""

import numpy as np
import pytest
import sympy as sp

from symhyb.mechanics.laws import DEFAULT_TRANSITION, law_of
from symhyb.model.types import Element, On
from symhyb.model.vocabulary import KINDS

S, RATE = sp.symbols("s rate", real=True)
GRID = np.linspace(-0.8, 0.8, 33)


def force(kind: str, **keys: float) -> np.ndarray:
    """F on a grid, of the stretch for springs, else of the rate."""
    values = {key: sp.Float(value) for key, value in keys.items()}
    law = law_of(Element("it", kind, On("x"), ()), S, RATE, values)
    function = sp.lambdify([S, RATE], law.force)
    spring = kind == "spring"
    return np.array([float(function(*((x, 0.0) if spring else (0.3, x)))) for x in GRID])


x = GRID
FORMULAS = [
    ("spring", {"stiffness": 3.0}, 3 * x),
    ("spring", {"quadratic": 2.0, "cubic": -5.0}, 2 * x**2 - 5 * x**3),
    ("damper", {"damping": 4.0}, 4 * x),
    ("damper", {"damping": 4.0, "asymmetry": 0.25}, 4 * x * (1 + 0.25 * np.sign(x))),
    ("drag", {"drag": 0.7}, 0.7 * np.abs(x) * x),
    ("friction", {"coulomb": 2.0, "transition": 0.1}, 2 * np.tanh(x / 0.1)),
    ("friction", {"coulomb": 2.0}, 2 * np.tanh(x / DEFAULT_TRANSITION)),
    (
        "friction",
        {"coulomb": 2.0, "static": 3.0, "stribeck": 0.2, "transition": 0.05},
        (2 + 1.0 * np.exp(-((x / 0.2) ** 2))) * np.tanh(x / 0.05),
    ),
    (
        "friction",
        {"coulomb": 2.0, "transition": 0.1, "asymmetry": -0.4},
        2 * np.tanh(x / 0.1) * (1 - 0.4 * np.sign(x)),
    ),
    ("constant", {"constant": -1.5}, -1.5 + 0 * x),
]


@pytest.mark.parametrize(("kind", "keys", "expected"), FORMULAS)
def test_force_against_its_formula(kind: str, keys: dict[str, float], expected: np.ndarray) -> None:
    assert force(kind, **keys) == pytest.approx(expected, abs=1e-12)
    if KINDS[kind].energy == "dissipative":
        assert np.all(force(kind, **keys) * GRID >= 0)


def test_what_a_spring_stores_is_the_integral_of_its_force() -> None:
    values = dict(zip(("stiffness", "quadratic", "cubic"), sp.symbols("a b c"), strict=True))
    law = law_of(Element("it", "spring", On("x"), ()), S, RATE, values)
    assert sp.expand(sp.diff(law.stored, S) - law.force) == 0
    assert law.stored.subs(S, 0) == 0


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "spring"])
def test_other_kinds_store_nothing(kind: str) -> None:
    one = {KINDS[kind].strengths[0]: sp.Integer(1)}
    assert law_of(Element("it", kind, On("x"), ()), S, RATE, one).stored == 0


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(TypeError, match="glue"):
        law_of(Element("it", "glue", On("x"), ()), S, RATE, {})
