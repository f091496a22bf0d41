"""The tab of results: one as it is, or two side by side."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from symhyb.discrepancy.words.wording import capital
from symhyb.report.sentences import typeset
from symhyb.workbench.beside import compared_tables, result_tables
from symhyb.workbench.figures import NARROW, WRAPPED
from symhyb.workbench.results import Result
from symhyb.workbench.widgets import heading, link, paragraph, put, styled, tables_of, text

NOTHING = "No result yet: a diagnosis leaves one."
ALONE = ""
"""The choice of no second result."""

Link = Callable[[Path], str]
"""The address at which a report is served."""


def result_html(result: Result, address: Link) -> Markup:
    """A result: what it says, what was found, and where its report is."""
    verdict = capital(result.verdict)
    parts = [
        heading(verdict),
        paragraph(result.sentence),
        laws_html(result),
    ]
    if result.record_next:
        parts.append(
            Markup('<div class="call"><p><strong>Record next:</strong> {}</p></div>').format(
                result.record_next
            )
        )
    if result.report is not None:
        parts.append(link(address(result.folder), "Open the report"))
    return Markup("").join(parts)


def laws_html(result: Result) -> Markup:
    """The found laws, each with its formula."""
    form = Markup('<li>{}<div class="law"><code>{}: F = {}</code></div></li>')
    laws = Markup("").join(
        form.format(typeset(one.sentence), one.name, one.law) for one in result.laws
    )
    return Markup('<ul class="said">{}</ul>').format(laws) if laws else laws


class ResultsTab:
    """Results to select from; ``address`` gives where a report is served."""

    title = "Results"

    def __init__(self, address: Link) -> None:
        from bokeh.layouts import column, row
        from bokeh.models.widgets import Select

        self._address = address
        self._results: tuple[Result, ...] = ()
        self._first = styled(Select(title="Result", min_width=NARROW, sizing_mode="stretch_width"))
        self._second = styled(Select(title="Beside", min_width=NARROW, sizing_mode="stretch_width"))
        self._said = text(paragraph(NOTHING, "soft"))
        self._left, self._right = text(min_width=NARROW), text(min_width=NARROW)
        for select in (self._first, self._second):
            select.on_change("value", lambda attribute, old, new: self._fill())
        chosen = row(
            self._first, self._second, sizing_mode="stretch_width", spacing=24, styles=WRAPPED
        )
        sides = row(
            self._left, self._right, sizing_mode="stretch_width", spacing=24, styles=WRAPPED
        )
        self._tables = text()
        self.layout = column(
            chosen, self._said, sides, self._tables, sizing_mode="stretch_width", spacing=6
        )
        self._fill()

    def show(self, results: Sequence[Result], first: str = "") -> None:
        """Offer these results, and show the one that is named ``first``."""
        self._results = tuple(results)
        names = [one.name for one in results]
        self._first.options = names
        self._second.options = [(ALONE, "nothing"), *((name, name) for name in names)]
        self._first.value = first or next(iter(names), "")
        if self._second.value not in names:
            other = names[1] if len(names) == 2 and not first else ALONE
            self._second.value = other
        self._fill()

    def _fill(self) -> None:
        named = {one.name: one for one in self._results}
        first, second = named.get(self._first.value), named.get(self._second.value)
        self._second.visible = len(named) > 1
        self._first.visible = bool(named)
        self._right.visible = second is not None
        self._said.visible = first is None
        if first is None:
            return
        put(self._left, result_html(first, self._address))
        if second is None:
            put(self._right, Markup(""))
            put(self._tables, tables_of(result_tables(first)))
            return
        put(self._right, result_html(second, self._address))
        put(self._tables, tables_of(compared_tables(first, second)))

    def root(self) -> Any:
        """The part of the page."""
        return self.layout
