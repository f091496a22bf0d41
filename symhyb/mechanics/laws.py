"""Force laws of elements as SymPy expressions in stretch, rate and inner state.

What a law does stands in :mod:`symhyb.laws`; here it is computed with the functions of SymPy.
"""

from collections.abc import Mapping

import sympy as sp

from symhyb.laws import friction, levels
from symhyb.laws.maths import Action, Coupling, Maths, Motion
from symhyb.mechanics.tabulated import mapped, tabulated
from symhyb.model.types import Element
from symhyb.model.vocabulary import KINDS

ZERO = sp.Integer(0)  # added to a plain number, it makes a SymPy expression of it
SYMPY = Maths(
    sp.Abs,
    sp.sign,
    lambda x: sp.Heaviside(x, 0),
    sp.exp,
    sp.sin,
    sp.tanh,
    sp.Max,
    sp.Min,
    lambda curve, x: tabulated(curve)(x),
    lambda surface, x, y: mapped(surface)(x, y),
    sp.pi,
)

Values = Mapping[str, sp.Expr]


def action_of(element: Element, at: Motion, values: Values) -> Action:
    """Return what the law of ``element`` does, as SymPy expressions; ``values`` are its set keys.

    Raises:
        TypeError: a kind without a law.
    """
    law = KINDS.get(element.kind)
    if law is None or law.action is None:
        raise TypeError(f"no law for kind {element.kind!r}")
    given: dict[str, object] = element.given()
    does = law.action(SYMPY, at, {**values, **given}, dict(element.options))
    inner, rest = (tuple(ZERO + one for one in part) for part in (does.inner, does.rest))
    return Action(ZERO + does.force, ZERO + does.stored, inner, rest, ZERO + does.mass)


def coupling_of(element: Element, a: Motion, b: Motion, values: Values) -> Coupling:
    """Return what the law of ``element`` does to a pair of stretches, as SymPy expressions.

    Raises:
        TypeError: a kind that is no law of a pair.
    """
    law = KINDS.get(element.kind)
    if law is None or law.coupling is None:
        raise TypeError(f"no law of a pair for kind {element.kind!r}")
    does = law.coupling(a, b, values)
    first, second = does.push
    return Coupling((ZERO + first, ZERO + second), ZERO + does.stored)


def acting(force: sp.Expr, stored: sp.Expr = ZERO) -> Action:
    """What a law without an inner state does."""
    return Action(force, stored, mass=ZERO)


def friction_level(s: sp.Expr, rate: sp.Expr, values: Values) -> sp.Expr:
    """The level g of dry friction at a stretch ``s`` and a ``rate``, N."""
    return ZERO + levels.friction_level(SYMPY, Motion(s, rate, (), ZERO), values)


def transition(values: Values) -> sp.Expr:
    """The speed within which friction turns, m/s."""
    return ZERO + friction.transition(values)
