"""Where the panels of a figure lie: rows and columns with room for what stands around each.

matplotlib's constrained layout measures every artist twice. Here heights come from the type alone,
widths from numbers and texts measured once, at the height that they are drawn at. Import it where a
figure is made: it needs matplotlib.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import LayoutEngine
from matplotlib.text import Text
from numpy.typing import NDArray

# points
_TYPE = 9.0  # the size of it
_EDGE = 3.0  # around everything
_BETWEEN = 7.0, 2.0  # columns, rows
_GUESS = 36.0  # beside a panel, before its numbers are measured
_HALF_NUMBER = 11.0  # of an axis, beyond its end
_LINE = 1.25  # of type, over its size
_ROUNDS = 3  # of texts, whose anchors move with the width


Lengths = NDArray[np.float64]


class _Room(NamedTuple):
    """What stands around a panel, in pixels."""

    left: float
    right: float
    below: float
    above: float


class Stacked(LayoutEngine):
    """Places the panels of a figure by rows and columns of one grid."""

    _adjust_compatible = False
    _colorbar_gridspec = True

    def execute(self, fig: Figure) -> None:
        """Place all panels that stand in a grid."""
        panels = [panel for panel in fig.axes if panel.get_subplotspec() is not None]
        if not panels:
            return
        renderer = RendererAgg(1, 1, fig.dpi)  # type: ignore[no-untyped-call]
        point = fig.dpi / 72.0
        head = _head(fig, renderer)
        heights = [(_below(panel) * point, _above(panel, renderer)) for panel in panels]
        guess = [_Room(_GUESS * point, _GUESS * point, *pair) for pair in heights]
        _place(fig, panels, guess, head)
        sides = [_numbers(panel, renderer) for panel in panels]
        rooms = [_Room(*side, *pair) for side, pair in zip(sides, heights, strict=True)]
        _place(fig, panels, rooms, head)
        texts = [_sticking_out(panel, panel.texts, renderer) for panel in panels]
        for _ in range(_ROUNDS if any(texts) else 0):
            pairs = zip(panels, texts, strict=True)
            beyond = [_beyond(panel, some, renderer) for panel, some in pairs]
            both = zip(rooms, beyond, strict=True)
            _place(fig, panels, [_Room(*map(max, *pair)) for pair in both], head)


def _place(fig: Figure, panels: Sequence[Axes], rooms: Sequence[_Room], head: float) -> None:
    """Put panels where the rooms around them leave place, below a ``head`` in pixels."""
    places: list[Any] = [panel.get_subplotspec() for panel in panels]
    grid = places[0].get_gridspec()
    across = [place.colspan.start for place in places]
    down = [place.rowspan.start for place in places]
    wide, tall = fig.bbox.size
    edge, aside, between = (size * fig.dpi / 72.0 for size in (_EDGE, *_BETWEEN))
    lefts = _largest(across, [room.left for room in rooms], grid.ncols)
    rights = _largest(across, [room.right for room in rooms], grid.ncols)
    tops = _largest(down, [room.above for room in rooms], grid.nrows)
    bottoms = _largest(down, [room.below for room in rooms], grid.nrows)
    widths = _shared(wide - 2 * edge, lefts + rights, grid.get_width_ratios(), aside)
    heights = _shared(tall - 2 * edge - head, tops + bottoms, grid.get_height_ratios(), between)
    starts = edge + np.cumsum(lefts + np.r_[0.0, (widths + rights + aside)[:-1]])
    ends = tall - edge - head - np.cumsum(tops + np.r_[0.0, (heights + bottoms + between)[:-1]])
    for panel, i, j in zip(panels, down, across, strict=True):
        box = (starts[j], ends[i] - heights[i], widths[j], heights[i])
        panel.set_position(np.divide(box, (wide, tall, wide, tall)).tolist())
        panel.apply_aspect()
        if panel.get_xlabel():
            label = -_ticks(panel) * fig.dpi / 72.0 / heights[i]
            panel.xaxis.set_label_coords(0.5, label)


def _largest(where: Sequence[int], values: Sequence[float], count: int) -> Lengths:
    """The largest value of each row or column (count,)."""
    largest = np.zeros(count)
    np.maximum.at(largest, list(where), list(values))
    return largest


def _shared(whole: float, taken: Lengths, ratios: Iterable[float], between: float) -> Lengths:
    """What panels get (count,) of the ``whole``, by their ratios; never less than a pixel."""
    share = np.asarray(list(ratios), dtype=float)
    free = whole - taken.sum() - between * (taken.size - 1)
    return np.asarray(np.maximum(free * share / share.sum(), 1.0))


def _head(fig: Figure, renderer: RendererAgg) -> float:
    """The height of a title and of legends above all panels, in pixels."""
    point = fig.dpi / 72.0
    title = 2 * _LINE * _TYPE * point if fig.get_suptitle() else 0.0
    legends = [one.get_window_extent(renderer).height + 8.0 * point for one in fig.legends]
    return max([title, *legends])


def _above(panel: Axes, renderer: RendererAgg) -> float:
    """The height of the title or the legend above a panel, in pixels."""
    point = panel.figure.dpi / 72.0
    size = float(panel.title.get_fontsize()) * _LINE
    title = size + 5.0 if panel.get_title(loc="left") else 0.5 * size if panel.axison else 0.0
    legend = panel.get_legend()
    return max(title * point, legend.get_window_extent(renderer).height if legend else 0.0)


def _ticks(panel: Axes) -> float:
    """The height of the numbers below a panel with their ticks, in points."""
    shown = panel.axison and panel.xaxis.get_tick_params()["labelbottom"]
    return 6.0 + _TYPE * _LINE if shown else 4.0


def _below(panel: Axes) -> float:
    """The height of numbers and label below a panel, in points."""
    if not panel.axison:
        return 0.0
    return _ticks(panel) + (2.0 + _TYPE * _LINE if panel.get_xlabel() else 0.0)


def _numbers(panel: Axes, renderer: RendererAgg) -> tuple[float, float]:
    """The room that numbers take on the left and on the right of a panel, in pixels."""
    if not panel.axison:
        return 0.0, 0.0
    point, inside = panel.figure.dpi / 72.0, panel.bbox
    box = panel.yaxis.get_tightbbox(renderer)
    ends = _HALF_NUMBER * point if panel.xaxis.get_tick_params()["labelbottom"] else 0.0
    if box is None:  # no numbers there: those below may stand at both ends
        ends, box = 0.0, panel.xaxis.get_tightbbox(renderer) or inside
    return max(inside.x0 - box.x0, 0.0), max(box.x1 - inside.x1, ends)


def _sticking_out(panel: Axes, texts: Iterable[Text], renderer: RendererAgg) -> list[Text]:
    """The texts of a panel that are not wholly within it."""
    return [text for text in texts if any(_beyond(panel, [text], renderer))]


def _beyond(panel: Axes, texts: Iterable[Text], renderer: RendererAgg) -> _Room:
    """How far texts reach beyond a panel, in pixels."""
    room, inside = _Room(0.0, 0.0, 0.0, 0.0), panel.bbox
    for text in texts:
        box = text.get_window_extent(renderer)
        sides = inside.x0 - box.x0, box.x1 - inside.x1, inside.y0 - box.y0, box.y1 - inside.y1
        room = _Room(*map(max, room, sides))
    return room
