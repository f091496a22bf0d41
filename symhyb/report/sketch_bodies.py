"""Bodies, what holds them, and coordinates, drawn."""

import numpy as np

from symhyb.model.types import Between, Body
from symhyb.report.series import Array
from symhyb.report.sketch_draft import SAME, STILL, Draft, about_origin, mover_of, point_moved
from symhyb.report.symbols import arc, ground


def draw_links(draft: Draft, body: Body) -> None:
    """The rigid part of a body: from its origin to its centre, its points and what hangs on it."""
    frame = draft.here.frames[body.name]
    ends = [p for p in draft.model.points if p.body == body.name]
    places = [draft.here.points[p.name] for p in ends]
    hanging = [b for b in draft.model.bodies if b.joint is not None and b.parent == body.name]
    places += [draft.here.frames[b.name].origin for b in hanging]
    places.append(draft.here.centres[body.name])
    if body.joint is None and body.angle is not None:
        places += _attached(draft, body)
    start = draft.flat(frame.origin) + draft.shift.get(body.name, np.zeros(2))
    for place in places:
        end = draft.flat(place) + draft.shift.get(body.name, np.zeros(2))
        if np.linalg.norm(end - start) > STILL * draft.size:
            draft.add("line", [start, end], "link", body.name)
    if body.joint is not None:
        draft.add("pivot", [start], "link", body.name)
        if not body.parent:
            below = start - draft.centre(body.name)
            for line in ground(start, below, 1.2 * draft.size):
                draft.add("line", line, "ground", body.name)


def _attached(draft: Draft, body: Body) -> list[Array]:
    """Places that keep their distance from the centre of a turning body however it moves: points
    that move, and the origin of the axes, about which it then turns."""
    here, far, kept = draft.here, draft.far, []
    centre = here.centres[body.name]
    for point in draft.model.points:
        place, later = here.points[point.name], far.points[point.name]
        now = float(np.linalg.norm(place - centre))
        then = float(np.linalg.norm(later - far.centres[body.name]))
        moves = float(np.linalg.norm(later - place)) > SAME * max(now, SAME)
        if not point.body and now > 0 and moves and abs(then - now) < SAME * now:
            kept.append(place)
    if about_origin(body, here, far):
        origin = np.zeros_like(centre)
        kept.append(origin)
        draft.add("pivot", [draft.flat(origin)], "link", body.name)
        for line in ground(draft.flat(origin), -draft.flat(centre), 1.2 * draft.size):
            draft.add("line", line, "ground", body.name)
    return kept


def draw_grounds(draft: Draft) -> None:
    """Points that no coordinate moves and that an element or a constraint holds to."""
    used = {n for e in draft.model.elements if isinstance(e.place, Between) for n in _ends(e.place)}
    used |= {name for item in draft.model.constraints for name in item.names}
    points = draft.here.points
    middle = np.mean([draft.flat(p) for p in points.values()], axis=0) if points else np.zeros(2)
    for name in points:
        moves = float(np.linalg.norm(draft.far.points[name] - points[name]))
        if name in used and moves <= STILL * draft.size:
            at = draft.flat(points[name])
            for line in ground(at, at - middle, 1.2 * draft.size):
                draft.add("line", line, "ground", name)


def _ends(place: Between) -> tuple[str, str]:
    return place.first, place.second


def draw_constraints(draft: Draft) -> None:
    """Pins, rods and lines of sliders; other conditions have no picture and are named."""
    for item in draft.model.constraints:
        places = [draft.here.points[name] for name in item.names if name in draft.here.points]
        flat = [draft.flat(place) for place in places]
        if item.kind == "pin" and flat:
            draft.add("pivot", [flat[0]], "link", item.name)
        elif item.kind == "distance" and len(flat) == 2:
            draft.add("line", flat, "link", item.name)
        elif item.kind == "slider" and len(flat) == 3:
            draft.add("line", flat[1:], "ground", item.name)
            draft.add("pivot", [flat[0]], "link", item.name)
        else:
            draft.left_out.append(f"{item.name} ({item.kind}) is a condition without a picture")


def draw_coordinate(draft: Draft, j: int, name: str) -> None:
    """An arrow where a coordinate is positive: beside the body that moves, or about its pivot."""
    mover = mover_of(draft, j)
    moved = point_moved(draft, j) if mover is None else (draft.centre(mover[0]), mover[1])
    if moved is None:
        draft.left_out.append(f"{name} moves nothing that has a place")
        return
    at, rate = moved
    if rate is None and mover is not None:
        pivot = draft.flat(draft.here.frames[mover[0]].origin)
        pivot = pivot + draft.shift.get(mover[0], np.zeros(2))
        sign = np.sign(draft.turning(mover[0], j)) or 1.0
        radius = draft.size * (1.3 + 0.45 * draft.row(f"angle {pivot.round(9).tolist()}"))
        curve = arc(pivot, radius, -0.8 * sign, 0.6 * sign)
        draft.add("arrow", curve, "coordinate", name)
        out = curve[-1] - pivot
        draft.label(curve[-1] + 0.2 * out, "coordinate", name, out)
        return
    assert rate is not None
    along = rate / np.linalg.norm(rate)
    left = np.array([-along[1], along[0]])
    row = draft.row(f"along {at.round(9).tolist()} {along.round(6).tolist()}")
    base = at + left * (1.0 + 0.5 * row) * draft.size
    tick = left * 0.3 * draft.size
    draft.add("line", [base - tick, base + tick], "coordinate", name)
    tip = base + along * 1.3 * draft.size
    draft.add("arrow", [base, tip], "coordinate", name)
    draft.label(tip + along * 0.15 * draft.size, "coordinate", name, along)


def draw_axes(draft: Draft) -> None:
    """The three inertial axes of a machine in space, beside it."""
    places = np.vstack([mark.at for mark in draft.marks])
    corner = places.min(axis=0) - 1.5 * draft.size
    for name, axis in zip("xyz", np.eye(3), strict=True):
        tip = corner + 1.4 * draft.size * draft.flat(axis)
        draft.add("arrow", [corner, tip], "axis", name)
        draft.label(tip + 0.2 * draft.size * draft.flat(axis), "axis", name, draft.flat(axis))
