"""Figures of a recording over time that can be zoomed, by Bokeh: one time axis for all of them.

What is drawn here is drawn as SVG too, for print and for browsers without scripts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symhyb.discrepancy.results import Cloud, Trace
from symhyb.report.canvas import AFTER, BAND, BEFORE, LAW, MEASURED, QUIET, SHADE, bracketed
from symhyb.report.series import Array, extremes, shortened, shown_unit, spread
from symhyb.units import Unit

POINTS = 150_000  # numbers that all figures of a page may hold: some 0.8 MB of text
_BINS_LEAST, _BINS_MOST = 150, 3000
_FAR = 1.0  # ranges of the measurement: a run farther away has left the figure
SIGMAS = 2.0  # of the bands of residuals

# what can be switched on and off: the name of the drawn lines, the words, the colour
SWITCHES = (
    ("measured", "measured", MEASURED),
    ("before", "before", BEFORE),
    ("after", "after", AFTER),
    ("left", "residual before", BEFORE),
    ("force", "ΔF", QUIET),
    ("law", "found law", LAW),
)


@dataclass(frozen=True, slots=True)
class Signal:
    """One measured signal of a trace, in what unit it is shown, and one standard deviation of the
    noise of its sensor in that unit, None where it is not known."""

    sensor: str
    unit: Unit
    noise: float | None = None


@dataclass(frozen=True, slots=True)
class Live:
    """The figures of one recording: ``item`` is what Bokeh is given, ``switches`` what can be
    switched off (name, words, colour), ``height`` what they take, in pixels."""

    item: Mapping[str, Any]
    switches: tuple[tuple[str, str, str], ...]
    height: int


def live_figures(
    trace: Trace,
    signals: Sequence[Signal],
    clouds: Sequence[tuple[Cloud, Unit, str]],
    target: str,
    share: float = 1.0,
) -> Live:
    """Draw a recording over time: every signal with its residual, and ΔF of ``clouds`` (with the
    unit of force and the words of the place). ``target`` is the id of the element of the page that
    takes the figures, ``share`` the part of ``POINTS`` that they may hold."""
    from bokeh.core.types import ID
    from bokeh.embed import json_item
    from bokeh.layouts import column
    from bokeh.models import Range1d

    same = all(_same(trace, signal.sensor) for signal in signals)
    columns = len(signals) * (5 if same else 7) + 5 * len(clouds)
    rows = int(share * POINTS / max(columns, 1))
    bins = int(np.clip(rows // (6 if same else 8), _BINS_LEAST, _BINS_MOST))
    low, high = _span(trace.t)
    across = Range1d(start=low, end=high, bounds=(low, high), name="time")
    figures: list[Any] = []
    for signal in signals:
        figures += _of_signal(trace, signal, bins, across)
    figures += [_of_cloud(cloud, unit, words, bins, across) for cloud, unit, words in clouds]
    for one in figures[:-1]:
        one.xaxis.visible = False
    figures[-1].xaxis.axis_label = "time [s]"
    figures[-1].xaxis.axis_label_text_font_style = "normal"
    figures[-1].height += 44
    _link(figures)
    names = {item.name for one in figures for item in one.renderers}
    words = {"after": "simulated"} if same else {}
    tall = sum(one.height for one in figures) + 2 * len(figures)
    return Live(
        json_item(column(*figures, sizing_mode="stretch_width", spacing=2), ID(target)),
        tuple((n, words.get(n, said), color) for n, said, color in SWITCHES if n in names),
        tall,
    )


def _span(t: Array) -> tuple[float, float]:
    """The ends of a time axis (N,), s, that are not the same."""
    low, high = (float(t[0]), float(t[-1])) if t.size else (0.0, 1.0)
    return (low, high) if high > low else (low - 0.5, low + 0.5)


def _same(trace: Trace, sensor: str) -> bool:
    return bool(np.array_equal(trace.before[sensor], trace.after[sensor], equal_nan=True))


def _of_signal(trace: Trace, signal: Signal, bins: int, across: Any) -> list[Any]:
    """A signal above its residual, which lies within the darker band if it is noise, within the
    lighter one if the numbers of the correction are off by what they may be."""
    from bokeh.models import ColumnDataSource

    name, factor = signal.sensor, signal.unit.factor
    measured = np.asarray(trace.measured[name], dtype=float) / factor
    scale, label = shown_unit(spread([measured]), signal.unit.text)
    runs = {"after": within_reach(trace.after[name] / factor, measured)}
    if not _same(trace, name):
        runs = {"before": within_reach(trace.before[name] / factor, measured), **runs}
    left = {word: run - measured for word, run in runs.items()}
    size, small = shown_unit(spread([*left.values()]), signal.unit.text)
    kept = extremes([measured, *runs.values(), *left.values()], bins)
    data = {"t": trace.t[kept], "measured": packed(measured, kept, scale)}
    data |= {word: packed(run, kept, scale) for word, run in runs.items()}
    data |= {f"{word} less": packed(rest, kept, size) for word, rest in left.items()}
    band = trace.band.get(name)
    if signal.noise is not None or band is not None:
        known = np.zeros(len(trace.t)) if band is None else band / factor
        wide = SIGMAS * np.hypot(known, signal.noise or 0.0)
        data["high"], data["low"] = packed(wide, kept, size), packed(-wide, kept, size)
    source = ColumnDataSource(data)
    upper = panel_of(f"{shortened(name, 40)}{bracketed(label)}", 210, across)
    lower = panel_of(f"residual{bracketed(small)}", 140, across)
    if "high" in data:
        lower.varea("t", "low", "high", source=source, fill_color=BAND, level="underlay")
    if signal.noise is not None:
        _band(lower, SIGMAS * signal.noise / size)
    pale = {"line_width": 4.0, "line_alpha": 0.45}
    upper.line("t", "measured", source=source, name="measured", color=MEASURED, **pale)
    for word in runs:
        color = {"before": BEFORE, "after": AFTER}[word]
        _line(upper, source, word, word, color, 1.5)
        name = "left" if word == "before" else word
        _line(lower, source, f"{word} less", name, color, 1.2)
    zero_line(lower)
    return [upper, lower]


def _of_cloud(cloud: Cloud, unit: Unit, words: str, bins: int, across: Any) -> Any:
    from bokeh.models import ColumnDataSource

    force, law, band = (v / unit.factor for v in (cloud.force, cloud.law, cloud.band))
    scale, label = shown_unit(spread([force, law]), unit.text)
    kept = extremes([force, law], bins)
    data = {"t": cloud.t[kept], "force": packed(force, kept, scale)}
    acts = bool(np.any(law))
    if acts:
        data["law"] = packed(law, kept, scale)
    wide = SIGMAS * band
    data |= {"high": packed(force + wide, kept, scale), "low": packed(force - wide, kept, scale)}
    source = ColumnDataSource(data)
    panel = panel_of(f"ΔF {shortened(words, 40)}{bracketed(label)}", 190, across)
    known = force[np.isfinite(force)]
    low, high = np.percentile(known, (0.2, 99.8)) if known.size else (-1.0, 1.0)
    room = 0.1 * (high - low) or 1.0
    panel.y_range.start, panel.y_range.end = (low - room) / scale, (high + room) / scale
    panel.varea("t", "low", "high", source=source, fill_color=SHADE, level="underlay", name="force")
    _line(panel, source, "force", "force", QUIET, 1.2)
    if acts:
        _line(panel, source, "law", "law", LAW, 1.6)
    return panel


def within_reach(run: Array, measured: Array) -> Array:
    """A run (N,), in any unit, NaN from where it leaves the measurement by more than its range."""
    known = measured[np.isfinite(measured)]
    if not known.size:
        return np.asarray(run, dtype=float)
    reach = _FAR * float(np.ptp(known)) or 1.0
    inside = (run >= known.min() - reach) & (run <= known.max() + reach)
    return np.where(inside, run, np.nan)


def packed(values: Array, kept: Any, scale: float) -> Any:
    """The kept samples of ``values`` (N,) in the unit that is shown, in four bytes each."""
    with np.errstate(over="ignore", invalid="ignore"):
        shown = (np.asarray(values, dtype=float)[kept] / scale).astype(np.float32)
    return np.where(np.isfinite(shown), shown, np.float32(np.nan))


def panel_of(title: str, height: int, across: Any, **more: Any) -> Any:
    """An empty figure in the style of the page, ``height`` in pixels, over a range ``across``;
    ``more`` are further properties of it."""
    from bokeh.models import BoxZoomTool, DataRange1d, PlainText, WheelZoomTool
    from bokeh.models.annotations import Title
    from bokeh.plotting import figure

    panel = figure(
        height=height,
        sizing_mode="stretch_width",
        x_range=across,
        y_range=DataRange1d(only_visible=True, range_padding=0.08),
        window_axis="x",
        toolbar_location=None,
        title=Title(
            text=PlainText(text=title), text_font_style="normal", text_font_size="13px"
        ),  # plain: a name between dollars is no formula
        output_backend="canvas",
        min_border_left=64,
        min_border_right=12,
        min_border_top=2,
        min_border_bottom=4,
        outline_line_color=None,
        background_fill_color=None,
        border_fill_color=None,
        lod_threshold=None,
        **{"tools": [], **more},  # which the types of Bokeh do not know
    )
    drag = BoxZoomTool(dimensions="width")
    panel.add_tools(drag, WheelZoomTool(dimensions="width", modifiers={"ctrl": True}))
    panel.toolbar.active_drag = drag
    return panel


def _line(panel: Any, source: Any, column: str, name: str, color: str, width: float) -> None:
    dash = [7, 3] if color == BEFORE else []
    panel.line("t", column, source=source, name=name, color=color, line_width=width, line_dash=dash)


def _band(panel: Any, wide: float) -> None:
    from bokeh.models.annotations import BoxAnnotation

    panel.add_layout(
        BoxAnnotation(
            bottom=-wide,
            top=wide,
            fill_color=QUIET,
            fill_alpha=0.35,
            line_color=None,
            level="underlay",
        )
    )


def zero_line(panel: Any) -> None:
    """A line at zero."""
    from bokeh.models.annotations import Span

    panel.add_layout(Span(location=0.0, dimension="width", line_color=QUIET, line_width=1))


def _link(figures: Sequence[Any]) -> None:
    """One line at the time of the pointer, through all figures."""
    from bokeh.models import CrosshairTool
    from bokeh.models.annotations import Span

    at = Span(dimension="height", line_color=QUIET, line_width=1, line_dash=[2, 2])
    for panel in figures:
        panel.add_tools(CrosshairTool(overlay=at, dimensions="height"))
