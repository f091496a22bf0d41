"""Where a force could act: on coordinates, where elements stand, on stretches that nobody named."""

from collections.abc import Sequence
from functools import lru_cache
from typing import TypeGuard

from symhyb.discrepancy.places.probing import proportional, pushed
from symhyb.discrepancy.places.stretches import coupled_stretches, written_stretches
from symhyb.model.constraints import Constraint
from symhyb.model.expression import names
from symhyb.model.space import quaternion_parts
from symhyb.model.types import Between, Model, On, Place


@lru_cache(maxsize=8)
def places_of(model: Model) -> tuple[Place, ...]:
    """Places worth a hypothesis: every coordinate (but the parts of a quaternion, of which no force
    has one alone); where a machine has several, every pair of points and every expression on which
    an element stands, and the sums and differences of two coordinates that the model couples.
    What a gear or a wheel turns moves as its partner does."""
    parts = quaternion_parts(model)
    turned = {
        item.names[1]
        for item in model.constraints
        if item.kind in ("gear", "rolling") and not _moving(item, model)
    }
    left = [c.name for c in model.coordinates if c.name not in parts and c.name not in turned]
    places: list[Place] = [On(name) for name in left]
    if len(model.coordinates) > 1:
        between = (e.place for e in model.elements if isinstance(e.place, Between))
        places += dict.fromkeys(between)
    return (*places, *_combined(model, places, left))


def _moving(item: Constraint, model: Model) -> bool:
    """Whether the ratio of a gear or the radius of a wheel changes as it moves."""
    used = {name.name for _, value in item.values for name in names(value)}
    return bool(used & {"t", *(c.name for c in model.coordinates)})


def _combined(model: Model, places: Sequence[Place], left: Sequence[str]) -> tuple[Place, ...]:
    """The expressions on which elements stand, and the combinations of two of the coordinates
    ``left`` that the model couples, which move neither as one of the ``places`` nor as one before;
    at most n − 1, and one more for each element."""
    offered: list[On] = [e.place for e in model.elements if _on_expression(e.place)]
    if len(left) > 1:
        others = {c.name for c in model.coordinates} - set(left)
        written = (place for place in written_stretches(model) if not place.names & others)
        offered += [*written, *coupled_stretches(model, left)]
    offered = list(dict.fromkeys(offered))
    if not offered:
        return ()
    ways = pushed(model, (*places, *offered))
    seen = [way for way in ways[: len(places)] if way is not None]
    chosen: list[Place] = []
    for place, way in zip(offered, ways[len(places) :], strict=True):
        if way is not None and not any(proportional(way, other) for other in seen):
            seen.append(way)
            chosen.append(place)
    return tuple(chosen[: len(model.coordinates) - 1 + len(model.elements)])


def _on_expression(place: Place) -> TypeGuard[On]:
    return isinstance(place, On) and not place.plain
