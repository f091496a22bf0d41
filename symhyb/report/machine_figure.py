"""The drawing of a machine as a picture."""

from typing import TYPE_CHECKING

import numpy as np

from symhyb.report.canvas import (
    AFTER,
    DRIVEN,
    FILLED,
    LAW,
    LINK,
    MEASURED,
    PAPER,
    QUIET,
    WIDTH,
    drawing,
    picture,
)
from symhyb.report.series import Array, shortened
from symhyb.report.sketch import Sketch
from symhyb.report.sketch_draft import BOX, Mark

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLORS = {
    "body": MEASURED,
    "link": LINK,
    "element": MEASURED,
    "ground": QUIET,
    "coordinate": AFTER,
    "input": DRIVEN,
    "axis": QUIET,
}
_HEIGHTS = (1.6, 6.5)  # inches
_ASIDE = 0.4  # of a direction, from where on a text stands to that side


def machine_figure(sketch: Sketch, title: str = "", suffix: str = ".svg") -> bytes:
    """Draw a machine: bodies and links dark, coordinates blue with an arrow where they are
    positive, applied forces brown, what is emphasised red. The bytes are an SVG or a PNG."""
    places = np.vstack([mark.at for mark in sketch.marks]) if sketch.marks else np.zeros((1, 2))
    low, high = places.min(axis=0) - 1.6 * sketch.size, places.max(axis=0) + 1.6 * sketch.size
    shape = (high[1] - low[1]) / max(high[0] - low[0], 1e-300)
    with drawing(float(np.clip(WIDTH * shape, *_HEIGHTS)) + 0.3) as figure:
        panel = figure.add_subplot()
        panel.set_axis_off()
        panel.set_aspect("equal")
        panel.set_xlim(float(low[0]), float(high[0]))
        panel.set_ylim(float(low[1]), float(high[1]))
        if title:
            figure.suptitle(shortened(title), x=0.01, ha="left", fontsize=9)
        for mark in sketch.marks:
            _draw(panel, mark, sketch.size)
        return picture(figure, suffix)


def _draw(panel: "Axes", mark: Mark, size: float) -> None:
    color = LAW if mark.shown else _COLORS[mark.role]
    wide = 3.2 if mark.role == "link" else 1.2
    x, y = mark.at.T
    match mark.shape:
        case "line":
            panel.plot(x, y, color=color, lw=wide + 0.8 * mark.shown, solid_capstyle="round")
        case "arrow":
            panel.plot(x, y, color=color, lw=1.3)
            head = {"arrowstyle": "-|>", "color": color, "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
            panel.annotate("", mark.at[-1], mark.at[-2], arrowprops=head)
        case "body":
            side = BOX * size
            corners = mark.at[0] + side * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
            panel.fill(*corners.T, facecolor=FILLED, edgecolor=color, lw=1.2, zorder=4)
            _write(panel, mark, mark.at[0] - [0, 1.15 * side], color, "center", "top")
        case "pivot":
            panel.plot(x, y, "o", color=PAPER, mec=color, mew=1.3, ms=5, zorder=5)
        case "text":
            across, up = mark.away
            ha = "center" if abs(across) < _ASIDE else ("left" if across > 0 else "right")
            va = "center" if abs(up) < _ASIDE else ("bottom" if up > 0 else "top")
            _write(panel, mark, mark.at[0], color, ha, va)


def _write(panel: "Axes", mark: Mark, at: Array, color: str, ha: str, va: str) -> None:
    text = shortened(mark.text, 24)
    panel.text(at[0], at[1], text, color=color, fontsize=8, ha=ha, va=va, zorder=6)
