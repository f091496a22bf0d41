"""A drawing of a machine as plain marks: bodies, links, elements, grounds, positive directions.

It is made from the model alone, at ``start`` or at any other place, by one view: the plane of the
model, or from the side and above in space. Free bodies that lie on one place are drawn apart, for
that is how a line of masses ``on`` coordinates is meant. Sizes: n coordinates.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.model.space import dimension, quaternion_parts
from symhyb.model.types import Model
from symhyb.report.placing import Placed, placed
from symhyb.report.series import Array
from symhyb.report.sketch_bodies import (
    draw_axes,
    draw_constraints,
    draw_coordinate,
    draw_grounds,
    draw_links,
)
from symhyb.report.sketch_draft import STEP, Draft, Mark, spread_out, symbol_size
from symhyb.report.sketch_elements import draw_element

FAR = 0.1  # of all coordinates, SI: whether distances stay
LARGEST = 1e9  # m
VIEW = np.array([[0.87, -0.5, 0.0], [-0.25, -0.43, 0.87]])  # of space: x to the right, z upwards


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """The ``marks`` of a machine, the ``size`` of a symbol in m, and sentences on what is declared
    and not drawn (``left_out``)."""

    marks: tuple[Mark, ...]
    size: float
    left_out: tuple[str, ...]


def sketch_of(model: Model, q: Array | None = None, shown: Sequence[str] = ()) -> Sketch:
    """Draw a machine at ``q`` (n,) in SI, by default where simulations start. Elements, bodies and
    coordinates in ``shown`` are emphasised.

    A model with constraints that was not built yet is drawn at the start that the file states.

    Raises:
        InputError: a part has no place there, or one beyond any machine.
    """
    draft = draft_at(
        model, np.array(model.start()[0]) if q is None else np.asarray(q, float), shown
    )
    spread_out(draft)
    draw_machine(draft)
    return Sketch(tuple(draft.marks), draft.size, tuple(draft.left_out))


def draft_at(model: Model, q: Array, shown: Sequence[str] = (), size: float | None = None) -> Draft:
    """A draft of a machine at ``q`` (n,) in SI with nothing drawn yet; ``size`` is that of a symbol
    in m, by default a part of that of the machine.

    Raises:
        InputError: a part has no place there, or one beyond any machine.
    """
    view = np.eye(2) if dimension(model) == 2 else VIEW
    here = placed(model, q)
    moved = [placed(model, q + STEP * row) for row in np.eye(q.size)]
    far = placed(model, q + FAR * (1 + np.arange(q.size)) / max(q.size, 1))
    for one in (here, *moved, far):
        _require_places(one, model)
    size = symbol_size(model, here, far, view) if size is None else size
    return Draft(model, view, here, moved, far, size, frozenset(shown))


def draw_machine(draft: Draft) -> None:
    """Draw all of a machine: bodies with what holds them, elements, coordinates."""
    model = draft.model
    for body in model.bodies:
        draw_links(draft, body)
    draw_grounds(draft)
    for element in model.elements:
        draw_element(draft, element)
    draw_constraints(draft)
    for body in model.bodies:
        draft.add("body", [draft.centre(body.name)], "body", body.name, body.name)
    turning = quaternion_parts(model)
    for j, coordinate in enumerate(model.coordinates):
        if coordinate.name not in turning:
            draw_coordinate(draft, j, coordinate.name)
    if draft.view.shape[1] == 3:
        draw_axes(draft)


def _require_places(parts: Placed, model: Model) -> None:
    """Refuse parts whose place is no number or lies beyond ``LARGEST``.

    Raises:
        InputError: every such part.
    """
    named = [(f"bodies.{name}", place) for name, place in parts.centres.items()]
    named += [(f"points.{name}", place) for name, place in parts.points.items()]
    lost = [name for name, place in named if not np.all(np.abs(place) < LARGEST)]
    if lost:
        text = "has no place that can be drawn at the start or close to it; check its expressions"
        raise InputError(Problem(text, name, model.file) for name in lost)


def roles(sketch: Sketch) -> Mapping[str, tuple[str, ...]]:
    """What is drawn, by role: the names of bodies, elements and coordinates, each once."""
    found: dict[str, list[str]] = {}
    for mark in sketch.marks:
        names = found.setdefault(mark.role, [])
        if mark.name not in names:
            names.append(mark.name)
    return {role: tuple(names) for role, names in found.items()}
