"""Maps as SymPy functions of two variables: exact slopes, values of numbers, text for people."""

import numpy as np
import pytest
import sympy as sp
from builders import model_of

from symhyb.laws.surface import Surface, bilinear
from symhyb.mechanics.show import show_equations, text_of
from symhyb.mechanics.tabulated import MappedBase, mapped

MAP = bilinear("pad", [-1.0, 0.0, 2.0], [-1.0, 0.5], [[1.0, 2.0], [0.0, -1.0], [4.0, 3.0]])
X, Y = sp.symbols("x y", real=True)
RNG = np.random.default_rng(3)
AT = RNG.uniform(-2, 3, 200), RNG.uniform(-2, 2, 200)


def values(expression: sp.Expr) -> np.ndarray:
    """The values of an expression whose calls of maps have x and y themselves as arguments."""
    calls = {node: sp.Symbol(f"c{i}") for i, node in enumerate(expression.atoms(MappedBase))}
    assert all(node.args == (X, Y) for node in calls)
    function = sp.lambdify([X, Y, *calls.values()], expression.xreplace(calls))
    return np.asarray(function(*AT, *(node.surface(*AT) for node in calls)))


def test_slopes_are_those_of_the_grid() -> None:
    x, y = AT
    expression = X * Y * mapped(MAP)(X, Y)
    by_x = y * MAP(x, y) + x * y * MAP.slope("x")(x, y)
    assert values(sp.diff(expression, X)) == pytest.approx(by_x)
    by_y = x * MAP(x, y) + x * y * MAP.slope("y")(x, y)
    assert values(sp.diff(expression, Y)) == pytest.approx(by_y)
    crossed = values(sp.diff(mapped(MAP)(X, Y), X, Y))
    assert crossed == pytest.approx(MAP.slope("x").slope("y")(x, y))
    assert sp.diff(mapped(MAP)(X, Y), X, 2) == 0
    chained = sp.diff(mapped(MAP)(X, Y**2), Y)
    assert chained == 2 * Y * mapped(MAP.slope("y"))(X, Y**2)


def test_of_numbers_it_is_a_number() -> None:
    assert float(mapped(MAP)(2, sp.Rational(1, 2))) == pytest.approx(3.0)
    assert mapped(MAP)(X, 1).is_real
    assert isinstance(mapped(MAP)(X, 1), MappedBase)


def test_maps_of_one_name_are_two_functions() -> None:
    other = Surface("pad", MAP.over_x, MAP.over_y, ((1.0, 2.0), (0.0, 0.0), (4.0, 3.0)))
    assert mapped(MAP)(X, Y) == mapped(MAP)(X, Y)
    assert mapped(MAP)(X, Y) - mapped(other)(X, Y) != 0


def test_equations_name_the_map_and_its_slopes() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "n": (2.0, "1")},
        bodies={"mass": {"mass": "m", "at": ["x", "y"]}},
        maps={
            "hill": {
                "units": ["m", "m", "J"],
                "x": [-1, 0, 2],
                "y": [-1, 1],
                "values": [[1, 2], [0, 1], [3, 4]],
                "extrapolation": "hold",
            }
        },
        energy={"potential": "map(hill, x, y)"},
        elements={
            "pad": {
                "kind": "map",
                "on": "x",
                "scale": "n",
                "units": ["mm", "mm/s", "kN"],
                "x": [-1, 2],
                "y": [-3, 4],
                "values": [[1, 2], [3, 4]],
            }
        },
    )
    text, latex = show_equations(model), show_equations(model, latex=True)
    assert "elements.pad      -n*map(elements.pad, x, x')\n" in text
    assert "-map_x(hill, x, y)" in text
    assert "-map_y(hill, x, y)" in text
    said = (
        "3 places from -1 to 2 m by 2 places from -1 to 1 m, in J; bilinear, the last value beyond"
    )
    assert f"map(hill, x, y)          {said}\n" in text
    assert f"% map(hill, x, y): {said}\n" in latex
    assert r"\mathrm{map}\left(\text{elements.pad}, x, \dot{x}\right)" in latex
    assert r"\mathrm{map}_{x}\left(\text{hill}, x, y\right)" in latex
    assert text_of(mapped(MAP.slope("y").slope("x"))(X, Y) ** 2) == "map_xy(pad, x, y)**2"
