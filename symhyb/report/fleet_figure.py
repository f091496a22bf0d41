"""A picture of a fleet: its numbers, unit by unit, over conditions or in the order of the study."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.words.wording import unit_text
from symhyb.report.canvas import (
    AFTER,
    BAND,
    BEFORE,
    MEASURED,
    QUIET,
    bracketed,
    drawing,
    picture,
)
from symhyb.report.series import shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEIGHT = 1.7  # inches of a row
ROWS_MOST = 16
WITHIN = 2.0  # spreads between units that the band shows


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One number in its ``unit`` over ``x`` (N,), called ``over``: values ``y`` ± ``sd`` (N,) of
    the units, the population as a ``line`` (2,) over its ``ends`` (2,) with the ``spread`` (2,)
    between units, and the names of units that are ``odd`` (N), empty for the others."""

    name: str
    unit: str
    over: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    sd: NDArray[np.float64]
    ends: NDArray[np.float64]
    line: NDArray[np.float64]
    spread: NDArray[np.float64]
    odd: Sequence[str]


def fleet_figure(panels: Sequence[Sequence[Panel]], title: str, suffix: str = ".svg") -> bytes:
    """Draw panels, a row for each number (at most 16): estimates with one deviation, the mean with
    twice the spread between units, and the units that deviate by name."""
    shown = panels[:ROWS_MOST]
    with drawing(HEIGHT * len(shown) + 0.6) as figure:
        grid = figure.subplots(len(shown), len(shown[0]), sharex="col", sharey="row", squeeze=False)
        for axes, row in zip(grid, shown, strict=True):
            for axis, one in zip(axes, row, strict=True):
                _draw(axis, one)
            axes[0].set_title(shortened(row[0].name) + bracketed(unit_text(row[0].unit)))
        for axis, one in zip(grid[-1], shown[-1], strict=True):
            axis.set_xlabel(shortened(one.over))
        if title:
            figure.suptitle(shortened(title), fontsize=9.0)
        return picture(figure, suffix)


def _draw(axis: "Axes", one: Panel) -> None:
    wide = WITHIN * one.spread
    axis.fill_between(one.ends, one.line - wide, one.line + wide, color=BAND, lw=0)
    axis.plot(one.ends, one.line, color=AFTER)
    odd = np.array([bool(name) for name in one.odd])
    for chosen, color in ((~odd, MEASURED), (odd, BEFORE)):
        x, y, sd = one.x[chosen], one.y[chosen], one.sd[chosen]
        sd = np.where(np.isfinite(sd), sd, 0.0)
        axis.errorbar(x, y, sd, fmt="o", ms=2.2, lw=0.6, color=color, ecolor=QUIET)
    for i in np.flatnonzero(odd).tolist():
        axis.annotate(
            shortened(one.odd[i]),
            (float(one.x[i]), float(one.y[i])),
            xytext=(3, 2),
            textcoords="offset points",
            fontsize=6.5,
            color=BEFORE,
        )
