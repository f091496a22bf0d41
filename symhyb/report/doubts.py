"""Pictures and sentences for a sceptic: whether what is left is noise, which numbers trade off."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from symhyb.discrepancy.evidence import Correlations, Whiteness
from symhyb.discrepancy.words.wording import joined, number_text
from symhyb.report.canvas import AFTER, BAND, BEFORE, MEASURED, PAPER, QUIET, drawing, svg
from symhyb.report.series import shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SENSORS_SHOWN, _INPUTS_SHOWN = 3, 2
_NUMBERS_SHOWN = 14
_STRONG = 0.9  # correlation, from which two numbers are hardly known apart


def whiteness_figure(found: Sequence[Whiteness]) -> bytes:
    """Draw the correlations of what is left: with itself, and with inputs; 99 % bounds in grey."""
    shown = found[:_SENSORS_SHOWN]
    rows = [(one, name) for one in shown for name in ("", *list(one.cross)[:_INPUTS_SHOWN])]
    with drawing(1.25 * len(rows) + 0.7) as figure:
        panels = figure.subplots(len(rows), 1, squeeze=False)[:, 0]
        for panel, (one, name) in zip(panels, rows, strict=True):
            _correlation(panel, one, name)
        panels[-1].set_xlabel("lag [s]: how much later the residual is")
        return svg(figure)


def _correlation(panel: "Axes", one: Whiteness, name: str) -> None:
    chosen = one.chosen(name)
    lags, values, bound = one.lags[chosen], one.of(name)[chosen], one.bounds[name][chosen]
    panel.fill_between(lags, -bound, bound, color=BAND, lw=0.0)
    outside = np.abs(values) > bound
    panel.vlines(lags, 0.0, values, color=AFTER, lw=1.0)
    for part, color, mark in ((~outside, AFTER, "o"), (outside, BEFORE, "D")):
        panel.plot(lags[part], values[part], mark, color=color, ms=3.0)
    panel.axhline(0.0, color=QUIET, lw=0.6)
    sensor = shortened(one.sensor, 26)
    with_what = "itself, later" if not name else f"input {shortened(name, 20)}"
    panel.set_title(f"residual of {sensor} with {with_what}")
    reach = 1.15 * max(float(np.max(np.abs(values))), float(bound.max()))
    panel.set_ylim(-min(reach, 1.05), min(reach, 1.05))


def whiteness_sentences(found: Sequence[Whiteness]) -> tuple[str, ...]:
    """Say of each sensor whether its residuals are noise, and of which input they depend."""
    return tuple(_said(one) for one in found[:_SENSORS_SHOWN])


def _said(one: Whiteness) -> str:
    said = "are as white as noise"
    if not one.noise():
        said = f"are correlated in time (at most {number_text(one.largest(), digits=2)})"
    tied = [name for name in one.cross if not one.noise(name)]
    free = [name for name in one.cross if name not in tied]
    parts = [f"independent of {joined(free)}"] if free else []
    parts += [
        f"correlated with {name} (at most {number_text(one.largest(name), digits=2)})"
        for name in tied
    ]
    return f"The residuals of {one.sensor} {joined([said, *parts])}."


def correlations_figure(known: Correlations) -> bytes:
    """Draw how the fitted numbers trade off, as a matrix with its values."""
    size = min(len(known.names), _NUMBERS_SHOWN)
    with drawing(0.36 * size + 0.75) as figure:
        panel = figure.subplots()
        for row in range(size):
            label = f"{row + 1}  {shortened(known.names[row], 34)}"
            panel.text(-0.15, row + 0.5, label, ha="right", va="center")
            for column in range(row):
                value = float(known.matrix[row, column])
                _cell(panel, row, column, value)
        panel.set_xlim(-3.4, max(size - 1, 1))
        panel.set_ylim(size, 0)
        panel.set_xticks(np.arange(size - 1) + 0.5, [*map(str, range(1, size))])
        panel.set_yticks([])
        panel.grid(False)
        panel.tick_params(length=0)
        for side in ("left", "bottom"):
            panel.spines[side].set_visible(False)
        return svg(figure)


def _cell(panel: "Axes", row: int, column: int, value: float) -> None:
    from matplotlib.patches import Rectangle

    color = AFTER if value >= 0 else BEFORE
    box = Rectangle((column + 0.03, row + 0.06), 0.94, 0.88, fc=color, ec="none", alpha=abs(value))
    panel.add_patch(box)
    ink = PAPER if abs(value) > 0.6 else MEASURED
    panel.text(column + 0.5, row + 0.5, _signed(value), ha="center", va="center", color=ink)


def correlations_sentence(known: Correlations) -> str:
    """Say which two numbers trade off most."""
    lower = np.tril(known.matrix, -1)
    row, column = np.unravel_index(int(np.argmax(np.abs(lower))), lower.shape)
    value, pair = float(lower[row, column]), (known.names[row], known.names[column])
    strong = ": these recordings hardly determine them apart" if abs(value) > _STRONG else ""
    return f"The most correlated are {joined(pair)}, with {_signed(value)}{strong}."


def _signed(value: float) -> str:
    return f"{value:+.2f}".replace("-", "\N{MINUS SIGN}")
