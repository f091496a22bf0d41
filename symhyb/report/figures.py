"""Pictures of motion and force as self-contained SVG: free runs, and ΔF over motion and over time.

Every function takes SI arrays with time on axis 0 and the units to show them in, and returns the
bytes of an SVG. Labels stand above what they name, so that a long name costs height, not width.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.results import Cloud, Trace
from symhyb.discrepancy.words.wording import number_text
from symhyb.report.canvas import (
    AFTER,
    BAND,
    BEFORE,
    DASHED,
    LAW,
    MEASURED,
    PAPER,
    QUIET,
    SHADE,
    bracketed,
    drawing,
    legend,
    svg,
)
from symhyb.report.series import (
    BINS,
    Array,
    binned,
    envelope,
    extremes,
    follows,
    halves,
    passages,
    shortened,
    shown_unit,
    spread,
    zoom_window,
)
from symhyb.units import Unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TAILS = 0.2  # percent of ΔF that a noisy peak may push out of the picture
_NEAR, _FAR = 0.4, 50.0  # ranges of the measurement: that a picture shows, that are drawn at all
_POINTS = 3000  # of a drawn cloud
_FAR_BETTER = 5.0  # of RMS residuals: the larger would hide the smaller
# of viridis, which also colour-blind readers and grey prints order; without the ends that vanish on
# black and on white paper
_SHADES = (0.25, 0.92)
_BESIDE = (1.0, 0.03)  # widths of a cloud and of the bar of its colours
_BARS: dict[str, Any] = {
    "fmt": "o",
    "ms": 3.2,
    "mfc": PAPER,
    "mec": MEASURED,
    "mew": 0.9,
    "ecolor": MEASURED,
    "elinewidth": 1.1,
    "capsize": 2.0,
}


@dataclass(frozen=True, slots=True)
class PlaceUnits:
    """The units in which a place's stretch, rate and force are shown."""

    stretch: Unit
    rate: Unit
    force: Unit


@dataclass(frozen=True, slots=True)
class Marks:
    """The points of a found curve over stretch or rate (``over``): where they are ``x`` (P,), and
    what acts there, ``force`` (P,) with one standard deviation ``sd`` (P,), SI."""

    over: str
    x: Array
    force: Array
    sd: Array


def trace_figure(trace: Trace, sensor: str, unit: Unit, noise: float | None = None) -> bytes:
    """Draw a free run: measured and simulated, the residual below, a zoom if the run is long.

    ``noise`` is one standard deviation of the sensor's noise in ``unit``; the residual is drawn
    over a band of two, widened by what the numbers of the correction are uncertain by.
    """
    measured, before, after = (
        np.asarray(signals[sensor], dtype=float) / unit.factor
        for signals in (trace.measured, trace.before, trace.after)
    )
    runs = [(before, BEFORE, "before"), (after, AFTER, "after")]
    if np.array_equal(before, after, equal_nan=True):
        runs = [(after, AFTER, "simulated")]
    wide = np.hypot(trace.band.get(sensor, 0.0) / unit.factor, noise or 0.0)
    zoom = zoom_window(trace.t, measured)
    heights = [2.0, 1.2] + ([1.7] if zoom else [])
    with drawing(sum(heights) + 0.9) as figure:
        panels = figure.subplots(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
        _signals(panels[0], trace.t, measured, runs, sensor, unit)
        legend(panels[0])
        _residuals(panels[1], trace.t, measured, runs, unit, 2.0 * wide)
        panels[1].sharex(panels[0])
        if zoom:
            inside = (trace.t >= zoom[0]) & (trace.t <= zoom[1])
            cut = [(run[inside], color, word) for run, color, word in runs]
            _signals(panels[2], trace.t[inside], measured[inside], cut, f"zoom: {sensor}", unit)
            panels[0].axvspan(*zoom, color=SHADE, zorder=0)
        panels[-1].set_xlabel("time [s]")
        return svg(figure)


def cloud_figure(
    cloud: Cloud, units: PlaceUnits, remembers: bool = False, marks: Sequence[Marks] = ()
) -> bytes:
    """Draw ΔF against rate, coloured by stretch, and against stretch, coloured by rate.

    Bars are means over the passages of narrow bins, with two of their standard deviations. The
    found law goes through the cloud as its median over narrow bins, once for either sign of the
    colouring quantity, with a band of two standard deviations of its own numbers. A law that
    ``remembers`` has no such line: it is drawn as the loops of a few cycles. The points of
    curves are ``marks``, each with its band.
    """
    cycles = zoom_window(cloud.t, cloud.stretch) if remembers else None
    low, high = cycles or (-np.inf, np.inf)
    looped = (cloud.t >= low) & (cloud.t <= high) if remembers else None
    rate = (cloud.rate / units.rate.factor, "rate", units.rate.text)
    stretch = (cloud.stretch / units.stretch.factor, "stretch", units.stretch.text)
    with drawing(5.6) as figure:
        rows = figure.subplots(2, 2, width_ratios=_BESIDE)
        panels = rows[:, 0]
        for row, across, colored in ((rows[0], rate, stretch), (rows[1], stretch, rate)):
            along = units.rate if across is rate else units.stretch
            mine = [replace(one, x=one.x / along.factor) for one in marks if one.over == across[1]]
            _cloud(row, cloud, across, colored, units.force, looped, mine)
        if marks:
            panels[0].errorbar([], [], [], fmt="s", color=LAW, ms=4, label="points, ± one sd")
        panels[0].plot([], [], "o", color=QUIET, ms=4, label="ΔF")
        if not remembers:
            panels[0].errorbar([], [], [], **_BARS, label="mean")
        law = "found law" + (", a few cycles" if cycles else "")
        panels[0].plot([], [], color=LAW, label=law if np.any(cloud.law) else "no law: 0")
        legend(panels[0])
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
            panel.set_title(f"ΔF{bracketed(label)}" + (", zoomed" if window else ""))
            _limit(panel, [force[inside] / scale, law[inside] / scale], 0.1, _TAILS)
        legend(panels[0])
        panels[-1].set_xlabel("time [s]")
        return svg(figure)


def _signals(
    panel: "Axes",
    t: Array,
    measured: Array,
    runs: Sequence[tuple[Array, str, str]],
    name: str,
    unit: Unit,
) -> None:
    scale, label = shown_unit(spread([measured]), unit.text)
    wide: dict[str, Any] = {"color": MEASURED, "lw": 3.2, "alpha": 0.45, "solid_capstyle": "butt"}
    panel.plot(*envelope(t, measured / scale), **wide, label="measured")
    for run, color, word in runs:
        drawn = _near(run, measured, _FAR)
        panel.plot(*envelope(t, drawn / scale), color=color, ls=_style(color), label=word)
    panel.set_title(f"{shortened(name, 28)}{bracketed(label)}")
    _limit(panel, [measured / scale, *(_near(run, measured) / scale for run, _, _ in runs)], 0.06)


def _near(run: Array, measured: Array, reach: float = _NEAR) -> Array:
    """Hold a run within ``reach`` ranges of the measurement: one that diverges leaves the picture,
    and numbers beyond any picture never reach the drawing."""
    known = measured[np.isfinite(measured)]
    if not known.size:
        return run
    low, high = known.min(), known.max()
    return np.clip(run, low - reach * (high - low), high + reach * (high - low))


def _style(color: str) -> Any:
    return DASHED if color == BEFORE else "-"


def _residuals(
    panel: "Axes",
    t: Array,
    measured: Array,
    runs: Sequence[tuple[Array, str, str]],
    unit: Unit,
    wide: Array,
) -> None:
    """Residuals over the band ``wide`` (N,) in ``unit`` in which noise lies. Where the last run is
    far better than the first, it alone sets the scale."""
    near = [_near(run, measured) - measured for run, _, _ in runs]
    sizes = [_rms(run - measured) for run, _, _ in runs]
    far = len(runs) > 1 and sizes[0] is not None and sizes[1] is not None
    hidden = far and sizes[0] > _FAR_BETTER * sizes[1]  # type: ignore[operator]
    scale, label = shown_unit(spread(near[1:] if hidden else near), unit.text)
    if np.any(wide):
        band = np.broadcast_to(wide, t.shape) / scale
        panel.fill_between(*_thin(t, band), color=BAND, lw=0.0)
    for i, (run, color, word) in enumerate(runs):
        out = hidden and not i
        drawn = (_near(run, measured, _FAR) - measured) / scale
        said = f"{word}: RMS {number_text(_scaled(sizes[i], scale), digits=3)}"
        said += " (beyond)" if out else ""
        line: tuple[Any, Any] = ([], []) if out else envelope(t, drawn)
        panel.plot(*line, color=color, ls=_style(color), label=said)
    panel.axhline(0.0, color=QUIET, lw=0.6)
    panel.set_title(f"residual{bracketed(label)}")
    shown = near[1:] if hidden else near
    _limit(panel, [*(values / scale for values in shown), *_sides(wide / scale)], 0.1)
    legend(panel)


def _sides(wide: Array) -> tuple[Array, Array]:
    flat = np.atleast_1d(wide)
    return flat, -flat


def _thin(t: Array, band: Array) -> tuple[Array, Array, Array]:
    """The times and both sides of a band that is symmetric about 0, thinned."""
    kept = extremes([band])
    return t[kept], -band[kept], band[kept]


def _rms(residual: Array) -> float | None:
    """The root mean square of what is known (N,); None of nothing, infinite of a run that left."""
    known = residual[np.isfinite(residual)]
    with np.errstate(over="ignore"):
        return float(np.sqrt(np.mean(known**2))) if known.size else None


def _scaled(size: float | None, scale: float) -> float | None:
    return None if size is None else size / scale


def _cloud(
    row: Sequence["Axes"],
    cloud: Cloud,
    across: tuple[Array, str, str],
    colored: tuple[Array, str, str],
    unit: Unit,
    looped: NDArray[np.bool_] | None,
    marks: Sequence[Marks] = (),
) -> None:
    from matplotlib.cm import ScalarMappable

    panel, beside = row
    scale_x, label_x = shown_unit(spread([across[0]]), across[2])
    scale_c, label_c = shown_unit(spread([colored[0]]), colored[2])
    scale_y, label_y = shown_unit(spread([cloud.force / unit.factor]), unit.text)
    spreads = np.zeros(len(cloud.law)) if cloud.law_sd is None else cloud.law_sd
    x, force, law, band = (
        across[0] / scale_x,
        *(v / unit.factor / scale_y for v in (cloud.force, cloud.law, 2.0 * spreads)),
    )
    chosen = np.flatnonzero(np.isfinite(x) & np.isfinite(force))
    if len(chosen) > _POINTS:  # at random: every k-th would beat against a periodic signal
        chosen = np.random.default_rng(0).choice(chosen, _POINTS, replace=False)
    points = panel.scatter(
        x[chosen],
        force[chosen],
        c=colored[0][chosen] / scale_c,
        s=5.0,
        lw=0.0,
        alpha=0.55,
        cmap=_colours(),
        rasterized=True,
    )
    opaque = ScalarMappable(points.norm, points.cmap)
    bar = panel.figure.colorbar(opaque, cax=beside)
    bar.outline.set_visible(False)
    bar.set_label(f"{colored[1]}{bracketed(label_c)}")
    if looped is None:
        spans = _branches(panel, x, law, band, halves(colored[0]))
        for part in halves(colored[0]):
            centre, mean, sd = passages(np.where(part, x, np.nan), force)
            panel.errorbar(centre, mean, 2.0 * sd, **_BARS, zorder=3)
    else:
        spans = [law[looped]]
        panel.plot(x[looped], law[looped], color=LAW, lw=1.1)
    for one in marks:
        force, sd = one.force / unit.factor / scale_y, one.sd / unit.factor / scale_y
        panel.errorbar(one.x / scale_x, force, sd, fmt="s", color=LAW, ms=4, mec="white", capsize=2)
        spans += [force - sd, force + sd]
    strange = "" if spans else " (of which the found law is no function)"
    panel.set_xlabel(f"{across[1]}{bracketed(label_x)}{strange}")
    panel.set_title(f"ΔF{bracketed(label_y)}")
    _limit(panel, [force, *spans], 0.1, _TAILS)


def _colours() -> Any:
    import matplotlib as mpl
    from matplotlib.colors import ListedColormap

    return ListedColormap(mpl.colormaps["viridis"](np.linspace(*_SHADES, 128)))


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
        panel.fill_between(centre, lower, upper, color=LAW, alpha=0.35, lw=0.0)
        panel.plot(centre, middle, color=PAPER, lw=3.4)
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
    panel.fill_between(t[:whole:size], low, high, color=BAND, lw=0.0, label="± one sd")


def _limit(panel: "Axes", series: Sequence[Array], margin: float, tails: float = 0.0) -> None:
    """Show what the series span, but for the percentage ``tails`` of values at either end."""
    known = np.concatenate([values[np.isfinite(values)] for values in series])
    if known.size:
        low, high = np.percentile(known, (tails, 100.0 - tails))
        room = margin * (high - low) or 1.0
        panel.set_ylim(low - room, high + room)
