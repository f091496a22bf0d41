"""The units of expressions: what a tree has, from the units of its names."""

import math
from collections.abc import Callable
from fractions import Fraction

from symhyb.model.trees import (
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
    readings,
    show,
    tables_in,
)
from symhyb.units import ONE, Unit, UnitError


def unit_of(
    expression: Expression | Node,
    units: Callable[[Name], Unit],
    shown: Callable[[Reading], Unit] | None = None,
    tables: Callable[[str, str], tuple[Unit, ...]] | None = None,
) -> Unit | None:
    """Return the unit of an expression, None for a literal 0, which fits every unit.

    ``units`` gives the unit of a name, ``shown`` that of a reading, ``tables`` those of
    a curve or a map, by the word that calls it and its name: what it takes, then what it gives.

    Raises:
        ExpressionError: a sum of different dimensions, a function of a number with a unit, a power
            that is not a plain number, a reading where ``shown`` is None, a curve or a map of other
            units or where ``tables`` is None.
    """
    tree = expression.tree if isinstance(expression, Expression) else expression
    match tree:
        case Number(value):
            return None if value == 0 else ONE
        case Quantity(_, unit):
            return unit
        case Name():
            return units(tree)
        case Reading():
            if shown is None:
                raise ExpressionError(f"only sensors may use {tree}")
            return shown(tree)
        case Operation(operator, arguments):
            found = tuple(unit_of(argument, units, shown, tables) for argument in arguments)
            if tree.table:
                return _of_table(tree, found, tables)
            try:
                return _combined(operator, arguments, found)
            except UnitError as error:
                sentence = f"'{brief(show(tree))}' has no readable unit: {error}"
                raise ExpressionError(sentence) from None


def _of_table(
    tree: Operation,
    found: tuple[Unit | None, ...],
    tables: Callable[[str, str], tuple[Unit, ...]] | None,
) -> Unit:
    if tables is None:
        raise ExpressionError(f"{tree.operator}({tree.table}, …) stands in a model file alone")
    *wanted, result = tables(tree.operator, tree.table)
    for argument, unit, needed in zip(tree.arguments, found, wanted, strict=True):
        if unit is not None and not unit.same_dimension(needed):
            said = f"takes {needed}, but '{brief(show(argument))}' is in {unit}"
            raise ExpressionError(f"the {tree.operator} '{tree.table}' {said}")
    return result


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
            f"{operator}() needs a plain number, but '{brief(show(arguments[0]))}' is in {found[0]}"
        )
    return ONE


def _alike(
    operator: str, arguments: tuple[Node, ...], found: tuple[Unit | None, ...]
) -> Unit | None:
    left, right = found
    if left is not None and right is not None and not left.same_dimension(right):
        verb = {"+": "adds", "-": "subtracts"}.get(operator, f"{operator}() compares")
        first, second = (brief(show(argument)) for argument in arguments)
        raise ExpressionError(f"{verb} '{first}' in {left} and '{second}' in {right}")
    return left if left is not None else right


def _power(arguments: tuple[Node, ...], found: tuple[Unit | None, ...]) -> Unit | None:
    base, exponent = found
    if exponent is not None and not exponent.is_number:
        raise ExpressionError(
            f"the power '{brief(show(arguments[1]))}' is in {exponent}; it must be a plain number"
        )
    if base is None or base == ONE:
        return base
    plain = not readings(arguments[1]) and not tables_in(arguments[1])
    constant = plain and not names(arguments[1])
    value = float(evaluate(arguments[1], {})) if constant else math.nan
    if constant and math.isfinite(value) and abs(value) <= 20:
        fraction = Fraction(value).limit_denominator(12)
        if abs(fraction - Fraction(value)) < 1e-9:
            return base**fraction
    if base.is_number:
        return ONE
    raise ExpressionError(
        f"'{brief(show(arguments[0]))}' is in {base}, so its power must be a whole number"
        f" or a simple fraction, not '{brief(show(arguments[1]))}'"
    )
