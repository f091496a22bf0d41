"""The picture of a frequency response: measured and simulated gain, phase and coherence."""

from typing import TYPE_CHECKING

import numpy as np

from symhyb.discrepancy.checks.response import Response
from symhyb.discrepancy.words.wording import number_text
from symhyb.report.canvas import AFTER, BEFORE, DASHED, MEASURED, SHADE, drawing, legend, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LINES_LEAST = 3  # of a response, that make a picture
_COLORS = {"model": (BEFORE, "before"), "corrected": (AFTER, "after")}
_LINES_JOINED = 40  # fewer are drawn as dots too: these are the lines of a periodic drive
_DIM = 0.5  # coherence, below which the measured gain says little


def response_figure(response: Response) -> bytes:
    """Draw the response of a sensor to its first drive, SI: gain, phase and coherence over
    frequency; measured and simulated lie over each other."""
    runs = {"measured": (response.measured, MEASURED)}
    for name, gain in response.simulated.items():
        color, word = _COLORS.get(name, (AFTER, name))
        runs[word] = (gain, color)
    style = {"marker": "."} if response.frequency.size < _LINES_JOINED else {}
    with drawing(5.0) as figure:
        panels = figure.subplots(3, 1, sharex=True, height_ratios=[2.2, 1.2, 0.8])
        for word, (gain, color) in runs.items():
            shown = gain[:, 0]
            line = {"color": color, "ls": DASHED if color == BEFORE else "-", **style}
            panels[0].plot(response.frequency, np.abs(shown), **line)
            angle = _unjoined(np.degrees(np.angle(shown)))
            panels[1].plot(response.frequency, angle, label=word, **line)
        panels[2].plot(response.frequency, response.coherence, color=MEASURED, **style)
        panels[2].axhspan(0.0, _DIM, color=SHADE, zorder=0)
        _label(panels, response)
        return svg(figure)


def _label(panels: "list[Axes]", response: Response) -> None:
    from matplotlib.ticker import LogLocator

    panels[0].set_yscale("log")
    panels[0].yaxis.set_major_formatter(lambda value, _: number_text(float(value)))
    panels[0].yaxis.set_minor_formatter("")
    panels[0].set_title(f"gain of {response.sensor} from {response.drives[0]} [SI]")
    panels[1].set_title("phase [°]")
    legend(panels[1])  # where the title is short
    panels[1].set_ylim(-190, 190)
    panels[1].set_yticks([-180, -90, 0, 90, 180])
    panels[2].set_title("coherence")
    panels[2].set_ylim(0.0, 1.05)
    low, high = float(response.frequency[0]), float(response.frequency[-1])
    if high > 20 * low:
        panels[2].set_xscale("log")
        panels[2].xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        panels[2].xaxis.set_major_formatter(lambda value, _: number_text(float(value)))
        panels[2].xaxis.set_minor_formatter("")
    panels[2].set_xlabel("frequency [Hz]")


def _unjoined(angle: np.ndarray) -> np.ndarray:
    """Angles without the strokes where they jump by a whole turn."""
    shown = angle.astype(float).copy()
    shown[1:][np.abs(np.diff(angle)) > 270] = np.nan
    return shown
