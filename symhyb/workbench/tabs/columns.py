"""The tab that says which column is which channel, by selecting."""

from collections.abc import Callable
from typing import Any

from symhyb.workbench.bench import Bench
from symhyb.workbench.mapping import channel_names, choices, map_lines
from symhyb.workbench.widgets import copied, heading, paragraph, put, styled, text

ABOUT = (
    "A channel is found by its name. Where the file calls it otherwise, select its column; a unit"
    " in the header of a column counts, else that of the model."
)
SAME = "Every channel is found by its name: no map is needed."
COPY = "For the command line and for a study file"


class ColumnsTab:
    """A select for every channel of the model; ``chosen`` gets a channel and its column."""

    title = "Columns"

    def __init__(self, chosen: Callable[[str, str], None]) -> None:
        from bokeh.layouts import column

        self._chosen = chosen
        self._selects = column(sizing_mode="stretch_width", spacing=8)
        self._lines = text()
        self.layout = column(
            text(paragraph(ABOUT, "soft")), self._selects, self._lines, sizing_mode="stretch_width"
        )

    def show(self, bench: Bench) -> None:
        """Show the map of a bench."""
        from bokeh.models.widgets import Select

        made = []
        for name, choice in zip(channel_names(bench), choices(bench), strict=True):
            options: list[Any] = list(choice.offered)
            select = Select(title=choice.title, options=options, value=choice.chosen, max_width=520)
            select.sizing_mode = "stretch_width"
            select.on_change("value", self._listener(name))
            made.append(styled(select))
        self._selects.children = made
        self.show_lines(bench)

    def show_lines(self, bench: Bench) -> None:
        """Show the lines that say the map elsewhere."""
        lines = map_lines(bench)
        said = heading(COPY) + copied(lines) if lines else paragraph(SAME, "soft")
        put(self._lines, said)

    def _listener(self, name: str) -> Callable[[str, Any, Any], None]:
        def changed(attribute: str, old: Any, new: Any) -> None:
            self._chosen(name, str(new))

        return changed

    def root(self) -> Any:
        """The part of the page."""
        return self.layout
