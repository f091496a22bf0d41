"""Expressions made short for people: small ones by exact rewritings, many by naming what recurs.

Nothing here may hang: a product of sums is multiplied out only where it stays small.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from math import prod
from typing import Any

import sympy as sp
from sympy.simplify.cse_main import tree_cse
from sympy.simplify.fu import TR6, TR10i

MOST_TERMS = 60  # of a product that is multiplied out; beyond, an entry stays as derived
MOST_OPERATIONS = 20_000  # up to here partial sums are shared too, which takes longer
NOTHING = 1e-25

_FLAT = (sp.sign, sp.Heaviside)  # steps: their slope counts as zero, as in CasADi


def along(seeds: Mapping[sp.Symbol, sp.Expr]) -> Callable[[sp.Expr], sp.Expr]:
    """The derivative of expressions in a direction: Σ (∂x/∂symbol)·seed, every part once.

    Unlike a sum of partial derivatives it leaves sums in place: along q' the angle a + b of
    sin(a + b) gives (a' + b')·cos(a + b).
    """
    done: dict[sp.Basic, sp.Expr] = dict(seeds)

    def slope(node: sp.Basic) -> sp.Expr:
        found = done.get(node)
        if found is None:
            found = done[node] = differentiated(node)
        return found

    def of_product(parts: tuple[sp.Expr, ...]) -> sp.Expr:
        """Half by half: the second slope of 300 factors would else have millions of parts."""
        if len(parts) == 1:
            return slope(parts[0])
        middle = len(parts) // 2 if len(parts) > 6 else 1
        first, second = parts[:middle], parts[middle:]
        return sp.Mul(of_product(first), *second) + sp.Mul(*first, of_product(second))

    def differentiated(node: sp.Basic) -> sp.Expr:
        if not node.args or isinstance(node, _FLAT):
            return sp.Integer(0)
        if node.is_Add:
            return sp.Add(*map(slope, node.args))
        if node.is_Mul:
            return of_product(node.args)
        if node.is_Pow:
            base, power = node.args
            grown = power * base ** (power - 1) * slope(base)
            turned = slope(power)
            return grown if turned == 0 else grown + node * sp.log(base) * turned
        slopes = [(i, slope(part)) for i, part in enumerate(node.args, 1)]
        return sp.Add(*(node.fdiff(i) * part for i, part in slopes if part != 0))

    return slope


def tidied(expression: sp.Expr) -> sp.Expr:
    """The shortest of a few cheap forms: sin² + cos² = 1 and sums of angles, common factors out."""
    if largest_product(expression) > MOST_TERMS:
        return expression
    flat = _multiplied_out(expression)
    squares = _multiplied_out(TR6(flat))  # cos² as 1 − sin²
    forms = (expression, flat, squares, TR10i(flat), TR10i(squares))
    return min(map(sp.factor_terms, forms), key=sp.count_ops)


def _multiplied_out(expression: sp.Expr) -> sp.Expr:
    return expression.expand(basic=False, log=False, power_base=False, power_exp=False)


def largest_product(expression: sp.Expr) -> int:
    """The most terms that a part of it would have when multiplied out."""
    return max(map(terms, sp.preorder_traversal(expression)))


def terms(expression: sp.Basic) -> int:
    """How many terms it would have when multiplied out: a short product may hide millions."""
    if isinstance(expression, sp.Add):
        return sum(map(terms, expression.args))
    if isinstance(expression, sp.Mul):
        return prod(map(terms, expression.args))
    if isinstance(expression, sp.Pow) and expression.exp.is_Integer and 1 < expression.exp < 64:
        return int(terms(expression.base) ** int(expression.exp))
    return 1


def exact(value: Any) -> Any:
    """Numbers as people write them: 1.5 as 3/2 and 1.5707963267949 as pi/2, in expressions and in
    the tuples, mappings and dataclasses that hold them."""
    if isinstance(value, sp.Basic):
        return value.xreplace({number: _exact(number) for number in value.atoms(sp.Float)})
    if isinstance(value, tuple):
        return tuple(map(exact, value))
    if isinstance(value, Mapping):
        return {key: exact(item) for key, item in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{x.name: exact(getattr(value, x.name)) for x in fields(value)})
    return value


def _exact(number: sp.Float) -> sp.Expr:
    """A multiple of 1/4 or of pi/12 to the last digits, 0 for what only keeps slopes finite, else
    the number itself."""
    if abs(number) < NOTHING:
        return sp.Integer(0)
    for unit, parts in ((sp.Integer(1), 4), (sp.pi, 12)):
        count = float(number) / float(unit) * parts
        if 0 < abs(count) < 1e3 and abs(count - round(count)) <= 4e-16 * abs(count):
            return sp.Rational(round(count), parts) * unit
    return number


def named(
    expressions: list[sp.Expr], taken: set[str]
) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]]:
    """Give what recurs in ``expressions`` the names w1, w2 …, none of them in ``taken``.

    Returns:
        The named parts (later ones may use earlier ones), and the expressions in these names.
    """
    names = _names(taken)
    if sum(sp.count_ops(item) for item in expressions) <= MOST_OPERATIONS:
        found, short = sp.cse(expressions, names, list=True)
    else:
        found, short = tree_cse(expressions, names)
    return _without_signs(found, short)


def _names(taken: set[str]) -> Iterator[sp.Symbol]:
    number = 0
    while True:
        number += 1
        if f"w{number}" not in taken:
            yield sp.Symbol(f"w{number}", real=True)


def _without_signs(
    found: list[tuple[sp.Symbol, sp.Expr]], short: list[sp.Expr]
) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]]:
    """Put back names that stand for a symbol with another sign: they shorten nothing."""
    signs: dict[sp.Basic, sp.Expr] = {}
    kept = []
    for symbol, value in found:
        value = value.xreplace(signs)
        if (-value).is_Symbol or value.is_Symbol:
            signs[symbol] = value
        else:
            kept.append((symbol, value))
    return kept, [item.xreplace(signs) for item in short]
