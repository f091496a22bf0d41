"""Characteristic curves as SymPy functions of one variable, which differentiate exactly.

``tabulated(curve)(x)`` is left as it is by SymPy; the seam writes it as polynomials between breaks.
"""

from functools import lru_cache

import sympy as sp

from symhyb.laws.characteristic import Characteristic


class TabulatedBase(sp.Function):  # type: ignore[misc]
    """A function that is given by a ``characteristic``; each has a class of its own. SymPy's
    printers look at classes between these and ``Function`` if their name ends in Base."""

    nargs = 1
    characteristic: Characteristic

    @classmethod
    def eval(cls, x: sp.Expr) -> sp.Expr | None:
        """Of a number the value."""
        plain = x.is_number and x.is_real
        return sp.Float(float(cls.characteristic(float(x)))) if plain else None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The slope; at a break that of the piece behind it."""
        return tabulated(self.characteristic.slope())(self.args[0])

    @property
    def called(self) -> tuple[str, str]:
        """The name of the curve, and a prime for each time that it was differentiated."""
        name = self.characteristic.name.rstrip("'")
        return name, self.characteristic.name[len(name) :]

    def _eval_is_real(self) -> bool | None:
        return self.args[0].is_real  # type: ignore[no-any-return]


@lru_cache(maxsize=1024)
def tabulated(curve: Characteristic) -> type[TabulatedBase]:
    """The SymPy function of a curve, named as the curve is."""
    entries = {"characteristic": curve}
    made: type[TabulatedBase] = type(sp.Function)(curve.name, (TabulatedBase,), entries)
    return made
