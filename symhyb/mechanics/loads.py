"""What presses at a coordinate, as expressions of a model file: weight, springs, what is applied.

Losses do not press. Of several forces their sum is tried, too, and first: a gear carries them all.
"""

from collections.abc import Iterator
from functools import lru_cache

import sympy as sp

from symhyb.mechanics.equations import Equations, Term, derive
from symhyb.mechanics.rows import Slopes, product
from symhyb.mechanics.show import text_of
from symhyb.mechanics.tidy import tidied
from symhyb.model.expression import ExpressionError, parse_expression
from symhyb.model.scope import scope_of, unit_in
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import KINDS, force_unit

LETTERS = 200  # of an expression that a person still reads


@lru_cache(maxsize=32)
def loads_on(model: Model, coordinate: str) -> tuple[str, ...]:
    """The forces on a ``coordinate`` that move with the machine or with an input and are no
    losses, each in the unit of force there, and their sum before them.

    Left out is what no other element of the model file could say (a parameter of an element's own)
    or what would be longer than a person reads.
    """
    equations = derive(model)
    symbols = equations.symbols
    known = {*symbols.q, *symbols.states, *symbols.u}
    parts = [part for part in _forces(model, equations, coordinate) if part.free_symbols & known]
    every = [sp.Add(*parts), *parts] if len(parts) > 1 else parts
    told = dict.fromkeys(text_of(part) for part in every)
    return tuple(text for text in told if _sayable(model, coordinate, text))


def _forces(model: Model, equations: Equations, coordinate: str) -> Iterator[sp.Expr]:
    """The weight of all bodies, the slope of declared energy, springs and what is applied, N."""
    index = [c.name for c in model.coordinates].index(coordinate)
    by = tuple(Slopes(equations.symbols).by)[index]
    weight = sp.Add(
        *(
            body.mass * product(equations.gravity, tuple(map(by, body.centre)))
            for body in equations.masses
        )
    )
    yield tidied(weight) if sp.count_ops(weight) < LETTERS else weight
    yield -by(equations.potential)
    for element, term in zip(model.elements, equations.terms, strict=True):
        law = KINDS[element.kind]
        if element.place != On(coordinate) or not isinstance(term, Term) or term.hole is not None:
            continue
        applied = any(key.signal and key.name in law.strengths for key in law.keys)
        if applied or (law.energy == "conservative" and law.of_state):
            yield term.sign * term.law.force.xreplace({term.s: term.path})


def _sayable(model: Model, coordinate: str, text: str) -> bool:
    """Whether an expression can stand in the model file as a force on a coordinate."""
    if len(text) > LETTERS:
        return False
    try:
        unit = unit_in(parse_expression(text), scope_of(model))
    except ExpressionError:
        return False
    return unit is not None and unit.same_dimension(force_unit(model, On(coordinate)))
