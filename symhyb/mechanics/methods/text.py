"""SymPy's expressions as text of a model file."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy as sp
from sympy.physics.mechanics import dynamicsymbols
from sympy.printing.str import StrPrinter

from symhyb.limits import EXPRESSION_LETTERS
from symhyb.model.expression import FUNCTIONS

FEW = 12  # terms that are written one after the other


class UnwritableError(Exception):
    """What a model file cannot say, as a sentence."""


@dataclass(frozen=True, slots=True)
class Naming:
    """The names of coordinates, whose derivatives have names, and of inputs, whose have none."""

    coordinates: frozenset[str]
    inputs: frozenset[str]


def written(expression: sp.Expr, naming: Naming) -> str:
    """An expression as text of a model file: ``theta(t)`` is theta, its derivatives are theta' and
    theta''.

    Raises:
        UnwritableError: a function that a model file does not know, a derivative of an input, a
            complex number, or a text that is too long.
    """
    if expression.has(sp.I, sp.oo, sp.zoo, sp.nan):
        raise UnwritableError("it holds a number that is not finite and real")
    text = str(_Text(naming).doprint(expression))
    if len(text) > EXPRESSION_LETTERS:
        raise UnwritableError(
            f"it takes {len(text)} letters, of which a model file allows {EXPRESSION_LETTERS}: "
            "write the machine body by body"
        )
    return text


class _Text(StrPrinter):  # type: ignore[misc]
    """The printer. Long sums and products are grouped by halves: a chain of a hundred terms would
    be nested too deeply for a reader that takes two at a time."""

    def __init__(self, naming: Naming):
        super().__init__({"full_prec": False})
        self._naming = naming

    def _print_Add(self, expression: sp.Add, order: object = None) -> str:
        return self._halved(expression, super()._print_Add, sp.Add)

    def _print_Mul(self, expression: sp.Mul) -> str:
        return self._halved(expression, super()._print_Mul, sp.Mul)

    def _halved(
        self, expression: sp.Expr, plain: Callable[[sp.Expr], str], made: type[sp.Expr]
    ) -> str:
        summed = made is sp.Add
        terms: Sequence[sp.Expr] = expression.as_ordered_terms() if summed else expression.args
        if len(terms) <= FEW:
            return str(plain(expression))
        half = len(terms) // 2
        parts = [made(*some, evaluate=False) for some in (terms[:half], terms[half:])]
        mark = " + " if summed else "*"
        return mark.join(f"({self._print(part)})" for part in parts)

    def _print_Function(self, expression: sp.Function) -> str:
        name = type(expression).__name__
        if isinstance(expression, sp.core.function.AppliedUndef):
            if expression.args != (dynamicsymbols._t,):
                raise UnwritableError(f"'{expression}' is no function of time")
            return name
        if name not in FUNCTIONS:
            raise UnwritableError(
                f"a model file does not know the function '{name}' of '{expression}'"
            )
        return f"{name}({self.stringify(expression.args, ', ')})"

    def _print_Derivative(self, expression: sp.Derivative) -> str:
        (variable, order), *more = expression.variable_count
        name = type(expression.expr).__name__
        if more or variable != dynamicsymbols._t or name not in self._naming.coordinates:
            raise UnwritableError(f"'{expression}' is no rate or acceleration of a coordinate")
        return name + "'" * int(order)

    def _print_Abs(self, expression: sp.Abs) -> str:
        return f"abs({self.stringify(expression.args, ', ')})"

    def _print_Max(self, expression: sp.Max) -> str:
        return f"max({self.stringify(expression.args, ', ')})"

    def _print_Min(self, expression: sp.Min) -> str:
        return f"min({self.stringify(expression.args, ', ')})"

    def _print_Exp1(self, expression: sp.Expr) -> str:
        return "exp(1)"

    def emptyPrinter(self, expression: object) -> str:
        raise UnwritableError(f"a model file cannot say '{expression}'")

    def _print_Piecewise(self, expression: sp.Piecewise) -> str:
        raise UnwritableError("a model file has no Piecewise; min, max and sign say what bends")
