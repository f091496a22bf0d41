"""Elements drawn where they act: between points, on coordinates, about pivots, at points."""

from collections.abc import Sequence

import numpy as np

from symhyb.model.types import At, Between, Element, On, Pair, place_text
from symhyb.report.series import Array
from symhyb.report.sketch_draft import BOX, Draft, mover_of
from symhyb.report.symbols import across, arc, ground, symbol

RIDING = frozenset({"added_mass", "mode"})  # on what moves, and not held by the ground
PUSHING = frozenset({"force", "torque", "law", "constant", "harmonic", "ripple", "network"})


def draw_element(draft: Draft, element: Element) -> None:
    """One element where it acts."""
    match element.place:
        case Between(first, second):
            a, b = (draft.flat(draft.here.points[name]) for name in (first, second))
            _draw_between(draft, element, a, b, "|".join(sorted((first, second))))
        case At(point):
            at, away = draft.flat(draft.here.points[point]), np.array([-1.2, 1.2])
            tail = at + draft.size * away * (1 + 0.5 * draft.row(f"at {point}"))
            if element.kind in PUSHING:
                draft.add("arrow", [tail, at], "input", element.name)
            else:
                for line in symbol(element, tail, at, 0.7 * draft.size):
                    draft.add("line", line, "element", element.name)
            _label(draft, element, tail, away)
        case On() as on:
            _draw_on(draft, element, _used(draft, on))
        case Pair() as pair:
            _draw_on(draft, element, [j for on in pair.each for j in _used(draft, on)])


def _used(draft: Draft, on: On) -> list[int]:
    """The coordinates in a stretch, in the order in which it names them."""
    names = [c.name for c in draft.model.coordinates]
    return [names.index(name) for name in sorted(on.names, key=on.coordinate.find) if name in names]


def _draw_between(draft: Draft, element: Element, a: Array, b: Array, key: str) -> None:
    """The symbol of an element between two places; those that share them lie side by side."""
    row, (_, left) = draft.row(key), across(a, b)
    side = 1.0 if row % 2 else -1.0
    lane = draft.lane(key, side, element.name, left, 1.1 * ((row + 1) // 2))
    offset = left * draft.size * lane * side
    for line in symbol(element, a + offset, b + offset, 0.8 * draft.size):
        draft.add("line", line, "element", element.name)
    if element.kind in PUSHING:
        middle = (a + b) / 2 + offset
        for end in (a, b):
            draft.add("arrow", [end + 0.2 * (middle - end), middle], "input", element.name)
    for end in (a, b) if row else ():
        draft.add("line", [end, end + offset], "element", element.name)
    _label(draft, element, (a + b) / 2 + offset + side * left * 0.6 * draft.size, side * left)


def _draw_on(draft: Draft, element: Element, used: Sequence[int]) -> None:
    """An element on a coordinate, between the body that this moves and the ground; on several
    (``used``), as a difference or a pair has them, between the bodies of two."""
    ends = [mover for mover in (mover_of(draft, j) for j in used) if mover is not None]
    if not ends:
        where = place_text(element.place)
        said = f"{element.name} ({element.kind} {where}) acts on nothing that has a place"
        draft.left_out.append(said)
        return
    bodies = list(dict.fromkeys(body for body, _ in ends))
    body, rate = ends[0]
    if len(bodies) > 1 and not np.allclose(draft.centre(bodies[0]), draft.centre(bodies[1])):
        first, second = bodies[:2]
        a, b = draft.centre(first), draft.centre(second)
        _draw_between(draft, element, a, b, "|".join(sorted((first, second))))
    elif rate is None:
        _draw_turning(draft, element, body)
    else:
        _draw_sliding(draft, element, body, rate / np.linalg.norm(rate))


def _draw_sliding(draft: Draft, element: Element, body: str, along: Array) -> None:
    """An element between a body and the ground, along the motion of the body; several lie side by
    side, and a plate on the body takes them."""
    left, key = np.array([-along[1], along[0]]), f"slides {body} {along.round(6).tolist()}"
    lane = draft.lane(key, -1.0, element.name, left, 1.4 * draft.row(key))
    centre = draft.centre(body)
    plate = centre - along * BOX * draft.size
    end = plate - left * lane * draft.size
    draft.add("line", [plate, end], "element", element.name)
    wall = end - along * 3.6 * draft.size
    if element.kind in PUSHING:
        draft.add("arrow", [wall + 1.4 * along * draft.size, end], "input", element.name)
    elif element.kind in RIDING:
        wall = end - along * 1.8 * draft.size
        for line in symbol(element, wall, end, 0.8 * draft.size):
            draft.add("line", line, "element", element.name)
    else:
        wall = draft.held.setdefault(element.name, wall - along * draft.room(body, along))
        for line in symbol(element, wall, end, 0.8 * draft.size):
            draft.add("line", line, "element", element.name)
        for line in ground(wall, -along, 1.2 * draft.size):
            draft.add("line", line, "ground", element.name)
    apart = 0.3 if element.kind in PUSHING else 0.62
    _label(draft, element, (wall + end) / 2 - left * apart * draft.size, -left)


def _draw_turning(draft: Draft, element: Element, body: str) -> None:
    """An element on an angle: an arc about the pivot of the body that turns."""
    pivot = draft.flat(draft.here.frames[body].origin) + draft.shift.get(body, np.zeros(2))
    radius = draft.size * (0.8 + 0.55 * draft.row(f"turns {pivot.round(9).tolist()}"))
    pushing = element.kind in PUSHING
    curve = arc(pivot, radius, np.pi * 0.7, np.pi * 1.3)
    draft.add(
        "arrow" if pushing else "line", curve, "input" if pushing else "element", element.name
    )
    out = np.array([-0.5, 0.85])
    _label(draft, element, curve[0] + 0.15 * draft.size * out, out)


def _label(draft: Draft, element: Element, at: Array, away: Array) -> None:
    role = "input" if element.kind in PUSHING else "element"
    draft.label(at, role, element.name, away)
