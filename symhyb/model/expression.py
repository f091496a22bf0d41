"""Expressions of a model file as small trees: parsed by a whitelist, never evaluated as code.

``x'`` and ``x''`` are derivatives of a coordinate, power is ``**``, ``pi`` is a number and ``t``
the time in s. Names are exactly those the model declares; which ones may stand where is checked
in :mod:`symhyb.model.check`.
"""

import ast
import keyword
import math
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import did_you_mean
from symhyb.units import ONE, Unit, UnitError

LONGEST = 2000
DEEPEST = 60
FUNCTIONS: Mapping[str, int] = {
    "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1, "atan2": 2,
    "sinh": 1, "cosh": 1, "tanh": 1, "exp": 1, "log": 1, "sqrt": 1, "abs": 1, "sign": 1,
    "min": 2, "max": 2,
}  # fmt: skip
_ALIASES = {"sgn": "sign"}
RESERVED = frozenset({"t", "pi", *FUNCTIONS, *_ALIASES, *keyword.kwlist})
"""Names that no coordinate, parameter or input may have."""

_PRIME = "\u02b9"  # a letter for Python's parser, and outside the characters a file may use
_ALLOWED = re.compile(r"[A-Za-z0-9_ .,+\-*/()'\t\r\n]")
_BINARY: Mapping[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**",
}  # fmt: skip


class ExpressionError(ValueError):
    """A text that is no expression, or units that do not fit; the message is a sentence."""


@dataclass(frozen=True, slots=True)
class Number:
    """A literal number."""

    value: float


@dataclass(frozen=True, slots=True)
class Name:
    """A declared name; ``order`` counts the primes (``x'`` 1, ``x''`` 2)."""

    name: str
    order: int = 0

    def __str__(self) -> str:
        return self.name + "'" * self.order


@dataclass(frozen=True, slots=True)
class Operation:
    """``+ - * / **`` with two arguments, ``neg`` with one, or a function of :data:`FUNCTIONS`."""

    operator: str
    arguments: tuple["Node", ...]


Node = Number | Name | Operation


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression as written (``text``) and as understood (``tree``)."""

    text: str
    tree: Node

    def __str__(self) -> str:
        return self.text


# ---------------------------------------------------------------------------------- reading


def parse_expression(text: str | float | int) -> Expression:
    """Read an expression such as ``"m*g*l*sin(phi)"``, or take a plain number.

    Raises:
        ExpressionError: anything that is not arithmetic on names and the listed functions; the
            sentence quotes the part that is wrong.
    """
    if isinstance(text, (int, float)):
        size = Number(abs(_number(text).value))
        return Expression(repr(float(text)), size if text >= 0 else Operation("neg", (size,)))
    if len(text) > LONGEST:
        raise ExpressionError(
            f"an expression of {len(text)} characters is too long (at most {LONGEST})"
        )
    if not text.strip():
        raise ExpressionError("the expression is empty")
    _refuse_characters(text)
    return Expression(text, _convert(_python_tree(" ".join(text.split())), 1))


def _refuse_characters(text: str) -> None:
    for character in text:
        if not _ALLOWED.match(character):
            cure = {"^": "; power is '**'", "·": "; a product is '*'"}.get(character, "")
            raise ExpressionError(f"'{character}' is not allowed in '{_short(text)}'{cure}")


def _python_tree(text: str) -> ast.expr:
    """Let Python's parser (not its compiler) group the text; the whitelist comes after."""
    marked = re.sub(r"([A-Za-z_][A-Za-z0-9_]*)('+)", lambda m: m[1] + _PRIME * len(m[2]), text)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return ast.parse(marked, mode="eval").body
    except (RecursionError, MemoryError):
        raise ExpressionError(f"'{_short(text)}' is nested too deeply") from None
    except (SyntaxError, ValueError, Warning):
        cure = _cure_of_syntax(text)
        raise ExpressionError(f"'{_short(text)}' is not an expression{cure}") from None


def _cure_of_syntax(text: str) -> str:
    if text.count("(") != text.count(")"):
        return ": the parentheses do not match"
    words = [word for word in re.findall(r"[A-Za-z_]\w*", text) if keyword.iskeyword(word)]
    if words:
        return f": '{words[0]}' is a reserved word"
    return "; write a product as 'a*b' and a derivative as x'"


def _convert(node: ast.expr, depth: int) -> Node:
    """Turn Python's tree into ours; whatever is not listed here is refused."""
    if depth > DEEPEST:
        raise ExpressionError(f"the expression is nested too deeply (at most {DEEPEST} levels)")
    match node:
        case ast.Constant(value=value):
            return _number(value)
        case ast.Name(id=name):
            return _name(name)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return Operation("neg", (_convert(operand, depth + 1),))
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _convert(operand, depth + 1)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            arguments = (_convert(left, depth + 1), _convert(right, depth + 1))
            return Operation(_BINARY[type(op)], arguments)
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
            return _call(name, [_convert(argument, depth + 1) for argument in args])
    raise ExpressionError(
        f"'{_source(node)}' is not allowed: only numbers, declared names, + - * / ** and functions"
    )


def _number(value: object) -> Number:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ExpressionError(f"'{_short(repr(value))}' is not a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ExpressionError("a number is not finite")
    return Number(number)


def _name(name: str) -> Node:
    plain = name.rstrip(_PRIME)
    order = len(name) - len(plain)
    if _PRIME in plain:
        raise ExpressionError(f"{_source(name)}: a prime stands at the end of a name")
    if order > 2:
        raise ExpressionError(f"{_source(name)}: the second derivative is the highest")
    if plain in FUNCTIONS or plain in _ALIASES:
        raise ExpressionError(f"the function '{plain}' needs its arguments, as in '{plain}(x)'")
    if plain == "pi" and order == 0:
        return Number(math.pi)
    return Name(plain, order)


def _call(name: str, arguments: list[Node]) -> Node:
    name = _ALIASES.get(name, name)
    if name not in FUNCTIONS:
        raise ExpressionError(
            f"'{_source(name)}' is not a known function{did_you_mean(name, list(FUNCTIONS))}"
        )
    if name in ("min", "max") and len(arguments) >= 2:
        return reduce(lambda left, right: Operation(name, (left, right)), arguments)
    if len(arguments) != FUNCTIONS[name]:
        raise ExpressionError(
            f"'{name}' takes {FUNCTIONS[name]} argument{'s' * (FUNCTIONS[name] > 1)},"
            f" not {len(arguments)}"
        )
    return Operation(name, tuple(arguments))


def _source(node: ast.expr | str) -> str:
    try:
        text = node if isinstance(node, str) else ast.unparse(node)
    except RecursionError:
        text = "…"
    return _short(text.replace(_PRIME, "'"))


def _short(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= 60 else text[:57] + "…"


# ---------------------------------------------------------------------------------- using


def names(expression: Expression | Node) -> frozenset[Name]:
    """Return every name that occurs, with its order."""
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Name():
            return frozenset({tree})
        case Operation(_, arguments):
            return frozenset().union(*(names(argument) for argument in arguments))
    return frozenset()


_NUMPY: Mapping[str, Callable[..., NDArray[np.float64]]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "**": np.power,
    "neg": np.negative, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin,
    "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "sinh": np.sinh, "cosh": np.cosh,
    "tanh": np.tanh, "exp": np.exp, "log": np.log, "sqrt": np.sqrt, "abs": np.abs,
    "sign": np.sign, "min": np.minimum, "max": np.maximum,
}  # fmt: skip


def evaluate(
    expression: Expression | Node,
    values: Mapping[tuple[str, int] | str, NDArray[np.float64] | float],
) -> NDArray[np.float64]:
    """Compute an expression with NumPy; ``x'`` is looked up as ``("x", 1)``.

    ``values`` are numbers or arrays of one shape, (N,), in SI units; the result has that shape and
    is in SI, too. What has no value (log of −1, overflow) becomes NaN or infinity, without a
    warning.

    Raises:
        KeyError: a name without a value.
    """
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Number(value):
            return np.asarray(value, dtype=np.float64)
        case Name(name, order):
            key: tuple[str, int] | str = (name, order)
            return np.asarray(values[name if order == 0 and name in values else key], np.float64)
        case Operation(operator, arguments):
            with np.errstate(all="ignore"):
                return _NUMPY[operator](*(evaluate(argument, values) for argument in arguments))


_STRENGTH = {"+": 1, "-": 1, "*": 2, "/": 2, "neg": 3, "**": 4}


def show(tree: Node) -> str:
    """Write a tree as text that :func:`parse_expression` reads back to the same values."""
    match tree:
        case Number(value):
            return f"{value:.12g}" if float(f"{value:.12g}") == value else repr(value)
        case Name():
            return str(tree)
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
    negative = isinstance(tree, Number) and tree.value < 0 and strength > 1
    return f"({show(tree)})" if weak or negative else show(tree)


# ---------------------------------------------------------------------------------- units


def unit_of(expression: Expression | Node, units: Callable[[Name], Unit]) -> Unit | None:
    """Return the unit of an expression, None for a literal 0, which fits every unit.

    Raises:
        ExpressionError: a sum of different dimensions, a function of a number with a unit, a power
            that is not a plain number.
    """
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Number(value):
            return None if value == 0 else ONE
        case Name():
            return units(tree)
        case Operation(operator, arguments):
            found = tuple(unit_of(argument, units) for argument in arguments)
            try:
                return _combined(operator, arguments, found)
            except UnitError as error:
                sentence = f"'{_short(show(tree))}' has no readable unit: {error}"
                raise ExpressionError(sentence) from None


def _combined(
    operator: str, arguments: tuple[Node, ...], found: tuple[Unit | None, ...]
) -> Unit | None:
    match operator:
        case "neg" | "abs":
            return found[0]
        case "+" | "-" | "min" | "max":
            return _alike(operator, arguments, found)
        case "*" | "/":
            left, right = (unit or ONE for unit in found)
            return left * right if operator == "*" else left / right
        case "**":
            return _power(arguments, found)
        case "sqrt":
            return None if found[0] is None else found[0] ** Fraction(1, 2)
        case "atan2":
            _alike(operator, arguments, found)
            return ONE
        case "sign":
            return ONE
    if found[0] is not None and not found[0].is_number:
        raise ExpressionError(
            f"{operator}() needs a plain number, but '{_short(show(arguments[0]))}'"
            f" is in {found[0]}"
        )
    return ONE


def _alike(
    operator: str, arguments: tuple[Node, ...], found: tuple[Unit | None, ...]
) -> Unit | None:
    left, right = found
    if left is not None and right is not None and not left.same_dimension(right):
        verb = {"+": "adds", "-": "subtracts"}.get(operator, f"{operator}() compares")
        first, second = (_short(show(argument)) for argument in arguments)
        raise ExpressionError(f"{verb} '{first}' in {left} and '{second}' in {right}")
    return left if left is not None else right


def _power(arguments: tuple[Node, ...], found: tuple[Unit | None, ...]) -> Unit | None:
    base, exponent = found
    if exponent is not None and not exponent.is_number:
        raise ExpressionError(
            f"the power '{_short(show(arguments[1]))}' is in {exponent}; it must be a plain number"
        )
    if base is None or base == ONE:
        return base
    constant = not names(arguments[1])
    value = float(evaluate(arguments[1], {})) if constant else math.nan
    if constant and math.isfinite(value) and abs(value) <= 20:
        fraction = Fraction(value).limit_denominator(12)
        if abs(fraction - Fraction(value)) < 1e-9:
            return base**fraction
    if base.is_number:
        return ONE
    raise ExpressionError(
        f"'{_short(show(arguments[0]))}' is in {base}, so its power must be a whole number"
        f" or a simple fraction, not '{_short(show(arguments[1]))}'"
    )
