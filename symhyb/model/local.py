"""Equations of motion beside a measured motion, which another program gave: no file states them."""

from dataclasses import dataclass
from typing import Literal

COLUMN = "along "  # begins the name of a column of local equations; no name of a file has a blank


@dataclass(frozen=True, slots=True)
class LocalTerm:
    """A term of local equations, SI: ``value`` plus the column of a recording (its name; empty:
    none), times what ``kind`` says, in the equation of coordinate ``row``; times the change of the
    parameter ``path``, if one is named.

    Kinds: "force" is a force, "place", "rate" and "input" multiply the coordinate, its rate or the
    input ``by``; "mass" is the entry (row, by) of M and "mass rate" that of its change with time.
    """

    kind: Literal["force", "place", "rate", "input", "mass", "mass rate"]
    row: int
    by: int
    value: float
    column: str = ""
    path: str = ""


@dataclass(frozen=True, slots=True)
class Local:
    """Equations of motion beside a measured motion, to first order in what lies beside it:

        M(t) q'' = c(t) + K(t) q + D(t) q' + B(t) u + forces of elements

    ``nominal`` has the parameters, SI, about which changes count."""

    terms: tuple[LocalTerm, ...]
    nominal: tuple[tuple[str, float], ...] = ()
