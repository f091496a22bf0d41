"""The tab of the force that is missing: over time, over place and over rate, within a range."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from symhyb.discrepancy.words.amounts import number_text, percent_text, quantity_text, unit_text
from symhyb.report.tables import Table
from symhyb.workbench.figures import Drawn, brushed, force_data, force_figures
from symhyb.workbench.lacking import Lacking, Span, Within, within
from symhyb.workbench.widgets import Picker, paragraph, put, styled, tables_of, text

ABOUT = (
    "ΔF = M q'' + k_c − k_e along the recorded motion: the force that acts beyond the model's own,"
    " with two standard deviations to either side. Drag over a range of time to see it alone."
)
HEADING = (
    "coordinate",
    "RMS of ΔF",
    "of its noise",
    "mean of ΔF",
    "of what is applied",
    "place",
    "rate",
)


def range_table(found: Sequence[Lacking], span: Span | None) -> Table:
    """What ΔF is within a range of time, s, on every coordinate."""
    rows = []
    for one in found:
        part = within(one, span)
        if part is not None:
            rows.append(_row(one, part))
    where = "the whole recording" if span is None else f"{span[0]:.4g} … {span[1]:.4g} s"
    return Table(f"ΔF within {where}", HEADING, tuple(rows), (1, 2, 3, 4))


def _row(one: Lacking, part: Within) -> tuple[str, ...]:
    unit = one.force_unit.text

    def extent(span: Span, text: str) -> str:
        low, high = (number_text(end, digits=3) for end in span)
        return f"{low} … {high} {unit_text(text)}".rstrip()

    return (
        one.coordinate,
        quantity_text(part.rms, unit, digits=3),
        quantity_text(part.band, unit, digits=2),
        quantity_text(part.mean, unit, digits=3),
        percent_text(part.rms / part.applied) if part.applied > 0 else "",
        extent(part.place, one.place_unit.text),
        extent(part.rate, one.rate_unit.text),
    )


class ForceTab:
    """ΔF along a recording."""

    title = "Missing force"

    def __init__(self) -> None:
        from bokeh.layouts import column
        from bokeh.models.widgets import Button

        self._said = text()
        self._all = styled(Button(label="Whole recording", width=150))
        self._all.on_click(lambda: self._select(None))
        self._figures = column(sizing_mode="stretch_width")
        self._drawn: Drawn | None = None
        self._picker = Picker(self._redraw)
        self._found: tuple[Lacking, ...] = ()
        self._span: Span | None = None
        self.layout = column(
            text(paragraph(ABOUT, "soft")),
            self._said,
            self._all,
            self._picker.layout,
            self._figures,
            sizing_mode="stretch_width",
        )

    def show(self, found: tuple[Lacking, ...]) -> None:
        """Show ΔF; the range that is brushed stays."""
        self._found = found
        self._draw()
        self._select(self._span)

    def _picked(self) -> tuple[Lacking, ...]:
        picks = self._picker.picked([one.coordinate for one in self._found])
        return tuple(self._found[i] for i in picks)

    def _draw(self) -> None:
        """Draw the coordinates that are picked."""
        picked = self._picked()
        drawn = self._drawn or force_figures(picked, self._found[0].t)
        for one, source, scale in zip(picked, drawn.sources, drawn.scales, strict=True):
            source.data = force_data(one, scale)
        if self._drawn is None:
            self._drawn = drawn
            for figure in drawn.figures:
                figure.on_event("selectiongeometry", self._brush)
            self._figures.children = [drawn.layout]

    def _redraw(self) -> None:
        self._drawn = None
        if self._found:
            self._draw()
            self._select(self._span)

    def clear(self) -> None:
        """Show nothing."""
        self._drawn, self._found, self._span = None, (), None
        self._figures.children = []
        put(self._said, Markup(""))

    def _brush(self, event: Any) -> None:
        if event.final:
            ends = sorted((float(event.geometry["x0"]), float(event.geometry["x1"])))
            self._select((ends[0], ends[1]))

    def _select(self, span: Span | None) -> None:
        if not self._found or self._drawn is None:
            return
        t = self._found[0].t
        if span is not None and not np.any((t >= span[0]) & (t <= span[1])):
            span = None
        self._span = span
        for one, source in zip(self._picked(), self._drawn.sources, strict=True):
            source.selected.indices = brushed(one, span)
        put(self._said, tables_of([range_table(self._found, span)]), self._judged(span))

    def _judged(self, span: Span | None) -> Markup:
        """Which of it is no larger than its noise."""
        parts = [(one, within(one, span)) for one in self._found]
        calm = [one.coordinate for one, part in parts if part and part.rms <= 2 * part.band]
        if not calm:
            return Markup("")
        return paragraph(f"No larger than its noise here: ΔF on {', '.join(calm)}.", "soft")

    def root(self) -> Any:
        """The part of the page."""
        return self.layout
