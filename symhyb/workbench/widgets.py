"""The parts of the page by Bokeh: text, tables, sliders, in the style of the report.

What a person gave is text: it is escaped on its way into HTML.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib import resources
from typing import Any

from markupsafe import Markup

from symhyb.model.types import Parameter
from symhyb.report.page import template
from symhyb.report.sentences import typeset
from symhyb.report.tables import Table

DEVIATIONS = 5.0  # of a parameter, to either side, that its slider reaches
STEPS = 200  # of a slider
PICKED = 3  # things that are drawn unless a person picks others


@cache
def styles() -> str:
    """The style of text and tables: that of the report."""
    return template("style.css.j2").render()


@cache
def widget_styles() -> str:
    """The style of what can be clicked and typed into."""
    return resources.files("symhyb.workbench").joinpath("widgets.css").read_text("utf-8")


def styled(widget: Any) -> Any:
    """A widget in the style of the page."""
    from bokeh.models import InlineStyleSheet

    widget.stylesheets = [*widget.stylesheets, InlineStyleSheet(css=widget_styles())]
    return widget


def text(content: str | Markup = "", **more: Any) -> Any:
    """A part of the page that holds HTML made by `paragraph`, `tables_of` and their like, or plain
    text."""
    from bokeh.models import InlineStyleSheet
    from bokeh.models.widgets import Div

    inner = content if isinstance(content, Markup) else paragraph(content)
    sheets: list[Any] = [InlineStyleSheet(css=styles() + widget_styles())]
    return Div(text=str(inner), sizing_mode="stretch_width", stylesheets=sheets, **more)


def put(part: Any, *content: Markup) -> None:
    """Put other HTML into a part of the page."""
    part.text = str(Markup("").join(content))


def paragraph(sentence: str, kind: str = "") -> Markup:
    """A sentence as a paragraph; none of an empty one."""
    if not sentence:
        return Markup("")
    return Markup('<p class="{}">{}</p>').format(kind, typeset(sentence))


def heading(words: str) -> Markup:
    """A heading within a tab."""
    return Markup("<h3>{}</h3>").format(words)


def listed(sentences: Iterable[str], kind: str = "said") -> Markup:
    """Sentences as a list."""
    items = Markup("").join(Markup("<li>{}</li>").format(one) for one in sentences)
    return Markup('<ul class="{}">{}</ul>').format(kind, items) if items else items


def problems_of(sentences: Sequence[str]) -> Markup:
    """What is wrong, all of it."""
    if not sentences:
        return Markup("")
    return Markup('<div class="call wrong">{}</div>').format(listed(sentences))


def copied(lines: str) -> Markup:
    """Lines to be copied."""
    return Markup('<pre class="copied">{}</pre>').format(lines) if lines else Markup("")


def link(address: str, words: str) -> Markup:
    """A link that opens a tab of its own."""
    form = '<p><a href="{}" target="_blank" rel="noopener noreferrer">{}</a></p>'
    return Markup(form).format(address, words)


def tables_of(tables: Iterable[Table]) -> Markup:
    """Tables as the report has them."""
    macros = template("macros.html.j2").module
    return Markup("").join(
        macros.listed(table)  # type: ignore[attr-defined]
        for table in tables
        if table.rows
    )


class Picker:
    """Which of many things are drawn: some at first, for a browser draws slowly what it draws
    often; ``changed`` is called when a person picks others. It is not there for a few."""

    def __init__(self, changed: Callable[[], None]) -> None:
        from bokeh.models.widgets import CheckboxGroup

        self.layout = styled(CheckboxGroup(labels=[], active=[], inline=True, visible=False))
        self.layout.on_change("active", lambda attribute, old, new: changed())

    def picked(self, names: Sequence[str]) -> tuple[int, ...]:
        """Which of these are drawn, by number."""
        if list(self.layout.labels) != list(names):
            first = list(range(min(PICKED, len(names))))
            self.layout.update(labels=list(names), active=first, visible=len(names) > PICKED)
        return tuple(sorted(self.layout.active))


def slider_range(item: Parameter, value: float) -> tuple[float, float, float]:
    """From where to where the slider of a parameter goes, and its step: five deviations to either
    side, else from zero to twice its value; a value that a person typed lies within."""
    if item.sd:
        low, high = item.value - DEVIATIONS * item.sd, item.value + DEVIATIONS * item.sd
    elif item.value:
        low, high = sorted((0.0, 2 * item.value))
    else:
        low, high = -1.0, 1.0
    low, high = min(low, value), max(high, value)
    return low, high, (high - low) / STEPS
