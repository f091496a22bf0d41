"""How stiff the model is along a place: its springs there, and what it states as an energy."""

from collections.abc import Mapping, Sequence

import numpy as np

from symhyb.discrepancy.places.standing import alike
from symhyb.model.expression import Expression, evaluate, names, tables_in
from symhyb.model.scope import constant_of
from symhyb.model.types import Model, On, Place
from symhyb.numeric.kernels.buffers import Array

STEP = 1e-4  # of a second difference, SI
NOWHERE = 1e-6  # of the direction of a place: what no potential moves

State = Mapping[tuple[str, int] | str, float]


def stiffness_at(model: Model, place: Place) -> float:
    """The linear stiffness, SI, of all springs at a place, and what a declared potential has there
    where the model starts; 0 where an input, a state or the time changes one of them."""
    stated = [
        constant_of(text, model, one.parameters)
        for one in alike(model, "spring", place)
        if (text := one.value("stiffness"))
    ]
    known = [one for one in stated if one is not None]
    springs = sum(known) if len(known) == len(stated) else 0.0
    return springs + (_declared(model, place) if isinstance(place, On) else 0.0)


def _declared(model: Model, place: On) -> float:
    """k of the potential ½ k s² in the stretch s that a declared potential V holds: the force along
    s alone by what it moves, 1/(dᵀ H⁻¹ d) with H = ∂²V/∂q² and d = ∂s/∂q; 0 where V does not
    resist s, or has no curvature at the start."""
    potential = model.energy.potential
    if potential is None:
        return 0.0
    at: dict[tuple[str, int] | str, float] = {one.name: one.si for one in model.parameters}
    at |= {one.name: one.start * one.unit.factor for one in model.coordinates}
    if any(one.order or one.name not in at for one in names(potential)) or tables_in(potential):
        return 0.0
    moved = [one.name for one in model.coordinates]
    curved, way = _curvature(potential, at, moved), _slope(place.expression, at, moved)
    if not np.isfinite(curved).all():
        return 0.0
    given = np.linalg.lstsq(curved, way, rcond=NOWHERE)[0]
    if not np.allclose(curved @ given, way, rtol=0.0, atol=NOWHERE * float(np.abs(way).max())):
        return 0.0
    gives = float(way @ given)
    return 1.0 / gives if gives > 0.0 else 0.0


def _curvature(of: Expression, at: State, moved: Sequence[str]) -> Array:
    """∂²/∂q² (n, n), SI."""
    corners = [(i, k) for i in (1, -1) for k in (1, -1)]
    found = [
        [sum(i * k * _moved(of, at, (a, i), (b, k)) for i, k in corners) for b in moved]
        for a in moved
    ]
    return np.array(found) / (2 * STEP) ** 2


def _slope(of: Expression, at: State, moved: Sequence[str]) -> Array:
    """∂/∂q (n,), SI."""
    found = [_moved(of, at, (one, 1)) - _moved(of, at, (one, -1)) for one in moved]
    return np.array(found) / (2 * STEP)


def _moved(of: Expression, at: State, *steps: tuple[str, int]) -> float:
    """The value with some coordinates moved by so many steps."""
    there = dict(at)
    for name, count in steps:
        there[name] += count * STEP
    return float(evaluate(of, there))
