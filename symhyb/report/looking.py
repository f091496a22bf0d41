"""A picture of a whole recording: every channel over time, one above the other."""

from symhyb.data.look import Look
from symhyb.report.canvas import MEASURED, QUIET, bracketed, drawing, picture
from symhyb.report.series import envelope, shortened

PANEL = 1.25  # inches
PANELS_MOST = 24


def look_figure(look: Look, suffix: str = ".svg") -> bytes:
    """Draw the channels of a recording over time in s, each in its unit, at most the first 24; gaps
    in time and what is missing stay open, times at rest are grey."""
    shown = look.signals[:PANELS_MOST]
    with drawing(PANEL * len(shown) + 0.5) as figure:
        panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        for panel, one in zip(panels, shown, strict=True):
            for start, end in one.rest:
                panel.axvspan(start, end, color=QUIET, alpha=0.15, lw=0)
            panel.plot(*envelope(look.t, one.values), color=MEASURED, lw=0.8)
            panel.set_title(shortened(one.name) + bracketed(one.unit) * bool(one.unit))
        panels[-1].set_xlabel("time [s]")
        return picture(figure, suffix)
