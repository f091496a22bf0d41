"""Plain SymPy symbols for what a model declares, and expressions turned into SymPy.

Coordinates and their derivatives are independent symbols (not functions of t), so that
nothing is ever differentiated through time by SymPy; see docs/design.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

import sympy as sp

from symhyb.mechanics.tabulated import mapped, tabulated
from symhyb.model.expression import Expression, Name, Node, Number, Operation, Quantity, Reading
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS

_FUNCTIONS = {
    "sin": sp.sin,
    "cos": sp.cos,
    "tan": sp.tan,
    "asin": sp.asin,
    "acos": sp.acos,
    "atan": sp.atan,
    "atan2": sp.atan2,
    "sinh": sp.sinh,
    "cosh": sp.cosh,
    "tanh": sp.tanh,
    "exp": sp.exp,
    "log": sp.log,
    "sqrt": sp.sqrt,
    "abs": sp.Abs,
    "sign": sp.sign,
    "min": sp.Min,
    "max": sp.Max,
}


CURVE, MAP = -1, -2  # in place of the order of a name: the function of a curve or a map


@dataclass(frozen=True, slots=True)
class Symbols:
    """The symbols of one model: q, v = q', a = q'' (n each), declared ``states``, the inner states
    z of elements that have some (by name of the element), u (k), p (P, in the order of
    :meth:`Model.all_parameters`), time t; ``scope`` resolves names of the shared namespace,
    curves and maps, ``owned`` the parameters of one element."""

    q: tuple[sp.Symbol, ...]
    v: tuple[sp.Symbol, ...]
    a: tuple[sp.Symbol, ...]
    states: tuple[sp.Symbol, ...]
    z: Mapping[str, tuple[sp.Symbol, ...]]
    u: tuple[sp.Symbol, ...]
    p: tuple[sp.Symbol, ...]
    t: sp.Symbol
    scope: Mapping[tuple[str, int], sp.Expr]
    owned: Mapping[str, Mapping[tuple[str, int], sp.Expr]]

    @property
    def remembered(self) -> tuple[sp.Symbol, ...]:
        """All that follows from a rate of first order, as in the state of a machine: declared
        states come first, so that an element more moves none."""
        return (*self.states, *chain.from_iterable(self.z.values()))

    def within(self, element: str) -> Mapping[tuple[str, int], sp.Expr]:
        """The names as an element sees them: its own parameters before the model's."""
        return {**self.scope, **self.owned.get(element, {})}


def symbols_of(model: Model) -> Symbols:
    """Make the symbols of a model; inputs stand for the *acting* signal (gain and offset
    applied), so that ``u`` is always what was recorded."""
    q = tuple(_real(c.name) for c in model.coordinates)
    v = tuple(_real(c.name + "'") for c in model.coordinates)
    a = tuple(_real(c.name + "''") for c in model.coordinates)
    z = {
        e.name: tuple(_real(f"{state.name}({e.name})") for state in KINDS[e.kind].states)
        for e in model.elements
        if KINDS[e.kind].states
    }
    states = tuple(_real(state.name) for state in model.states)
    u = tuple(_real(i.name) for i in model.inputs)
    p = {parameter.path: _real(parameter.path) for parameter in model.all_parameters()}
    t = _real("t")
    scope: dict[tuple[str, int], sp.Expr] = {("t", 0): t}
    for order, row in enumerate((q, v, a)):
        scope.update({(c.name, order): s for c, s in zip(model.coordinates, row, strict=True)})
    scope.update({(state.name, 0): state for state in states})
    scope.update({(parameter.name, 0): p[parameter.path] for parameter in model.parameters})
    for item, recorded in zip(model.inputs, u, strict=True):
        gain = p[item.gain.path] if item.gain else sp.Integer(1)
        offset = p[item.offset.path] if item.offset else sp.Integer(0)
        scope[item.name, 0] = gain * recorded + offset
    scope.update({(curve.name, CURVE): tabulated(curve.characteristic) for curve in model.curves})
    scope.update({(item.name, MAP): mapped(item.surface) for item in model.maps})
    owned = {
        element.name: {(own.name, 0): p[own.path] for own in element.parameters}
        for element in model.elements
    }
    return Symbols(q, v, a, states, z, u, tuple(p.values()), t, scope, owned)


def to_sympy(expression: Expression | Node, scope: Mapping[tuple[str, int], sp.Expr]) -> sp.Expr:
    """Turn a parsed expression into SymPy; nothing is evaluated by name, so a model file cannot
    reach code. Numbers stay floats except small integer exponents.

    Raises:
        KeyError: a name that ``scope`` lacks (the checker reports those before).
    """
    node = expression.tree if isinstance(expression, Expression) else expression
    match node:
        case Number(value):
            return _number(value)
        case Quantity(value, _):
            return sp.Float(value)
        case Name(name, order):
            return scope[name, order]
        case Operation("curve" | "map" as word, arguments, name):
            function = scope[name, CURVE if word == "curve" else MAP]
            return function(*(to_sympy(argument, scope) for argument in arguments))
        case Operation(operator, arguments):
            return _operation(operator, [to_sympy(item, scope) for item in arguments])
        case Reading():
            return reading_symbol(node)
    raise TypeError(f"not an expression: {node!r}")


def reading_symbol(reading: Reading) -> sp.Symbol:
    """The symbol that stands for an instrument until the equations are lowered."""
    return _real(f"{reading.what}({', '.join(reading.names)})")


def _operation(operator: str, parts: list[sp.Expr]) -> sp.Expr:
    match operator, parts:
        case "+", [x, y]:
            return x + y
        case "-", [x, y]:
            return x - y
        case "*", [x, y]:
            return x * y
        case "/", [x, y]:
            return x / y
        case "**", [x, y] if x.is_Number and y.is_Number:
            return _number(_power(float(x), float(y)))
        case "**", [x, y]:
            return x**y
        case "neg", [x]:
            return -x
        case name, _:
            value = _FUNCTIONS[name](*parts)
            plain = all(part.is_number for part in parts)
            return sp.nan if plain and not value.is_real else value  # sqrt(-1) is no number here
    raise TypeError(f"not an operation: {operator}")


def _power(base: float, exponent: float) -> float:
    """A power of numbers as numbers, NaN where there is none: SymPy would write 9**9**9 out."""
    try:
        value = base**exponent
    except (OverflowError, ZeroDivisionError):
        return float("nan")
    return value if isinstance(value, float) else float("nan")


def _number(value: float) -> sp.Expr:
    if abs(value) <= 64 and value == int(value):
        return sp.Integer(int(value))
    return sp.Float(value)


def _real(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)
