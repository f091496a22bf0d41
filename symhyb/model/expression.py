"""Expressions of a model file as small trees: parsed by a whitelist, never evaluated as code.

``x'`` and ``x''`` are derivatives of a coordinate, power is ``**``, ``pi`` is a number, ``t`` the
time in s, and a number may have its unit in place (:mod:`symhyb.model.quantities`). Names are
exactly those the model declares; which ones may stand where is checked in
:mod:`symhyb.model.check`. The trees are in :mod:`symhyb.model.trees`, their units in
:mod:`symhyb.model.dimensions`; both are offered here.
"""

import ast
import keyword
import math
import re
import warnings
from collections.abc import Mapping, Sequence
from functools import reduce

from symhyb.errors import did_you_mean
from symhyb.limits import EXPRESSION_DEPTH, EXPRESSION_LETTERS
from symhyb.model.conditions import misplaced, where
from symhyb.model.dimensions import unit_of
from symhyb.model.quantities import MARK, quantities_back, quantities_out
from symhyb.model.trees import (
    FUNCTIONS,
    READINGS,
    Expression,
    ExpressionError,
    Name,
    Node,
    Number,
    Operation,
    Quantity,
    Reading,
    brief,
    evaluate,
    names,
    quantities,
    readings,
    show,
    tables_in,
)

__all__ = [
    "FUNCTIONS",
    "READINGS",
    "RESERVED",
    "Expression",
    "ExpressionError",
    "Name",
    "Node",
    "Number",
    "Operation",
    "Quantity",
    "Reading",
    "evaluate",
    "names",
    "parse_expression",
    "quantities",
    "readings",
    "show",
    "tables_in",
    "unit_of",
]

_ALIASES = {"sgn": "sign"}
RESERVED = frozenset({"t", "pi", *FUNCTIONS, *_ALIASES, *keyword.kwlist})
"""Names that no coordinate, parameter or input may have."""

_PRIME = "\u02b9"  # a letter for Python's parser, and outside the characters a file may use
_ALLOWED = re.compile(r"[A-Za-z0-9_ .,+\-*/()<>='\t\r\n]")
_BINARY: Mapping[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
}


def parse_expression(text: str | float | int) -> Expression:
    """Read an expression such as ``"m*g*l*sin(phi)"``, or take a plain number.

    Raises:
        ExpressionError: anything that is not arithmetic on names and the listed functions; the
            sentence quotes the part that is wrong.
    """
    if isinstance(text, (int, float)):
        size = Number(abs(_number(text).value))
        return Expression(repr(float(text)), size if text >= 0 else Operation("neg", (size,)))
    if len(text) > EXPRESSION_LETTERS:
        raise ExpressionError(
            f"an expression of {len(text)} characters is too long (at most {EXPRESSION_LETTERS})"
        )
    if not text.strip():
        raise ExpressionError("the expression is empty")
    _refuse_characters(text, text, "^")  # which stands in units alone
    plain, found = quantities_out(" ".join(text.split()))
    _refuse_characters(plain, text, MARK)
    tree = _python_tree(plain, text)
    try:
        return Expression(text, _convert(tree, 1, found))
    except ExpressionError as error:
        raise ExpressionError(quantities_back(str(error), found)) from None


def _refuse_characters(some: str, text: str, also: str) -> None:
    for character in some:
        if not _ALLOWED.match(character) and character != also:
            cure = {"^": "; power is '**'", "·": "; a product is '*'"}.get(character, "")
            raise ExpressionError(f"'{character}' is not allowed in '{brief(text)}'{cure}")


def _python_tree(plain: str, text: str) -> ast.expr:
    """Let Python's parser (not its compiler) group what is ``plain``; the whitelist comes after.
    ``text`` is what the person wrote, for the sentences."""
    marked = re.sub(r"([A-Za-z_][A-Za-z0-9_]*)('+)", lambda m: m[1] + _PRIME * len(m[2]), plain)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return ast.parse(marked, mode="eval").body
    except (RecursionError, MemoryError):
        raise ExpressionError(f"'{brief(text)}' is nested too deeply") from None
    except (SyntaxError, ValueError, Warning):
        cure = _cure_of_syntax(text)
        raise ExpressionError(f"'{brief(text)}' is not an expression{cure}") from None


def _cure_of_syntax(text: str) -> str:
    if text.count("(") != text.count(")"):
        return ": the parentheses do not match"
    words = [word for word in re.findall(r"[A-Za-z_]\w*", text) if keyword.iskeyword(word)]
    if words:
        return f": '{words[0]}' is a reserved word"
    return "; write a product as 'a*b' and a derivative as x'"


def _convert(node: ast.expr, depth: int, found: Sequence[Quantity]) -> Node:
    """Turn Python's tree into ours; whatever is not listed here is refused. ``found`` are the
    numbers with units that marked names stand for."""
    if depth > EXPRESSION_DEPTH:
        raise ExpressionError(
            f"the expression is nested too deeply (at most {EXPRESSION_DEPTH} levels)"
        )
    match node:
        case ast.Constant(value=value):
            return _number(value)
        case ast.Name(id=name) if name.startswith(MARK):
            return found[int(name.strip(MARK))]
        case ast.Name(id=name):
            return _name(name)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return Operation("neg", (_convert(operand, depth + 1, found),))
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _convert(operand, depth + 1, found)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            arguments = (_convert(left, depth + 1, found), _convert(right, depth + 1, found))
            return Operation(_BINARY[type(op)], arguments)
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in READINGS:
            return _reading(name, args)
        case ast.Call(func=ast.Name(id="where"), args=args, keywords=[]):
            return where(args, lambda part: _convert(part, depth + 1, found))
        case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
            raise misplaced(_source(node))
        case ast.Call(func=ast.Name(id="curve" | "map" as word), args=args, keywords=[]):
            return _table(word, args, depth, found)
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
            name = _known(name)
            return _call(name, [_convert(argument, depth + 1, found) for argument in args])
    raise ExpressionError(
        f"'{_source(node)}' is not allowed: only numbers, declared names, + - * / ** and functions"
    )


def _number(value: object) -> Number:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ExpressionError(f"'{brief(repr(value))}' is not a number")
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


def _known(name: str) -> str:
    name = _ALIASES.get(name, name)
    if name not in FUNCTIONS:
        known = [*FUNCTIONS, "where", "curve", "map", *READINGS]
        raise ExpressionError(
            f"'{_source(name)}' is not a known function{did_you_mean(name, known)}"
        )
    return name


def _call(name: str, arguments: list[Node]) -> Node:
    if name in ("min", "max") and len(arguments) >= 2:
        return reduce(lambda left, right: Operation(name, (left, right)), arguments)
    if len(arguments) != FUNCTIONS[name]:
        raise ExpressionError(
            f"'{name}' takes {FUNCTIONS[name]} argument{'s' * (FUNCTIONS[name] > 1)},"
            f" not {len(arguments)}"
        )
    return Operation(name, tuple(arguments))


def _table(
    word: str, arguments: list[ast.expr], depth: int, found: Sequence[Quantity]
) -> Operation:
    """Read a curve of the model at a value, or a map at two; its name is no value itself."""
    usage, count = {
        "curve": ("the name of a curve and a value, as in curve(<name>, x)", 1),
        "map": ("the name of a map and two values, as in map(<name>, x, y)", 2),
    }[word]
    match arguments:
        case [ast.Name(id=name), *values] if _PRIME not in name and len(values) == count:
            return Operation(word, tuple(_convert(one, depth + 1, found) for one in values), name)
    raise ExpressionError(f"'{word}' takes {usage}")


def _reading(what: str, arguments: list[ast.expr]) -> Reading:
    """Read the names that an instrument is given; they are not values, so nothing else fits."""
    wanted = READINGS[what]
    usage = f"write {what}({', '.join(f'<{section}>' for section in wanted)})"
    if len(arguments) != len(wanted):
        number = f"{len(wanted)} name{'s' * (len(wanted) > 1)}"
        raise ExpressionError(f"'{what}' takes {number}, not {len(arguments)}; {usage}")
    found: list[str] = []
    for argument in arguments:
        if not isinstance(argument, ast.Name) or _PRIME in argument.id:
            sentence = f"'{what}' takes names, not '{_source(argument)}'; {usage}"
            raise ExpressionError(sentence)
        found.append(argument.id)
    return Reading(what, tuple(found))


def _source(node: ast.expr | str) -> str:
    try:
        text = node if isinstance(node, str) else ast.unparse(node)
    except RecursionError:
        text = "…"
    return brief(text.replace(_PRIME, "'"))
