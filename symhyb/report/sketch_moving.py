"""A drawing of a machine that moves: the marks of a sketch at one instant after the other.

Walls and the sizes of symbols stay as they are at the start. Sizes: n coordinates, F instants, K
places of a mark.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.model.types import Model
from symhyb.report.placing import placed
from symhyb.report.series import Array
from symhyb.report.sketch import FAR, LARGEST, draft_at, draw_machine
from symhyb.report.sketch_bodies import draw_constraints, draw_links
from symhyb.report.sketch_draft import BOX, LONE, SIZES, Draft, Mark, spread_out

TRAVELS = 4.0  # sizes of a symbol, that a machine travels where it has no size of its own
SMALL, CLEAR = 0.05, 0.2  # of a machine, its travel: nobody sees it, and everybody does
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A ``mark`` that moves: ``at`` (F, K, 2) in m, of a body its four corners; NaN where it has no
    place."""

    mark: Mark
    at: Array


@dataclass(frozen=True, slots=True, eq=False)
class Moving:
    """The ``parts`` of a machine in motion, bodies and links of its ``ghost``, the ``size`` of a
    symbol in m, and how many ``times`` as large as it is the motion is drawn."""

    parts: tuple[Part, ...]
    ghost: tuple[Part, ...]
    size: float
    times: float


def moving(model: Model, q: Array, ghost: Array | None, shown: Sequence[str] = ()) -> Moving:
    """Draw a machine along ``q`` (F, n) in SI, and its bodies and links along another motion
    ``ghost`` (F, n), NaN where that is not known. Elements in ``shown`` are emphasised.

    Raises:
        InputError: a part has no place at the start or on the way, or one beyond any machine.
    """
    first = draft_at(model, np.array(model.start()[0]), shown)
    middle = np.median(q, axis=0)
    times = 1.0 if model.constraints else _times(first, _travel(_paths(first, q)))
    q = middle + times * (q - middle)
    paths = _paths(first, q)
    if first.size == LONE and _travel(paths) > 0:
        first.size = _travel(paths) / TRAVELS
    spread_out(first)
    first.excursions = {b: paths[b] - first.flat(first.here.centres[b]) for b in first.here.centres}
    draw_machine(first)
    drafts: list[Draft | None] = []
    for row in q:
        draft = _beside(first, draft_at(model, row, shown, first.size))
        draw_machine(draft)
        drafts.append(draft)
    parts, shadow = _parts(first, drafts), tuple[Part, ...]()
    if ghost is not None:
        rows = middle + times * (ghost - middle)
        start = _bones(first, np.array(model.start()[0]))
        shadow = _parts(start, [_bones(first, row) for row in rows]) if start else ()
    return Moving(parts, shadow, first.size, times)


def _paths(first: Draft, q: Array) -> dict[str, Array]:
    """Where bodies and points go along ``q`` (F, n), in the plane of the drawing (F, 2), m."""
    rows = [placed(first.model, row) for row in q]
    found = {
        name: np.array([first.flat(one.points[name]) for one in rows]) for name in rows[0].points
    }
    for name in rows[0].centres:  # a body may have the name of a point
        found[name] = np.array([first.flat(one.centres[name]) for one in rows])
    return found


def _travel(paths: dict[str, Array]) -> float:
    """How far anything moves, in m."""
    return max((float(np.ptp(path, axis=0).max()) for path in paths.values()), default=0.0)


def _times(first: Draft, travel: float) -> float:
    """How many times as large a ``travel`` in m must be drawn to be seen: 1, 2, 5, 10 …"""
    reach = first.size / SIZES[len(first.model.bodies) > 2]
    if first.size == LONE or not 0 < travel < SMALL * reach:
        return 1.0
    wanted = CLEAR * reach / travel
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1, 2, 5) if step * power <= wanted))


def _beside(first: Draft, draft: Draft) -> Draft:
    """A draft with walls and shifts of the first one."""
    draft.shift, draft.held, draft.excursions = first.shift, first.held, first.excursions
    return draft


def _bones(first: Draft, q: Array) -> Draft | None:
    """Bodies and links alone at ``q`` (n,) in SI; None where they have no place."""
    model = first.model
    here, far = placed(model, q), placed(model, q + FAR * (1 + np.arange(q.size)) / max(q.size, 1))
    known = [*here.centres.values(), *here.points.values(), *far.centres.values()]
    if not all(np.all(np.abs(place) < LARGEST) for place in known):
        return None
    draft = _beside(first, Draft(model, first.view, here, [], far, first.size, frozenset()))
    for body in model.bodies:
        draw_links(draft, body)
    draw_constraints(draft)
    for body in model.bodies:
        draft.add("body", [draft.centre(body.name)], "body", body.name)
    draft.marks = [mark for mark in draft.marks if mark.role in ("body", "link")]
    return draft


def _parts(first: Draft, drafts: Sequence[Draft | None]) -> tuple[Part, ...]:
    """The marks of the first draft, each along all drafts."""
    still = {item.name for item in first.model.constraints}
    wanted, known = _signature(first), first
    frames: list[list[Array]] = [[] for _ in first.marks]
    for draft in drafts:
        if draft is not None and _signature(draft) == wanted:
            known = draft  # else something is drawn in another way there: as before
        for places, mark, now in zip(frames, first.marks, known.marks, strict=True):
            fixed = mark.role == "ground" and mark.name not in still
            at = _corners(first, known, now) if mark.shape == "body" else now.at
            at = mark.at if fixed else at
            places.append(at if draft is not None else np.full_like(at, np.nan))
    return tuple(Part(mark, np.array(at)) for mark, at in zip(first.marks, frames, strict=True))


def _signature(draft: Draft) -> list[tuple[object, ...]]:
    return [(mark.shape, mark.role, mark.name, mark.at.shape) for mark in draft.marks]


def _corners(first: Draft, draft: Draft, mark: Mark) -> Array:
    """The corners (4, 2) in m of a body, turned as it is in the plane."""
    corners = BOX * first.size * _CORNERS
    if first.view.shape[1] == 2:
        turned = draft.here.frames[mark.name].axes @ first.here.frames[mark.name].axes.T
        corners = corners @ turned.T
    return np.asarray(mark.at[0] + corners)
