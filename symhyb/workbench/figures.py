"""What is drawn on the workbench, by Bokeh, in the style of the report.

Figures are made once for what they show; values that change are new data of their sources.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symhyb.data.look import FEWEST, Look, Signal, spectrum_of
from symhyb.report.canvas import AFTER, BAND, BEFORE, MEASURED, QUIET, bracketed
from symhyb.report.live import packed, panel_of, within_reach, zero_line
from symhyb.report.series import Array, extremes, shortened, shown_unit, spread
from symhyb.workbench.lacking import Lacking, Span, rows_within
from symhyb.workbench.simulated import Compared, Shown

BINS = 450  # of a line over time: six points each at most, about one a pixel
CLOUD = 3000  # samples of a cloud
SPECTRUM_LEAST = 1e-14  # of the largest line of a spectrum: what is drawn
NARROW = 290  # pixels, that two figures beside each other have at least
WRAPPED = {"flex-wrap": "wrap"}
CHANNELS = 24  # of a recording that are drawn


@dataclass(frozen=True, slots=True)
class Drawn:
    """Figures in a ``layout``, with their ``sources`` and the ``scales`` of what they show, one a
    sensor or coordinate."""

    layout: Any
    sources: tuple[Any, ...]
    scales: tuple[float, ...] = ()
    figures: tuple[Any, ...] = ()


def recording_figures(look: Look) -> Any:
    """Every channel over time, and its spectrum beside it."""
    from bokeh.layouts import column, row

    across = _times(look.t)
    rows = [
        row(*_channel(look, one, across), sizing_mode="stretch_width", spacing=4, styles=WRAPPED)
        for one in look.signals[:CHANNELS]
    ]
    return column(*rows, sizing_mode="stretch_width", spacing=2)


def _channel(look: Look, one: Signal, across: Any) -> list[Any]:
    from bokeh.models import ColumnDataSource

    title = f"{shortened(one.name, 40)}{bracketed(one.unit) if one.unit else ''}"
    kept = extremes([one.values], BINS)
    data = ColumnDataSource({"t": look.t[kept], "y": packed(one.values, kept, 1.0)})
    time = zoomed(panel_of(title, 170, across, min_width=NARROW))
    time.line("t", "y", source=data, color=AFTER, line_width=1.2)
    labelled(time, "time [s]")
    known = np.isfinite(one.values)
    if known.sum() < FEWEST or one.low == one.high:
        return [time]  # a constant has no spectrum
    frequency, power = spectrum_of(look.t[known], one.values[known], 1 / one.rate)
    seen = (frequency > 0) & (power > SPECTRUM_LEAST * power.max())
    beside = panel_of(
        f"power of {shortened(one.name, 24)}{_squared(one.unit)}",
        170,
        _frequencies(frequency[seen]),
        x_axis_type="log",
        y_axis_type="log",
        max_width=380,
        min_width=NARROW,
    )
    beside.line(frequency[seen], power[seen], color=AFTER, line_width=1.2)
    labelled(beside, "frequency [Hz]")
    return [time, beside]


def _squared(unit: str) -> str:
    return "" if not unit else bracketed(unit if unit == "1" else f"({unit})²")


def _frequencies(known: Array) -> Any:
    from bokeh.models import Range1d

    low, high = (float(known.min()), float(known.max())) if known.size > 1 else (0.1, 10.0)
    return Range1d(start=low, end=high)


def simulation_figures(first: Shown) -> Drawn:
    """Every sensor, measured and simulated, with the residual below it; `simulation_data` fills
    the sources."""
    from bokeh.layouts import column
    from bokeh.models import ColumnDataSource

    across, figures, sources, scales = _times(first.t), [], [], []
    for one in first.sensors:
        scale, label = shown_unit(spread([one.measured]), one.sensor.unit.text)
        names = ("t", "measured", "file", "shown", "less")
        source = ColumnDataSource({name: np.empty(0) for name in names})
        upper = zoomed(panel_of(f"{shortened(one.sensor.name, 40)}{bracketed(label)}", 220, across))
        pale = {"line_width": 4.0, "line_alpha": 0.45}
        upper.line("t", "measured", source=source, color=MEASURED, **pale)
        upper.line("t", "file", source=source, color=BEFORE, line_dash=[7, 3], line_width=1.5)
        upper.line("t", "shown", source=source, color=AFTER, line_width=1.5)
        lower = zoomed(panel_of(f"simulated less measured{bracketed(label)}", 130, across))
        lower.line("t", "less", source=source, color=AFTER, line_width=1.2)
        zero_line(lower)
        upper.xaxis.visible = False
        labelled(lower, "time [s]")
        figures += [upper, lower]
        sources.append(source)
        scales.append(scale)
    layout = column(*figures, sizing_mode="stretch_width", spacing=2)
    return Drawn(layout, tuple(sources), tuple(scales))


def simulation_data(
    t: Array, shown: Compared, filed: Compared | None, scale: float
) -> dict[str, Any]:
    """The columns (N,) of a sensor: measured, by the model of the file (where that is another), by
    the one that is shown, and what the latter errs, in the unit that is shown."""
    run = within_reach(shown.simulated, shown.measured)
    before = np.full_like(run, np.nan)
    if filed is not None:
        before = within_reach(filed.simulated, filed.measured)
    kept = extremes([shown.measured, run, before], BINS)
    less = run - shown.measured
    columns = {"measured": shown.measured, "file": before, "shown": run, "less": less}
    return {"t": t[kept]} | {name: packed(one, kept, scale) for name, one in columns.items()}


def force_figures(found: Sequence[Lacking], t: Array) -> Drawn:
    """ΔF of every coordinate over time ``t`` (N,), s, with its band, and over place and over rate;
    `force_data` fills the sources. A range that is brushed over time stands out in all."""
    from bokeh.layouts import column, row
    from bokeh.models import BoxSelectTool, ColumnDataSource, DataRange1d

    across, rows, sources, scales, figures = _times(t), [], [], [], []
    for one in found:
        scale, label = shown_unit(spread([one.force]), one.force_unit.text)
        names = ("t", "force", "high", "low", "place", "rate")
        source = ColumnDataSource({name: np.empty(0) for name in names})
        name = shortened(one.coordinate, 30)
        over = panel_of(f"ΔF on {name}{bracketed(label)}", 220, across)
        over.varea("t", "low", "high", source=source, fill_color=BAND, level="underlay")
        over.line("t", "force", source=source, color=QUIET, line_width=1.0)
        _cloud(over, source, "t", 2.0)
        zero_line(over)
        brush = BoxSelectTool(dimensions="width")
        zoomed(over)
        over.add_tools(brush)
        over.toolbar.active_drag = brush
        labelled(over, "time [s]")
        clouds = []
        units = (("place", one.place_unit.text, name), ("rate", one.rate_unit.text, f"{name}'"))
        for key, unit, what in units:
            cloud = panel_of(
                f"ΔF over {what}{bracketed(label)}", 240, DataRange1d(), min_width=NARROW
            )
            zoomed(cloud)
            _cloud(cloud, source, key, 3.0)
            zero_line(cloud)
            labelled(cloud, f"{what}{bracketed(unit)}")
            clouds.append(cloud)
        rows += [over, row(*clouds, sizing_mode="stretch_width", spacing=4, styles=WRAPPED)]
        figures.append(over)
        sources.append(source)
        scales.append(scale)
    layout = column(*rows, sizing_mode="stretch_width", spacing=2)
    return Drawn(layout, tuple(sources), tuple(scales), tuple(figures))


def _cloud(panel: Any, source: Any, across: str, size: float) -> None:
    panel.scatter(
        across,
        "force",
        source=source,
        size=size,
        color=AFTER,
        alpha=0.55,
        line_color=None,
        nonselection_alpha=0.06,
        nonselection_color=QUIET,
        nonselection_line_color=None,
        selection_color=BEFORE,
        selection_alpha=0.8,
        selection_line_color=None,
    )


def thinned_rows(samples: int) -> Any:
    """Which of so many samples are drawn in clouds: evenly, `CLOUD` at most."""
    return np.unique(np.linspace(0, samples - 1, min(samples, CLOUD)).astype(int))


def force_data(one: Lacking, scale: float) -> dict[str, Any]:
    """The columns of one coordinate: ΔF with two deviations to either side, in the unit that is
    shown, at evenly picked samples."""
    kept = thinned_rows(one.t.size)
    wide = 2 * one.band
    return {
        "t": one.t[kept],
        "force": packed(one.force, kept, scale),
        "high": packed(one.force + wide, kept, scale),
        "low": packed(one.force - wide, kept, scale),
        "place": packed(one.place, kept, 1.0),
        "rate": packed(one.rate, kept, 1.0),
    }


def brushed(one: Lacking, span: Span | None) -> list[int]:
    """Which of the drawn samples lie in a range of time, s; none are marked without one."""
    if span is None:
        return []
    return [int(i) for i in np.flatnonzero(rows_within(one, span)[thinned_rows(one.t.size)])]


def zoomed(panel: Any) -> Any:
    """A figure with the tools to move in it and to see all again; they show where the pointer is.
    (Of the report they are buttons below the figures.)"""
    from bokeh.models import PanTool, ResetTool

    panel.add_tools(PanTool(dimensions="width"), ResetTool())
    panel.toolbar_location = "right"
    panel.toolbar.autohide = True
    panel.toolbar.logo = None
    panel.yaxis.ticker.desired_num_ticks = 5 if panel.height > 150 else 3
    return panel


def labelled(panel: Any, across: str) -> None:
    """Name what stands below a figure; plain text, for a name between dollars is no formula."""
    from bokeh.models import PlainText

    panel.xaxis.axis_label = PlainText(text=across)
    panel.xaxis.axis_label_text_font_style = "normal"
    panel.xaxis.axis_label_text_font_size = "12px"
    panel.xaxis.axis_label_standoff = 2


def _times(t: Array) -> Any:
    from bokeh.models import Range1d

    low, high = float(t[0]), float(t[-1])
    return Range1d(start=low, end=high, bounds=(low, high))
