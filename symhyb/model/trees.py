"""Expressions as small trees: what they are made of, their names, their value, their text."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.units import Unit

FUNCTIONS: Mapping[str, int] = {
    "sin": 1,
    "cos": 1,
    "tan": 1,
    "asin": 1,
    "acos": 1,
    "atan": 1,
    "atan2": 2,
    "sinh": 1,
    "cosh": 1,
    "tanh": 1,
    "exp": 1,
    "log": 1,
    "sqrt": 1,
    "abs": 1,
    "sign": 1,
    "min": 2,
    "max": 2,
}
READINGS: Mapping[str, tuple[str, ...]] = {
    "position_x": ("point",),
    "position_y": ("point",),
    "position_z": ("point",),
    "distance": ("point", "point"),
    "direction": ("point", "point"),
    "orientation": ("body",),
    "gyroscope": ("body",),
    "gyroscope_x": ("body",),
    "gyroscope_y": ("body",),
    "gyroscope_z": ("body",),
    "accelerometer_x": ("point", "body"),
    "accelerometer_y": ("point", "body"),
    "accelerometer_z": ("point", "body"),
    "force": ("element",),
    "reaction": ("coordinate",),
}
"""What sensors may measure besides expressions, and of what: names of those sections. As they are
called with parentheses, a parameter may have the same name."""


class ExpressionError(ValueError):
    """A text that is no expression, or units that do not fit; the message is a sentence."""


@dataclass(frozen=True, slots=True)
class Number:
    """A literal number."""

    value: float


@dataclass(frozen=True, slots=True)
class Quantity:
    """A literal number with its ``unit`` in place, as in ``2 kg``; its ``value`` is in SI."""

    value: float
    unit: Unit

    def __str__(self) -> str:
        return f"{_digits(self.value / self.unit.factor)} {self.unit}"


@dataclass(frozen=True, slots=True)
class Name:
    """A declared name; ``order`` counts the primes (``x'`` 1, ``x''`` 2)."""

    name: str
    order: int = 0

    def __str__(self) -> str:
        return self.name + "'" * self.order


@dataclass(frozen=True, slots=True)
class Operation:
    """``+ - * / **`` with two arguments, ``neg`` with one, a function of ``FUNCTIONS``, or
    ``curve`` with one and ``map`` with two: the ``table`` of the model that has this name, a curve
    or a map, at that value or those."""

    operator: str
    arguments: tuple["Node", ...]
    table: str = ""


@dataclass(frozen=True, slots=True)
class Reading:
    """What an instrument at named places shows, e.g. ``distance(a, b)``: a function of
    ``READINGS``. Only sensors may use it."""

    what: str
    names: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.what}({', '.join(self.names)})"


Node = Number | Quantity | Name | Operation | Reading


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression as written (``text``) and as understood (``tree``)."""

    text: str
    tree: Node

    def __str__(self) -> str:
        return self.text


def names(expression: Expression | Node) -> frozenset[Name]:
    """Return every name of a value that occurs, with its order; those that a reading is given are
    names of places, and not among them."""
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Name():
            return frozenset({tree})
        case Operation(_, arguments):
            return frozenset().union(*(names(argument) for argument in arguments))
    return frozenset()


def readings(expression: Expression | Node) -> tuple[Reading, ...]:
    """Return every reading that occurs, in the order of the text, each once."""
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Reading():
            return (tree,)
        case Operation(_, arguments):
            found = (reading for argument in arguments for reading in readings(argument))
            return tuple(dict.fromkeys(found))
    return ()


def tables_in(expression: Expression | Node) -> tuple[tuple[str, str], ...]:
    """Return the word (curve or map) and the name of every curve and map that occurs, in the order
    of the text, each once."""
    tree = expression.tree if isinstance(expression, Expression) else expression
    if not isinstance(tree, Operation):
        return ()
    inner = (found for argument in tree.arguments for found in tables_in(argument))
    own = [(tree.operator, tree.table)] if tree.table else []
    return tuple(dict.fromkeys([*own, *inner]))


_NUMPY: Mapping[str, Callable[..., NDArray[np.float64]]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "**": np.power,
    "neg": np.negative,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "exp": np.exp,
    "log": np.log,
    "sqrt": np.sqrt,
    "abs": np.abs,
    "sign": np.sign,
    "min": np.minimum,
    "max": np.maximum,
}


Tables = Mapping[tuple[str, str], Callable[..., NDArray[np.float64]]]
"""Curves and maps as functions of arrays, SI, by the word that calls them and their name."""
NO_TABLES: Tables = {}


def evaluate(
    expression: Expression | Node,
    values: Mapping[tuple[str, int] | str, NDArray[np.float64] | float],
    tables: Tables = NO_TABLES,
) -> NDArray[np.float64]:
    """Compute an expression with NumPy; ``x'`` is looked up as ``("x", 1)``.

    ``values`` are numbers or arrays of one shape, (N,), in SI units; the result has that shape and
    is in SI, too. ``tables`` are the curves and maps of the model. What has no value
    (log of −1, overflow) becomes NaN or infinity, without a warning.

    Raises:
        KeyError: a name without a value, or a curve or a map that is not there.
        ExpressionError: a reading, which only the equations of a machine can give.
    """
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Number(value) | Quantity(value, _):
            return np.asarray(value, dtype=np.float64)
        case Name(name, order):
            key: tuple[str, int] | str = (name, order)
            return np.asarray(values[name if order == 0 and name in values else key], np.float64)
        case Operation("curve" | "map" as word, arguments, name):
            return tables[word, name](*(evaluate(part, values, tables) for part in arguments))
        case Operation(operator, arguments):
            with np.errstate(all="ignore"):
                return _NUMPY[operator](*(evaluate(part, values, tables) for part in arguments))
        case Reading():
            raise ExpressionError(f"'{tree}' is what a sensor shows; it has no value here")


_STRENGTH = {"+": 1, "-": 1, "*": 2, "/": 2, "neg": 3, "**": 4}


def show(tree: Node) -> str:
    """Write a tree as text that :func:`parse_expression` reads back to the same values."""
    match tree:
        case Number(value):
            return _digits(value)
        case Name() | Reading() | Quantity():
            return str(tree)
        case Operation("curve" | "map" as word, arguments, name):
            return f"{word}({', '.join((name, *map(show, arguments)))})"
        case Operation("neg", (argument,)):
            return "-" + _inside(argument, 3)
        case Operation("**", (base, power)):
            return f"{_inside(base, 5)}**{_inside(power, 4)}"
        case Operation(operator, (left, right)) if operator in _STRENGTH:
            strength = _STRENGTH[operator]
            sign = f" {operator} " if strength == 1 else operator
            return f"{_inside(left, strength)}{sign}{_inside(right, strength + 1)}"
        case Operation(operator, arguments):
            return f"{operator}({', '.join(show(argument) for argument in arguments)})"


def _inside(tree: Node, strength: int) -> str:
    weak = isinstance(tree, Operation) and _STRENGTH.get(tree.operator, 9) < strength
    weak = weak or (isinstance(tree, Quantity) and strength > 1)
    negative = isinstance(tree, Number) and tree.value < 0 and strength > 1
    return f"({show(tree)})" if weak or negative else show(tree)


def _digits(value: float) -> str:
    return f"{value:.12g}" if float(f"{value:.12g}") == value else repr(value)


def quantities(expression: Expression | Node) -> tuple[Quantity, ...]:
    """Return every number with a unit in place, in the order of the text."""
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Quantity():
            return (tree,)
        case Operation(_, arguments):
            return tuple(one for argument in arguments for one in quantities(argument))
    return ()


def brief(text: str) -> str:
    """Cut a text for a sentence."""
    text = " ".join(text.split())
    return text if len(text) <= 60 else text[:57] + "…"
