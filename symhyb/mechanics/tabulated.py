"""Characteristic curves and maps as SymPy functions of one and two variables, which differentiate
exactly.

``tabulated(curve)(x)`` and ``mapped(surface)(x, y)`` are left as they are by SymPy; the seam writes
them as polynomials between breaks.
"""

from functools import lru_cache

import sympy as sp

from symhyb.laws.characteristic import Characteristic
from symhyb.laws.surface import Surface


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


class MappedBase(sp.Function):  # type: ignore[misc]
    """A function that is given by a ``surface``, as :class:`TabulatedBase` is by a curve."""

    nargs = 2
    surface: Surface

    @classmethod
    def eval(cls, x: sp.Expr, y: sp.Expr) -> sp.Expr | None:
        """Of two numbers the value."""
        plain = all(one.is_number and one.is_real for one in (x, y))
        return sp.Float(float(cls.surface(float(x), float(y)))) if plain else None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The slope by the first or the second variable; at a place of the grid that of the cell
        behind it. A second one by the same variable is 0."""
        variable = "xy"[argindex - 1]
        if variable in self.surface.slope_by:
            return sp.Integer(0)
        return mapped(self.surface.slope(variable))(*self.args)

    @property
    def called(self) -> tuple[str, str]:
        """The name of the map, and a letter for each variable by which it was differentiated."""
        return self.surface.name, self.surface.slope_by

    def _eval_is_real(self) -> bool | None:
        return all(one.is_real for one in self.args) or None


@lru_cache(maxsize=1024)
def mapped(surface: Surface) -> type[MappedBase]:
    """The SymPy function of a map, named as the map is."""
    made: type[MappedBase] = type(sp.Function)(surface.name, (MappedBase,), {"surface": surface})
    return made
