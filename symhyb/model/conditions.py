"""Conditions in expressions: ``where(x > 2 mm and not v < 0, a, b)`` in terms of sign(...).

    where(c, a, b) = c·a + (1 − c)·b        l > r:  c = (1 + sign(l − r))/2, ½ where both are equal
                                            p and q:  c = p·q,   not p:  1 − p

So a condition switches as sign(...) does, in runs, in exports and where something smooth is needed.
A condition stands twice in the tree; one within another would double that again, and is refused.
"""

import ast
from collections.abc import Callable, Iterable
from functools import reduce
from itertools import pairwise

from symhyb.model.trees import ExpressionError, Node, Number, Operation, brief

_USAGE = (
    "'where' takes a comparison with < or >, some of them joined by and, or, not, and two values, "
    "as in where(x > 2 mm, a, b)"
)
_ZERO, _ONE, _TWO = Number(0.0), Number(1.0), Number(2.0)
Reader = Callable[[ast.expr], Node]
"""What turns a part of an expression into a tree."""


def where(arguments: list[ast.expr], read: Reader) -> Node:
    """The tree of ``where`` with these arguments.

    Raises:
        ExpressionError: not three of them, or the first is no condition.
    """
    if len(arguments) != 3:
        raise ExpressionError(f"{_USAGE}; here it has {len(arguments)} arguments")
    if any(isinstance(part, ast.Name) and part.id == "where" for part in ast.walk(arguments[0])):
        raise ExpressionError("a condition of 'where' holds no other 'where'; join them by and, or")
    condition = _condition(arguments[0], read)
    yes, no = map(read, arguments[1:])
    parts = [(condition, yes), (_opposite(condition), no)]
    used = [_times(share, value) for share, value in parts if value != _ZERO]
    return reduce(lambda left, right: Operation("+", (left, right)), used) if used else _ZERO


def _condition(node: ast.expr, read: Reader) -> Node:
    """1 where a condition holds, 0 where it does not."""
    match node:
        case ast.Compare(left=left, ops=orders, comparators=others):
            sides = [read(part) for part in (left, *others)]
            return _all(
                _order(order, *pair) for order, pair in zip(orders, pairwise(sides), strict=True)
            )
        case ast.BoolOp(op=ast.And(), values=values):
            return _all(_condition(value, read) for value in values)
        case ast.BoolOp(op=ast.Or(), values=values):
            return _opposite(_all(_opposite(_condition(value, read)) for value in values))
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return _opposite(_condition(operand, read))
    raise ExpressionError(_USAGE)


def _order(order: ast.cmpop, left: Node, right: Node) -> Node:
    if isinstance(order, ast.Gt | ast.GtE):
        above = Operation("-", (left, right))
    elif isinstance(order, ast.Lt | ast.LtE):
        above = Operation("-", (right, left))
    else:
        raise ExpressionError(f"{_USAGE}; two values are never exactly equal")
    return Operation("/", (Operation("+", (_ONE, Operation("sign", (above,)))), _TWO))


def _opposite(condition: Node) -> Node:
    return Operation("-", (_ONE, condition))


def _all(conditions: Iterable[Node]) -> Node:
    return reduce(_times, conditions)


def _times(left: Node, right: Node) -> Node:
    return Operation("*", (left, right))


def misplaced(text: str) -> ExpressionError:
    """What is wrong with a comparison that is no condition of ``where``."""
    return ExpressionError(f"'{brief(text)}' stands in no where(...); {_USAGE}")
