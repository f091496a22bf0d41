"""Where rivals would differ from what was chosen: the picture and the sentences."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from symhyb.discrepancy.results import RivalRun
from symhyb.discrepancy.words.wording import capital, number_text, percent_text
from symhyb.report.canvas import (
    AFTER,
    BAND,
    BEFORE,
    DASHED,
    LAW,
    QUIET,
    bracketed,
    drawing,
    svg,
)
from symhyb.report.series import envelope, shortened, shown_unit
from symhyb.units import Unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SENSORS_MOST = 3
WIDE = 2.0  # standard deviations, as of every band of noise on the page
HIDDEN = 0.25  # of that band: below it a line shows nothing
ALIKE = 0.01  # standard deviations that no picture shows
_LINES = ((AFTER, "-"), (BEFORE, DASHED), (LAW, "-"))


def rivals_figure(rivals: Sequence[RivalRun], units: Mapping[str, Unit]) -> bytes:
    """Draw what each of at most three rivals simulates less what the chosen structure does, over
    time, for the sensors that differ most, over a band of two deviations of their noise; what the
    first of them hides in its band is enlarged below. ``units`` by sensor, else SI. The bytes are
    an SVG."""
    peaks = _peaks(rivals)
    most = max(peaks, key=lambda sensor: peaks[sensor])
    shown = [(sensor, False) for sensor in peaks]
    if peaks[most] < HIDDEN * WIDE:
        shown.insert(shown.index((most, False)) + 1, (most, True))
    with drawing(1.45 * len(shown) + 0.22 * len(rivals) + 0.6) as figure:
        panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
        for panel, (sensor, enlarged) in zip(panels, shown, strict=True):
            _differences(panel, rivals, sensor, units.get(sensor, Unit("SI")), enlarged)
        panels[-1].set_xlabel("time [s]")
        handles, labels = panels[shown.index((most, False))].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=1)
        return svg(figure)


def _peaks(rivals: Sequence[RivalRun]) -> dict[str, float]:
    """By how many deviations of their noise sensors differ at most, of those that differ most, in
    the order of the model."""
    peaks: dict[str, float] = {}
    for run in rivals:
        for sensor, values in run.apart.items():
            peak = float(np.nanmax(np.abs(values))) / run.noise[sensor]
            peaks[sensor] = max(peaks.get(sensor, 0.0), peak)
    most = sorted(peaks, key=lambda sensor: -peaks[sensor])[:SENSORS_MOST]
    return {sensor: peak for sensor, peak in peaks.items() if sensor in most}


def _differences(
    panel: "Axes", rivals: Sequence[RivalRun], sensor: str, unit: Unit, enlarged: bool
) -> None:
    runs = [run for run in rivals if sensor in run.apart]
    wide = WIDE * runs[0].noise[sensor] / unit.factor
    peak = max(float(np.nanmax(np.abs(run.apart[sensor]))) for run in runs) / unit.factor
    scale, text = shown_unit(peak if enlarged else max(peak, wide), unit.text)
    panel.axhspan(-wide / scale, wide / scale, color=BAND, lw=0, zorder=0)
    panel.axhline(0.0, color=QUIET, lw=0.8)
    for run, (color, style) in zip(rivals, _LINES, strict=False):
        if sensor not in run.apart:
            continue
        values = run.apart[sensor] / unit.factor / scale
        panel.plot(*envelope(run.t, values), color=color, ls=style, label=shortened(run.causes))
        where, time, _ = run.largest
        if where == sensor:
            at = values[np.searchsorted(run.t, time)]
            panel.plot([time], [at], "D", color=color, ms=4.5)
    if enlarged and peak > 0:
        panel.set_ylim(-1.25 * peak / scale, 1.25 * peak / scale)
    name = f"enlarged: {shortened(sensor, 28)}" if enlarged else shortened(sensor, 40)
    panel.set_title(f"{name}, rival less chosen{bracketed(text)}")


def rival_sentence(run: RivalRun) -> str:
    """Where a rival would differ most from the chosen structure, and whether one sample shows
    that."""
    sensor, time, deviations = run.largest
    chance = "" if run.probability is None else f" (probability {percent_text(run.probability)})"
    said = f"{capital(run.causes)} in place of {run.instead_of}{chance}:"
    size = abs(deviations)
    if size < ALIKE:
        return f"{said} nowhere in {run.recording} would any sensor show a difference."
    rms = number_text(run.typical[sensor], digits=2)
    shows = "one sample there shows it" if size > WIDE else "no single sample shows it"
    return (
        f"{said} {sensor} would differ most, at t = {number_text(time)} s of {run.recording}, by "
        f"{number_text(size, digits=2)} standard deviations of its noise ({rms} RMS over all "
        f"windows); {shows}."
    )
