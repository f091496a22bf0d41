r"""The symbols of elements between two places of a drawing, as lines.

    spring  o--/\/\/\--o      damper  o---[|--o      friction  o--==--o      gap  o--| |--o

Every function takes two places (2,) and a size, in the unit of the drawing, and returns lines
(K, 2) in that unit.
"""

from collections.abc import Callable, Sequence

import numpy as np

from symhyb.model.types import Element
from symhyb.report.series import Array

Lines = list[Array]
TURNS = 5
LEAD = 0.2  # of the length, at both ends


def symbol(element: Element, a: Array, b: Array, size: float) -> Lines:
    """The lines (K, 2) of an element from ``a`` (2,) to ``b`` (2,), in one unit."""
    return _SYMBOLS.get(_drawn_as(element), _plain)(a, b, size)


def _drawn_as(element: Element) -> str:
    """The kind whose symbol an element has: a curve is a spring, or a damper; a map a damper."""
    if element.kind == "map":
        return "damper"
    if element.kind != "curve":
        return element.kind
    lost = element.option("over", "") == "rate" or element.option("times", "")
    return "damper" if lost else "spring"


def across(a: Array, b: Array) -> tuple[Array, Array]:
    """Unit vectors (2,), dimensionless, along the line from ``a`` to ``b`` and to its left."""
    along = b - a
    length = float(np.linalg.norm(along))
    along = along / length if length > 0 else np.array([1.0, 0.0])
    return along, np.array([-along[1], along[0]])


def ground(at: Array, outward: Array, width: float) -> Lines:
    """A wall or floor at a place (2,) that a machine stands on or hangs from, in the unit of
    ``width``; ``outward`` (2,), dimensionless, points away from the machine."""
    size = float(np.linalg.norm(outward))
    out = outward / size if size > 0 else np.array([0.0, -1.0])
    side = np.array([-out[1], out[0]])
    lines = [np.array([at - side * width / 2, at + side * width / 2])]
    for share in np.linspace(-0.5, 0.4, 5):
        foot = at + side * width * share
        lines.append(np.array([foot, foot + (out + 0.6 * side) * width * 0.18]))
    return lines


def arc(centre: Array, radius: float, first: float, last: float) -> Array:
    """A part (K, 2) of a circle about a place (2,), in the unit of ``radius``; angles in rad,
    counter-clockwise from the right."""
    angles = np.linspace(first, last, 25)
    return centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _on_line(a: Array, b: Array, local: Sequence[tuple[float, float]], size: float) -> Array:
    """Places (K, 2) given by their share of the way from a to b and, in sizes, to the left."""
    _, left = across(a, b)
    return np.array([a + share * (b - a) + offset * size * left for share, offset in local])


def _plain(a: Array, b: Array, size: float) -> Lines:
    return [np.array([a, b])]


def _zigzag(a: Array, b: Array, size: float, first: float = LEAD, last: float = 1 - LEAD) -> Lines:
    steps = np.linspace(first, last, 2 * TURNS + 1)
    sides = [0.0, *([0.5, -0.5] * TURNS)[: 2 * TURNS - 1], 0.0]
    inner = list(zip(steps, sides, strict=True))
    return [_on_line(a, b, [(0.0, 0.0), *inner, (1.0, 0.0)], size)]


def _dashpot(a: Array, b: Array, size: float) -> Lines:
    pot = [(0.62, 0.45), (0.36, 0.45), (0.36, -0.45), (0.62, -0.45)]
    rod, plate = [(1.0, 0.0), (0.5, 0.0)], [(0.5, 0.36), (0.5, -0.36)]
    parts: list[list[tuple[float, float]]] = [[(0.0, 0.0), (0.36, 0.0)], pot, rod, plate]
    return [_on_line(a, b, part, size) for part in parts]


def _rubbing(a: Array, b: Array, size: float) -> Lines:
    parts: list[list[tuple[float, float]]] = [
        [(0.0, 0.0), (0.35, 0.0), (0.35, 0.12), (0.65, 0.12)],
        [(1.0, 0.0), (0.65, 0.0), (0.65, -0.12), (0.35, -0.12)],
    ]
    parts += [[(s, -0.12), (s - 0.05, -0.4)] for s in (0.42, 0.5, 0.58, 0.66)]
    return [_on_line(a, b, part, size) for part in parts]


def _stop(a: Array, b: Array, size: float) -> Lines:
    parts: list[list[tuple[float, float]]] = [
        [(0.0, 0.0), (0.44, 0.0)],
        [(0.44, 0.4), (0.44, -0.4)],
        [(0.56, 0.4), (0.56, -0.4)],
        [(0.56, 0.0), (1.0, 0.0)],
    ]
    return [_on_line(a, b, part, size) for part in parts]


def _in_series(a: Array, b: Array, size: float) -> Lines:
    middle = (a + b) / 2
    return [*_zigzag(a, middle, size), *_dashpot(middle, b, size)]


def _carried(a: Array, b: Array, size: float) -> Lines:
    """A box whose middle is at ``a`` on a rod."""
    box, near = _box(a, b, size)
    return [box, np.array([near, b])]


def _sprung(a: Array, b: Array, size: float) -> Lines:
    """A box whose middle is at ``a`` on a spring."""
    box, near = _box(a, b, size)
    return [box, *_zigzag(near, b, size, 0.1, 0.9)]


def _box(a: Array, b: Array, size: float) -> tuple[Array, Array]:
    """A square (5, 2) about ``a``, and the middle (2,) of its side towards ``b``."""
    along, left = (0.5 * size * one for one in across(a, b))
    corners = [a + along + left, a + along - left, a - along - left, a - along + left]
    return np.array([*corners, corners[0]]), a + along


_SYMBOLS: dict[str, Callable[[Array, Array, float], Lines]] = {
    "added_inertia": _carried,
    "added_mass": _carried,
    "mode": _sprung,
    "payload": _carried,
    "spring": _zigzag,
    "damper": _dashpot,
    "damper_kinked": _dashpot,
    "drag": _dashpot,
    "eddy_brake": _dashpot,
    "power": _dashpot,
    "friction": _rubbing,
    "friction_dynamic": _rubbing,
    "hysteresis": _rubbing,
    "gap": _stop,
    "relaxation": _in_series,
    "hydromount": _in_series,
}
