"""The entries of the mass matrix as expressions of the model file, where they can be written so."""

import re

import sympy as sp

from symhyb.mechanics.readable import readable
from symhyb.model.expression import ExpressionError, Name, names, parse_expression
from symhyb.model.types import Model

LONGEST = 400  # characters of an entry: a longer one nobody would read
_CALLED = {"Abs": "abs", "Max": "max", "Min": "min"}


def mass_texts(model: Model) -> dict[tuple[str, str], str] | None:
    """The entries of M that are not zero, by the names of two coordinates; None where one needs
    names that the model has not, or is too long."""
    full = readable(model, matrices=True)
    coordinates = [c.name for c in model.coordinates]
    known = {Name(name, order) for name in coordinates for order in (0, 1)}
    known |= {Name(p.name) for p in model.parameters}
    entries: dict[tuple[str, str], str] = {}
    for i, first in enumerate(coordinates):
        for j, second in enumerate(coordinates):
            rows = full.of("M", min(i, j), max(i, j))
            value = sum((row.value for row in rows), sp.Integer(0))
            if value == 0:
                continue
            text = _text(value)
            try:
                used = set(names(parse_expression(text)))
            except ExpressionError:
                return None
            if len(text) > LONGEST or not used <= known:
                return None
            entries[first, second] = text
    return entries


def _text(value: sp.Expr) -> str:
    text = str(sp.sstr(value))
    return re.sub(r"\b(Abs|Max|Min)\b", lambda m: _CALLED[m[1]], text)
