"""Pictures of the report as self-contained SVG: the one file that draws (matplotlib, no pyplot).

Every function takes SI arrays with time on axis 0 and the units to show them in, and returns the
bytes of an SVG. Labels stand above what they name, so that a long name costs height, not width.
"""

import io
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.results import Cloud, Occurrence, Trace
from symhyb.discrepancy.wording import number_text, percent_text
from symhyb.report.contract import finite
from symhyb.report.series import (
    BINS,
    Array,
    binned,
    envelope,
    follows,
    halves,
    shortened,
    shown_unit,
    spread,
    zoom_window,
)
from symhyb.units import Unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 5.4  # inches; with type of 9 pt that reads at 760 px and on a phone
MEASURED, BEFORE, AFTER, LAW = "#1f2933", "#d9812e", "#1f6fb2", "#b3261e"
QUIET = "#8a949e"
_STYLE: dict[Any, Any] = {  # matplotlib's own type lists every key it knows
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "text.parse_math": False,  # a name may hold a dollar sign
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": QUIET,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.xmargin": 0.01,
    "grid.color": "#e6e9ec",
    "grid.linewidth": 0.6,
    "xtick.color": "#4a5560",
    "ytick.color": "#4a5560",
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "svg.fonttype": "path",  # looks the same without any font installed
    "svg.hashsalt": "symhyb",
}
_TAILS = 0.2  # percent of ΔF that a noisy peak may push out of the picture
_NEAR, _FAR = 0.4, 50.0  # ranges of the measurement: that a picture shows, that are drawn at all
_POINTS = 5000  # of a drawn cloud


@dataclass(frozen=True, slots=True)
class PlaceUnits:
    """The units in which a place's stretch, rate and force are shown."""

    stretch: Unit
    rate: Unit
    force: Unit


@dataclass(frozen=True, slots=True)
class Pair:
    """A score before and after the correction, as a share of one (None: not computable)."""

    label: str
    before: float | None
    after: float | None


def trace_figure(trace: Trace, sensor: str, unit: Unit) -> bytes:
    """Draw a free run: measured and simulated, the residual below, a zoom if the run is long."""
    measured, before, after = (
        np.asarray(signals[sensor], dtype=float) / unit.factor
        for signals in (trace.measured, trace.before, trace.after)
    )
    runs = [(before, BEFORE, "before"), (after, AFTER, "after")]
    if np.array_equal(before, after, equal_nan=True):
        runs = [(after, AFTER, "simulated")]
    zoom = zoom_window(trace.t, measured)
    heights = [2.0, 1.2] + ([1.7] if zoom else [])
    with drawing(sum(heights) + 0.9) as figure:
        panels = figure.subplots(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
        _signals(panels[0], trace.t, measured, runs, sensor, unit)
        _legend(panels[0])
        _residuals(panels[1], trace.t, measured, runs, unit)
        panels[1].sharex(panels[0])
        if zoom:
            inside = (trace.t >= zoom[0]) & (trace.t <= zoom[1])
            cut = [(run[inside], color, word) for run, color, word in runs]
            _signals(panels[2], trace.t[inside], measured[inside], cut, f"zoom: {sensor}", unit)
            panels[0].axvspan(*zoom, color="#eef1f4", zorder=0)
        panels[-1].set_xlabel("time [s]")
        return svg(figure)


def cloud_figure(cloud: Cloud, units: PlaceUnits, remembers: bool = False) -> bytes:
    """Draw ΔF against rate, coloured by stretch, and against stretch, coloured by rate.

    The found law goes through the cloud as its median over narrow bins, once for either sign of the
    colouring quantity; the band is what the law spans in a bin, widened by one sd of ΔF. A law that
    ``remembers`` has no such line: it is drawn as the loops of a few cycles.
    """
    cycles = zoom_window(cloud.t, cloud.stretch) if remembers else None
    low, high = cycles or (-np.inf, np.inf)
    looped = (cloud.t >= low) & (cloud.t <= high) if remembers else None
    rate = (cloud.rate / units.rate.factor, "rate", units.rate.text)
    stretch = (cloud.stretch / units.stretch.factor, "stretch", units.stretch.text)
    with drawing(5.6) as figure:
        panels = figure.subplots(2, 1)
        for panel, across, colored in ((panels[0], rate, stretch), (panels[1], stretch, rate)):
            _cloud(panel, cloud, across, colored, units.force, looped)
        panels[0].plot([], [], "o", color=QUIET, ms=4, label="ΔF")
        law = "found law" + (", a few cycles" if cycles else "")
        panels[0].plot([], [], color=LAW, label=law if np.any(cloud.law) else "no law: 0")
        if not remembers:
            panels[0].fill_between([], [], color=LAW, alpha=0.18, label="± one sd of ΔF")
        _legend(panels[0])
        return svg(figure)


def force_figure(cloud: Cloud, unit: Unit) -> bytes:
    """Draw ΔF over time with its band (one standard deviation) and the force of the found law."""
    force, band, law = (values / unit.factor for values in (cloud.force, cloud.band, cloud.law))
    inner = _without_ends(cloud.t)  # where a motion ends, ΔF is not known well
    zoom = zoom_window(cloud.t[inner], (law if np.any(law) else force)[inner])
    with drawing(4.6 if zoom else 2.6) as figure:
        panels = figure.subplots(2 if zoom else 1, 1, squeeze=False)[:, 0]
        for panel, window in zip(panels, (None, zoom), strict=False):
            low, high = window or (-np.inf, np.inf)
            inside = (cloud.t >= low) & (cloud.t <= high)
            t = cloud.t[inside]
            scale, label = shown_unit(spread([force[inside], law[inside]]), unit.text)
            lower, upper = (force - band)[inside] / scale, (force + band)[inside] / scale
            _band(panel, t, lower, upper)
            panel.plot(*envelope(t, force[inside] / scale), color=QUIET, label="ΔF", lw=0.8)
            if np.any(law):
                panel.plot(*envelope(t, law[inside] / scale), color=LAW, label="found law")
            panel.set_title(f"ΔF{_bracketed(label)}" + (", zoomed" if window else ""))
            _limit(panel, [force[inside] / scale, law[inside] / scale], 0.1, _TAILS)
        _legend(panels[0])
        panels[-1].set_xlabel("time [s]")
        return svg(figure)


def score_figure(pairs: Sequence[Pair]) -> bytes:
    """Draw scores before and after as paired bars in percent, logarithmic if they differ much."""
    values = [finite(value) for pair in pairs for value in (pair.before, pair.after)]
    shown = [100.0 * value for value in values if value is not None and value > 0.0]
    logarithmic = bool(shown) and max(shown) > 20.0 * min(shown)
    with drawing(0.52 * len(pairs) + 0.75) as figure:
        panel = figure.subplots()
        if logarithmic:
            panel.set_xscale("log")
            panel.set_xlim(min(shown) / 2.0, max(shown) * 3.0)
        elif shown:
            panel.set_xlim(0.0, max(shown) * 1.18)
        for row, pair in enumerate(pairs):
            _above(panel, float(row), pair.label)
            _bar(panel, row + 0.32, pair.before, BEFORE)
            _bar(panel, row + 0.57, pair.after, AFTER)
        panel.set_ylim(len(pairs) - 0.2, -0.3)
        _percent_axis(panel, logarithmic)
        panel.set_xlabel("error [%]" + (", logarithmic" if logarithmic else ""))
        return svg(figure)


def places_figure(places: Sequence[tuple[str, float | None, bool]]) -> bytes:
    """Draw the share of the mismatch that each place explains; found places stand out.

    ``places`` are (words, explained share or None, whether something was found there).
    """
    with drawing(0.48 * len(places) + 0.8) as figure:
        panel = figure.subplots()
        panel.set_xlim(0.0, 118.0)
        for row, (words, explained, found) in enumerate(places):
            _above(panel, float(row), words)
            _bar(panel, row + 0.4, explained, AFTER if found else "#aab4bd")
        panel.set_ylim(len(places), -0.4)
        _percent_axis(panel, logarithmic=False)
        panel.set_xticks(range(0, 101, 20))
        panel.set_xlabel("explained share of the mismatch [%]")
        return svg(figure)


def occurrence_figure(told: Occurrence) -> bytes:
    """Draw when a place's mismatch acts (what is left of every window, as it is and with the best
    force of the place's own motion) and at which frequencies."""
    with drawing(4.2 if told.lines.size else 2.3) as figure:
        panels = figure.subplots(2 if told.lines.size else 1, 1, squeeze=False)[:, 0]
        for values, color, word in (
            (told.before, BEFORE, "as it is"),
            (told.after, AFTER, "best force here"),
        ):
            shown = np.maximum(values, 1e-3)
            panels[0].step(told.t, shown, where="mid", color=color, label=word)
        panels[0].axhline(1.0, color=QUIET, lw=0.8, ls="--", label="noise")
        panels[0].set_yscale("log")
        panels[0].yaxis.set_major_formatter("{x:g}")
        panels[0].yaxis.set_minor_formatter("")
        panels[0].set_title("left over [χ² per sample]")
        if told.change is not None:
            panels[0].axvline(told.change.time_s, color=LAW)
            at = (told.change.time_s, 0.97)
            panels[0].annotate(
                f"{told.change.kind} ", at, xycoords=panels[0].get_xaxis_transform(), color=LAW,
                ha="right", va="top",
            )  # fmt: skip
        _legend(panels[0])
        panels[0].set_xlabel("time [s]")
        if told.lines.size:
            panels[1].fill_between(told.lines, 0.0, told.power, color=AFTER, lw=0.0)
            if told.band_hz is not None:
                panels[1].axvspan(*told.band_hz, color="#eef1f4", zorder=0)
            panels[1].set_title("power of the missing force, over its largest")
            panels[1].set_xlabel("frequency [Hz]")
            panels[1].set_ylim(0.0, 1.05)
        return svg(figure)


@contextmanager
def drawing(height: float) -> Iterator["Figure"]:
    """Yield a figure in the style of the page, ``height`` in inches."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing", category=UserWarning)
        yield Figure(figsize=(WIDTH, height), dpi=150, layout="constrained", facecolor="white")


def svg(figure: "Figure") -> bytes:
    """Give a figure as the bytes of an SVG that is the same every time."""
    target = io.BytesIO()
    figure.savefig(target, format="svg", metadata={"Date": None, "Creator": "symhyb"})
    return target.getvalue()


def _signals(
    panel: "Axes",
    t: Array,
    measured: Array,
    runs: Sequence[tuple[Array, str, str]],
    name: str,
    unit: Unit,
) -> None:
    scale, label = shown_unit(spread([measured]), unit.text)
    panel.plot(*envelope(t, measured / scale), color=MEASURED, lw=1.6, label="measured")
    for run, color, word in runs:
        drawn = _near(run, measured, _FAR)
        panel.plot(*envelope(t, drawn / scale), color=color, label=word)
    panel.set_title(f"{shortened(name, 28)}{_bracketed(label)}")
    _limit(panel, [measured / scale, *(_near(run, measured) / scale for run, _, _ in runs)], 0.06)


def _near(run: Array, measured: Array, reach: float = _NEAR) -> Array:
    """Hold a run within ``reach`` ranges of the measurement: one that diverges leaves the picture,
    and numbers beyond any picture never reach the drawing."""
    known = measured[np.isfinite(measured)]
    if not known.size:
        return run
    low, high = known.min(), known.max()
    return np.clip(run, low - reach * (high - low), high + reach * (high - low))


def _residuals(
    panel: "Axes",
    t: Array,
    measured: Array,
    runs: Sequence[tuple[Array, str, str]],
    unit: Unit,
) -> None:
    near = [_near(run, measured) - measured for run, _, _ in runs]
    scale, label = shown_unit(spread(near), unit.text)
    for run, color, word in runs:
        residual = (run - measured) / scale
        known = residual[np.isfinite(residual)]
        with np.errstate(over="ignore"):  # a run that diverged has no RMS to speak of
            rms = float(np.sqrt(np.mean(known**2))) if known.size else None
        drawn = (_near(run, measured, _FAR) - measured) / scale
        said = f"{word}: RMS {number_text(rms, digits=3)}"
        panel.plot(*envelope(t, drawn), color=color, label=said)
    panel.axhline(0.0, color=QUIET, lw=0.6)
    panel.set_title(f"residual{_bracketed(label)}")
    _limit(panel, [values / scale for values in near], 0.1)
    _legend(panel)


def _cloud(
    panel: "Axes",
    cloud: Cloud,
    across: tuple[Array, str, str],
    colored: tuple[Array, str, str],
    unit: Unit,
    looped: NDArray[np.bool_] | None,
) -> None:
    from matplotlib.cm import ScalarMappable

    scale_x, label_x = shown_unit(spread([across[0]]), across[2])
    scale_c, label_c = shown_unit(spread([colored[0]]), colored[2])
    scale_y, label_y = shown_unit(spread([cloud.force / unit.factor]), unit.text)
    x, force, law, band = (
        across[0] / scale_x,
        *(values / unit.factor / scale_y for values in (cloud.force, cloud.law, cloud.band)),
    )
    chosen = np.flatnonzero(np.isfinite(x) & np.isfinite(force))
    if len(chosen) > _POINTS:  # at random: every k-th would beat against a periodic signal
        chosen = np.random.default_rng(0).choice(chosen, _POINTS, replace=False)
    points = panel.scatter(
        x[chosen], force[chosen], c=colored[0][chosen] / scale_c,
        s=5.0, lw=0.0, alpha=0.55, cmap="viridis", rasterized=True,
    )  # fmt: skip
    opaque = ScalarMappable(points.norm, points.cmap)
    bar = panel.figure.colorbar(opaque, ax=panel, pad=0.02, aspect=18)
    bar.outline.set_visible(False)
    bar.set_label(f"{colored[1]}{_bracketed(label_c)}")
    if looped is None:
        spans = _branches(panel, x, law, band, halves(colored[0]))
    else:
        spans = [law[looped]]
        panel.plot(x[looped], law[looped], color=LAW, lw=1.1)
    strange = "" if spans else " (of which the found law is no function)"
    panel.set_xlabel(f"{across[1]}{_bracketed(label_x)}{strange}")
    panel.set_title(f"ΔF{_bracketed(label_y)}")
    _limit(panel, [force, *spans], 0.1, _TAILS)


def _branches(
    panel: "Axes", x: Array, law: Array, band: Array, parts: Sequence[NDArray[np.bool_]]
) -> list[Array]:
    """Draw a law over x part by part (a law of the other quantity has two branches here), if it is
    one over x; returns what it spans."""
    spans: list[Array] = []
    if not follows(x, law, parts):
        return spans
    for part in parts:
        centre, middle, lower, upper = binned(x[part], law[part], band[part])
        panel.fill_between(centre, lower, upper, color=LAW, alpha=0.18, lw=0.0)
        panel.plot(centre, middle, color="white", lw=3.2)
        panel.plot(centre, middle, color=LAW, lw=1.7)
        spans += [lower, upper]
    return spans


def _without_ends(t: Array) -> NDArray[np.bool_]:
    """The samples that are not within two percent of either end of a recording (N,)."""
    room = 0.02 * (t[-1] - t[0]) if t.size else 0.0
    return (t >= t[0] + room) & (t <= t[-1] - room) if t.size else np.zeros(0, dtype=bool)


def _band(panel: "Axes", t: Array, lower: Array, upper: Array) -> None:
    """Fill between two series, thinned bin by bin to the smallest lower and largest upper value."""
    size = max(1, len(t) // BINS)
    whole = len(t) // size * size
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a bin of NaN only: a gap
        low = np.nanmin(lower[:whole].reshape(-1, size), axis=1)
        high = np.nanmax(upper[:whole].reshape(-1, size), axis=1)
    panel.fill_between(t[:whole:size], low, high, color="#dfe4e8", lw=0.0, label="± one sd")


def _bar(panel: "Axes", height: float, share: float | None, color: str) -> None:
    known = finite(share)
    left = panel.get_xlim()[0]
    if known is not None:
        panel.barh(height, 100.0 * known - left, left=left, height=0.24, color=color)
    said = "not computable" if known is None else percent_text(known)
    end = left if known is None else max(100.0 * known, left)
    panel.annotate(
        said, (end, height), xytext=(3, 0), textcoords="offset points", va="center", fontsize=8
    )


def _above(panel: "Axes", height: float, text: str) -> None:
    across = panel.get_yaxis_transform()
    panel.annotate(shortened(text), (0.0, height), xycoords=across, va="center")


def _percent_axis(panel: "Axes", logarithmic: bool) -> None:
    panel.set_yticks([])
    panel.spines["left"].set_visible(False)
    panel.grid(visible=True, axis="x", which="major")
    if logarithmic:
        panel.xaxis.set_major_formatter(lambda value, _: number_text(float(value)))
        panel.xaxis.set_minor_formatter(lambda value, _: "")


def _legend(panel: "Axes") -> None:
    panel.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=3, borderaxespad=0.0)


def _bracketed(unit: str) -> str:
    return f" [{unit}]" if unit else " [1]"


def _limit(panel: "Axes", series: Sequence[Array], margin: float, tails: float = 0.0) -> None:
    """Show what the series span, but for the percentage ``tails`` of values at either end."""
    known = np.concatenate([values[np.isfinite(values)] for values in series])
    if known.size:
        low, high = np.percentile(known, (tails, 100.0 - tails))
        room = margin * (high - low) or 1.0
        panel.set_ylim(low - room, high + room)
