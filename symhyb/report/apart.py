"""The picture of what recordings distinguish: odds of each cause against each other one."""

from typing import Any

import numpy as np

from symhyb.discrepancy.results import Isolability
from symhyb.discrepancy.words.wording import number_text
from symhyb.report.canvas import IN_DOUBT, MEASURED, SURE, UNSURE, drawing, svg

_SURE = np.log(100.0)  # evidence; with less a cause is not certain
# below 10 to 1 a cause is in doubt, below 100 to 1 it is not certain; by 1/odds
_ODDS_SHADES = ((0.1, IN_DOUBT), (0.01, UNSURE), (-1.0, SURE))
_ODDS_SHOWN = 13.8  # ln of a million


def apart_figure(matrix: Isolability) -> bytes:
    """Draw the odds with which the recordings distinguish causes: a row for the cause that acts, a
    column for the one that is tried in its place."""
    size = len(matrix.causes)
    with drawing(0.52 * size + 1.0) as figure:
        panel = figure.subplots()
        for row, words in enumerate(matrix.causes):
            name = f"{row + 1}  {words}" + (" (found)" if matrix.found[row] else "")
            panel.text(0.0, row - 0.02, name, va="bottom", color=MEASURED)
            for column, value in enumerate(matrix.evidence[row]):
                if np.isnan(value):
                    continue
                color = next(shade for least, shade in _ODDS_SHADES if np.exp(-value) > least)
                box = (column + 0.02, row + 0.05), 0.96, 0.5
                panel.add_patch(_rectangle(box, color))
                panel.text(column + 0.5, row + 0.3, odds_text(value), ha="center", va="center")
        panel.set_xlim(0.0, size + 1)
        panel.set_ylim(size, -0.5)
        panel.set_xticks(np.arange(size + 1) + 0.5, [*map(str, range(1, size + 1)), "nothing"])
        panel.set_xlabel("odds against the cause of the column where that of the row acts")
        panel.set_yticks([])
        panel.grid(False)
        for side in ("left", "bottom"):
            panel.spines[side].set_visible(False)
        panel.tick_params(length=0)
        return svg(figure)


def apart_sentence(matrix: Isolability) -> str | None:
    """Say that what was found is distinguished from every cause; None where it is not, or
    where nothing was found."""
    rows = matrix.evidence[np.array(matrix.found, dtype=bool)]
    least = float(np.nanmin(rows)) if np.isfinite(rows).any() else 0.0
    if least < _SURE:
        return None
    odds = "more than 10⁶" if least > _ODDS_SHOWN else f"at least {odds_text(least)}"
    return (
        f"The recordings favour what was found over every cause that comes near by odds of {odds} "
        "to 1."
    )


def odds_text(evidence: float) -> str:
    """Write odds from their logarithm: ``1.2``, ``45``, ``> 10⁶``."""
    if evidence > _ODDS_SHOWN:
        return "> 10⁶"
    return number_text(float(np.exp(max(evidence, 0.0))), digits=2)


def _rectangle(box: tuple[tuple[float, float], float, float], color: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle(*box, facecolor=color, edgecolor="none")
