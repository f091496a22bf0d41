"""What readable equations are made of: rows with their source, names that rows share, slopes."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

import sympy as sp

from symhyb.mechanics.symbols import Symbols
from symhyb.mechanics.tidy import along

Side = Literal["M", "k_c", "k_e"]
Short = dict[sp.Basic, sp.Expr]
ONE = sp.Integer(1)


@dataclass(frozen=True, slots=True)
class Row:
    """One summand: its ``side``, the coordinates it is ``of`` (one; row and column in a mass
    matrix), its ``source`` as in the model file (empty for the sum over all) and the ``value``,
    of M multiplied by q'' unless ``of`` is a pair."""

    side: Side
    of: tuple[int, ...]
    source: str
    value: sp.Expr


@dataclass(frozen=True, slots=True)
class Named:
    """A ``symbol`` that other expressions use, and its ``value``.

    ``kind`` says what it is, of the names in ``owners``: the "distance" |b − a| of two points, the
    "lapse" of it in time, the "speed" of a point; of a position or angle w of a body (axis, body):
    the "slope" ∂w/∂q (axis, body, coordinate) and the summands "pull" and "bias" of w'', of which
    the first goes with q''; of the angular velocity ω of a body in space (axis, body) "turn", and
    "turn slope" ∂ω/∂q', "turn pull" and "turn bias" likewise; or a "part" that recurs.
    """

    symbol: sp.Symbol
    value: sp.Expr
    kind: str = "part"
    owners: tuple[str, ...] = ()


class Slopes:
    """The derivatives of what depends on q and t: ``by`` each q (n), along q'' (``pull``), along
    q' with time (``rate``), by time alone (``in_time``) and along q' alone (``moved``)."""

    def __init__(self, symbols: Symbols):
        self.symbols = symbols
        self.by: tuple[Callable[[sp.Expr], sp.Expr], ...] = tuple(
            along({q: ONE}) for q in symbols.q
        )
        self.pull = along(dict(zip(symbols.q, symbols.a, strict=True)))
        self.moved = along(dict(zip(symbols.q, symbols.v, strict=True)))
        self.rate = along({**dict(zip(symbols.q, symbols.v, strict=True)), symbols.t: ONE})
        self.in_time = along({symbols.t: ONE})

    def bias(self, path: sp.Expr) -> sp.Expr:
        """w'' at q'' = 0."""
        return self.rate(self.rate(path))


def product(*columns: Iterable[sp.Expr]) -> sp.Expr:
    """Σ of the products of the entries of columns of the same length."""
    return sp.Add(*(sp.Mul(*entries) for entries in zip(*columns, strict=True)))
