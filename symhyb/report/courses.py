"""The picture of a number that changes with time, or with a channel."""

import numpy as np

from symhyb.discrepancy.results import CourseFound
from symhyb.numeric.kernels.buffers import Array
from symhyb.report.canvas import BEFORE, DASHED, LAW, SHADE, bracketed, drawing, legend, svg

_TIMES = 600  # of a line
_BAND = 2.0  # standard deviations


def course_figure(one: CourseFound) -> bytes:
    """Draw a number over the time, or over a channel, with a band of two standard deviations, and
    what the model said."""
    t = np.unique(np.concatenate([np.linspace(*one.span, _TIMES), [p[0] for p in one.points]]))
    t = t[(t >= one.span[0]) & (t <= one.span[1])]
    values = values_at(one, t)
    low, high = band_at(one, t)
    with drawing(2.3) as figure:
        panel = figure.subplots()
        panel.fill_between(t, low, high, color=SHADE, lw=0.0)
        panel.plot(t, values, color=LAW, label=f"with {one.over or 'time'}")
        panel.axhline(one.was, color=BEFORE, ls=DASHED, label="the model as it is")
        if one.shape == "free":
            panel.plot(*np.array(one.points)[:, :2].T, "o", color=LAW, ms=3)
        panel.set_title(f"{one.path} {bracketed(one.unit)}")
        panel.set_xlabel(f"{one.over or 't'} {bracketed(one.over_unit)}")
        legend(panel)
        return svg(figure)


def values_at(one: CourseFound, t: Array) -> Array:
    """The number (N,), in its unit, at the times t (N,), s, or values of the channel."""
    if one.shape == "period":
        level, amplitude, frequency, phase = (item.value for item in one.numbers)
        return np.asarray(level + amplitude * np.sin(2 * np.pi * frequency * t + phase))
    x, y, _ = np.array(one.points).T
    return np.asarray(np.interp(t, x, y))


def band_at(one: CourseFound, t: Array) -> tuple[Array, Array]:
    """The bounds (N,), in its unit, of two standard deviations of its values, and of the time of a
    step."""
    if one.shape == "period":
        sd = _BAND * float(np.hypot(one.numbers[0].sd, one.numbers[1].sd))
        values = values_at(one, t)
        return values - sd, values + sd
    x, y, spread = np.array(one.points).T
    late = _BAND * one.number("time").sd if one.shape == "step" else 0.0
    moved = [t - late, t, t + late]
    low = [np.interp(at, x, y - _BAND * spread) for at in moved]
    high = [np.interp(at, x, y + _BAND * spread) for at in moved]
    return np.min(low, axis=0), np.max(high, axis=0)
