"""The drawing of a machine that is played: what moves along a recording, beside the model as given.

Shapes are plain SVG in the page, and how they move stands in it as whole numbers of the drawing's
units, which ``motion.js`` plays. Sizes: N samples, F instants, K places of a mark.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.results import Trace, Verdict
from symhyb.discrepancy.words.wording import number_text
from symhyb.errors import InputError
from symhyb.model.types import Model
from symhyb.report.series import Array, shortened
from symhyb.report.sketch_moving import Moving, Part, moving

INSTANTS = 200  # that are drawn
FEW_TURNS = 4  # of a motion that has no cycles
PER_CYCLE = 12.0  # instants that a cycle of the motion needs, to be seen as one
WIDTH = 2400  # of the drawing, in its units
SHAPES = (0.22, 1.1)  # of the drawing, its height over its width
MARGINS = (1.6, 0.9)  # sizes of a symbol, beside and above what is drawn
ASIDE = 0.4  # of a direction, from where on a text stands to that side
GHOST_ROOM = 0.35  # of the drawing's sides, that the model as given may take beyond them
BEYOND = 4 * WIDTH  # units: as far outside as anything is drawn
SECONDS = (5.0, 30.0)  # that playing takes, whatever the motion took
HEAD = 30.0  # units, of an arrow
UNDER, BELOW = 0.75, (0.0, -1.0)  # sizes from the middle of a body to its name, and where that is


@dataclass(frozen=True, slots=True)
class Shape:
    """A shape of SVG where it is at first: its ``tag``, its ``attributes`` and its ``text``."""

    tag: str
    attributes: Mapping[str, str]
    text: str = ""


@dataclass(frozen=True, slots=True)
class Animation:
    """A machine to be played: ``shapes`` in their order, those of its ``ghost`` apart; ``height``
    of the drawing in its units; and ``data`` for the script: instants ``t``, the ``seconds`` that
    playing takes, ``seen``, the number of instants that the ghost has a place at, and ``moves``.

    Of every shape ``moves`` has how many numbers an instant takes, then those of the first instant,
    then differences from each instant to the next: two numbers are a shift, more are the places of
    its corners. One number alone, 0, is a shape that stands still.
    """

    shapes: tuple[Shape, ...]
    ghost: tuple[Shape, ...]
    height: int
    words: str
    caption: str
    data: Mapping[str, Any]


def animation(verdict: Verdict, extended: Model, names: Sequence[str]) -> Animation | None:
    """Let a machine move along the first unseen recording (else the first of the training), by the
    model with what was found (``extended``), which is emphasised (``names``); None where its
    motion is not known or it cannot be drawn."""
    trace = verdict.shown_trace()
    if trace is None:
        return None
    coordinates = [one.name for one in extended.coordinates]
    if trace.t.size < 2 or not {*coordinates} <= {*trace.motion}:
        return None
    q = np.column_stack([trace.motion[name] for name in coordinates])
    ghost = None
    if {*coordinates} <= {*trace.motion_before}:
        ghost = np.column_stack([trace.motion_before[name] for name in coordinates])
    if not np.isfinite(q).all():
        return None
    t = instants(trace.t, q)
    q, ghost = _at(t, trace.t, q), None if ghost is None else _at(t, trace.t, ghost)
    try:
        made = moving(extended, q, ghost, names)
    except (InputError, KeyError):  # a part has no place on the way
        return None
    return None if not made.parts else _played(made, trace, t, names)


def instants(t: Array, q: Array) -> Array:
    """The times (F,) in s at which a motion ``q`` (N, n) along ``t`` (N,) is drawn: all of it, or
    the first part that is lively and in which its cycles can be seen."""
    span = float(t[-1] - t[0])
    period = min((_period(t, column) for column in q.T), default=np.inf)
    length = float(min(span, INSTANTS / PER_CYCLE * period))
    starts = np.linspace(t[0], t[-1] - length, 40 if length < span else 1)
    lively = []
    size = np.maximum(np.ptp(q, axis=0), 1e-300)
    for start in starts:
        inside = q[(t >= start) & (t <= start + length)]
        lively.append(float(np.max(np.ptp(inside, axis=0) / size)) if len(inside) else 0.0)
    start = starts[int(np.argmax(np.array(lively) >= 0.5 * max(lively)))]
    return np.linspace(start, start + length, min(INSTANTS, t.size))


def _period(t: Array, values: Array) -> float:
    """How long a fast cycle of a motion (N,) along ``t`` (N,) lasts, s: what is to and fro about
    its mean by more than a third of its standard deviation; inf of a motion with hardly any."""
    away = values - values.mean()
    beyond = np.flatnonzero(np.abs(away) > away.std() / 3.0)
    turned = beyond[1:][np.diff(np.sign(away[beyond])) != 0]
    if turned.size < FEW_TURNS:
        return np.inf
    return 2.0 * float(np.percentile(np.diff(t[turned]), 25.0))


def _at(times: Array, t: Array, q: Array) -> Array:
    return np.column_stack([np.interp(times, t, column) for column in q.T])


def _played(made: Moving, trace: Trace, t: Array, names: Sequence[str]) -> Animation:
    """The drawing in its own units, x to the right and y downwards."""
    low, high = _view(made)
    scale = WIDTH / (high[0] - low[0])

    def units(at: Array) -> NDArray[np.int64]:
        flat = (at - [low[0], high[1]]) * [scale, -scale]
        flat = np.where(np.isfinite(flat), flat, BEYOND)
        return np.clip(np.round(flat), -BEYOND, BEYOND).astype(np.int64)

    shapes: list[Shape] = []
    moves: list[list[int]] = []
    for part in made.ghost:
        _add(shapes, moves, part, units(part.at), made.size * scale)
    count = len(shapes)
    for part in made.parts:
        _add(shapes, moves, part, units(part.at), made.size * scale)
    known = [np.isfinite(part.at).all(axis=(1, 2)) for part in made.ghost]
    seen = int(np.argmin([*np.logical_and.reduce(known), False])) if known else 0
    span = float(t[-1] - t[0])
    seconds = float(np.clip(span, *SECONDS))
    data = {
        "t": [float(f"{time:.6g}") for time in t],
        "seconds": seconds,
        "seen": seen,
        "moves": moves,
    }
    return Animation(
        tuple(shapes[count:]),
        tuple(shapes[:count]),
        round(scale * (high[1] - low[1])),
        f"Drawing of the machine with {', '.join(names)}, moving along {trace.recording}.",
        _caption(made, trace, t, span / seconds),
        data,
    )


def _view(made: Moving) -> tuple[Array, Array]:
    """The lower left and the upper right corner (2,) of what is seen, in m."""
    places = np.concatenate([part.at.reshape(-1, 2) for part in made.parts])
    margin = np.array(MARGINS) * made.size
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    room = GHOST_ROOM * (high - low)
    for part in made.ghost:
        known = part.at[np.isfinite(part.at).all(axis=2)]
        if known.size:
            low = np.clip(known.min(axis=0) - made.size, low - room, low)
            high = np.clip(known.max(axis=0) + made.size, high, high + room)
    sides = high - low
    wanted = np.array([max(sides[0], sides[1] / SHAPES[1]), max(sides[1], sides[0] * SHAPES[0])])
    return low - (wanted - sides) / 2, high + (wanted - sides) / 2


def _add(
    shapes: list[Shape],
    moves: list[list[int]],
    part: Part,
    at: NDArray[np.int64],
    size: float,
) -> None:
    """The shapes of one mark, and how they move along ``at`` (F, K, 2)."""
    mark = part.mark
    look = {"class": f"{mark.role}{' shown' if mark.shown else ''}"}
    match mark.shape:
        case "line" | "arrow":
            _moved(shapes, moves, "polyline", look, at)
            if mark.shape == "arrow":
                _moved(shapes, moves, "polygon", {"class": f"{look['class']} head"}, _head(at))
        case "body":
            _moved(shapes, moves, "polygon", look, at)
            if mark.text:
                under = at.mean(axis=1, keepdims=True)
                under[..., 1] += UNDER * size
                _written(shapes, moves, look, np.round(under).astype(np.int64), mark.text, BELOW)
        case "pivot":
            _moved(shapes, moves, "circle", look, at)
        case "text":
            _written(shapes, moves, look, at, mark.text, mark.away)


def _moved(
    shapes: list[Shape],
    moves: list[list[int]],
    tag: str,
    look: Mapping[str, str],
    at: NDArray[np.int64],
    text: str = "",
) -> None:
    first = at[0]
    where = {"points": " ".join(f"{x},{y}" for x, y in first.tolist())}
    if tag == "circle":
        where = {"cx": str(first[0, 0]), "cy": str(first[0, 1]), "r": "14"}
    if tag == "text":
        where = {"x": str(first[0, 0]), "y": str(first[0, 1])}
    shapes.append(Shape(tag, {**where, **look}, text))
    moves.append(_move(at))


def _move(at: NDArray[np.int64]) -> list[int]:
    """How a shape moves along ``at`` (F, K, 2), as :class:`Animation` says it."""
    shift = at - at[:1]
    if not shift.any():
        return [0]
    alike = np.ptp(shift, axis=1).max() <= 1  # but for rounding
    rows = shift[:, 0] if alike else at.reshape(len(at), -1)
    rows = np.concatenate([rows[:1], np.diff(rows, axis=0)])
    return [rows.shape[1], *rows.ravel().tolist()]


def _head(at: NDArray[np.int64]) -> NDArray[np.int64]:
    """The head (F, 3, 2) of an arrow whose tip is the last of its places (F, K, 2)."""
    tip, along = at[:, -1].astype(float), (at[:, -1] - at[:, -2]).astype(float)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    left = np.column_stack([-along[:, 1], along[:, 0]])
    base = tip - HEAD * along
    corners = np.stack([tip, base + 0.45 * HEAD * left, base - 0.45 * HEAD * left], axis=1)
    return np.round(corners).astype(np.int64)


def _written(
    shapes: list[Shape],
    moves: list[list[int]],
    look: Mapping[str, str],
    at: NDArray[np.int64],
    text: str,
    away: tuple[float, float],
) -> None:
    across, up = away
    anchor = "middle" if abs(across) < ASIDE else ("start" if across > 0 else "end")
    base = "central" if abs(up) < ASIDE else ("auto" if up > 0 else "hanging")
    look = {**look, "text-anchor": anchor, "dominant-baseline": base}
    _moved(shapes, moves, "text", look, at, shortened(text, 24))


def _caption(made: Moving, trace: Trace, t: Array, speed: float) -> str:
    role = "unseen" if trace.role == "holdout" else "training"
    part = f"{number_text(t[0], digits=3)} to {number_text(t[-1], digits=3)} s of "
    said = f"The machine as it was measured from {part}{trace.recording} ({role} recording)"
    if made.ghost:
        said += "; lighter and dashed: a free run of the model as given, its initial state fitted"
    said += ". Magenta: where the found elements act; blue: where each coordinate is positive."
    if made.times > 1:
        said += f" The motion is drawn {number_text(made.times)} times as large as it is."
    if not 0.99 < speed < 1.01:
        said += f" Played at {number_text(speed, digits=2)} times the speed of the machine."
    return said
