"""The tab of the recording itself: its channels, rates, gaps and spectra."""

from typing import Any

from markupsafe import Markup

from symhyb.console.look import gap_sentences, time_sentence
from symhyb.data.look import Look, Signal, look_at
from symhyb.data.whole_file import whole_file
from symhyb.discrepancy.words.amounts import number_text, quantity_text, unit_text
from symhyb.report.tables import Table
from symhyb.workbench.bench import Bench
from symhyb.workbench.figures import CHANNELS, recording_figures
from symhyb.workbench.widgets import listed, paragraph, put, tables_of, text

ROWS = 200  # of the table of channels


def look_of(bench: Bench) -> tuple[Look, tuple[str, ...]]:
    """What is in the recording, every column in its own unit, and what is no signal.

    Raises:
        InputError: it has no time, or no column of numbers.
    """
    time = {channel: column for channel, column in bench.columns if channel == "t"}
    whole = whole_file(bench.table, time)
    return look_at(whole.recording, whole.units), whole.left


def look_table(look: Look) -> Table:
    """The channels of a recording as a table."""
    rows = tuple(_row(one) for one in look.signals[:ROWS])
    heading = ("column", "smallest", "largest", "noise at most", "missing", "rate", "stands out at")
    return Table("Columns", heading, rows, (1, 2, 3, 4, 5))


def _row(one: Signal) -> tuple[str, ...]:
    name = f"{one.name} [{unit_text(one.unit) or '1'}]" if one.unit else one.name
    peaks = ", ".join(quantity_text(peak.frequency, "Hz", digits=3) for peak in one.peaks)
    return (
        name,
        number_text(one.low),
        number_text(one.high),
        number_text(one.noise, digits=2) if one.noise else "",
        str(one.missing or ""),
        quantity_text(one.rate, "Hz"),
        peaks,
    )


class RecordingTab:
    """What is in a recording."""

    title = "Recording"

    def __init__(self) -> None:
        from bokeh.layouts import column

        self._said = text()
        self._look: Look | None = None
        self._seen = False
        self._figures = column(sizing_mode="stretch_width")
        self.layout = column(self._said, self._figures, sizing_mode="stretch_width")

    def show(self, look: Look, left: tuple[str, ...]) -> None:
        """Show a recording."""
        more = len(look.signals) - CHANNELS
        rest = f"Not drawn: {more} more columns." if more > 0 else ""
        sentences = (*gap_sentences(look), *look.notes, *left)
        put(
            self._said,
            paragraph(f"{look.name}: {time_sentence(look)}.", "lead"),
            listed(sentences),
            tables_of([look_table(look)]),
            paragraph(rest, "soft"),
        )
        self._look = look
        self.draw(self._seen)

    def draw(self, seen: bool) -> None:
        """Draw the channels, once they are looked at."""
        self._seen = seen
        if seen and self._look is not None and not self._figures.children:
            self._figures.children = [recording_figures(self._look)]

    def clear(self) -> None:
        """Show nothing."""
        self._look = None
        put(self._said, Markup(""))
        self._figures.children = []

    def root(self) -> Any:
        """The part of the page."""
        return self.layout
