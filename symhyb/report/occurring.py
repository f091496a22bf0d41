"""The picture of when, and at which frequencies, the mismatch of a place acts."""

from typing import TYPE_CHECKING

import numpy as np

from symhyb.discrepancy.results import Occurrence
from symhyb.discrepancy.words.wording import number_text
from symhyb.report.canvas import (
    AFTER,
    BEFORE,
    DASHED,
    LAW,
    QUIET,
    SHADE,
    drawing,
    legend,
    svg,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEAST = 1e-3  # of what is left over: that a logarithmic axis shows


def occurrence_figure(occurrence: Occurrence) -> bytes:
    """Draw when a place's mismatch acts (what is left of every window, as it is and with the best
    force of the place's own motion) and at which frequencies."""
    with drawing(4.2 if occurrence.lines.size else 2.3) as figure:
        panels = figure.subplots(2 if occurrence.lines.size else 1, 1, squeeze=False)[:, 0]
        _when(panels[0], occurrence)
        if occurrence.lines.size:
            _frequencies(panels[1], occurrence)
        return svg(figure)


def _when(panel: "Axes", occurrence: Occurrence) -> None:
    for values, color, style, word in (
        (occurrence.before, BEFORE, DASHED, "as it is"),
        (occurrence.after, AFTER, "-", "best force here"),
    ):
        shown = np.maximum(values, _LEAST)
        panel.step(occurrence.t, shown, where="mid", color=color, ls=style, label=word)
    panel.axhline(1.0, color=QUIET, lw=0.8, ls="--", label="noise")
    panel.set_yscale("log")
    panel.yaxis.set_major_formatter(lambda value, _: number_text(float(value)))
    panel.yaxis.set_minor_formatter("")
    panel.set_title("squared error / noise")
    if occurrence.change is not None:
        panel.axvline(occurrence.change.time_s, color=LAW)
        panel.annotate(
            f"{occurrence.change.kind} ",
            (occurrence.change.time_s, 0.97),
            xycoords=panel.get_xaxis_transform(),
            color=LAW,
            ha="right",
            va="top",
        )
    legend(panel)
    panel.set_xlabel("time [s]")


def _frequencies(panel: "Axes", occurrence: Occurrence) -> None:
    panel.fill_between(occurrence.lines, 0.0, occurrence.power, color=AFTER, lw=0.0)
    if occurrence.band_hz is not None:
        panel.axvspan(*occurrence.band_hz, color=SHADE, zorder=0)
    panel.set_title("power of the missing force, over its largest")
    panel.set_xlabel("frequency [Hz]")
    panel.set_ylim(0.0, 1.05)
