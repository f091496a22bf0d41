"""The side of the page: recording, elements to switch, parameters to move."""

from collections.abc import Callable, Sequence
from typing import Any

from symhyb.discrepancy.words.amounts import unit_text
from symhyb.model.types import Parameter, place_text
from symhyb.report.canvas import bracketed
from symhyb.workbench.bench import Bench
from symhyb.workbench.widgets import heading, paragraph, put, slider_range, styled, text

Moved = Callable[[str, float], None]


class Side:
    """What changes the bench: ``chosen`` gets the number of a recording, ``switched`` the elements
    that are on, ``moved`` a parameter by path with its value, ``reset`` and ``fit`` are clicked."""

    def __init__(
        self,
        bench: Bench,
        chosen: Callable[[int], None],
        switched: Callable[[Sequence[str]], None],
        moved: Moved,
        reset: Callable[[], None],
        fit: Callable[[], None],
    ) -> None:
        from bokeh.layouts import column, row
        from bokeh.models.widgets import Button, CheckboxGroup, Select

        self._names = bench.model.elements.names()
        labels = [f"{one.name}: {one.kind} {place_text(one.place)}" for one in bench.model.elements]
        self._elements = styled(CheckboxGroup(labels=labels, active=list(range(len(labels)))))
        self._elements.on_change(
            "active", lambda attribute, old, new: switched([self._names[i] for i in new])
        )
        parts: list[Any] = []
        if len(bench.paths) > 1:
            options: list[Any] = [(str(i), path.name) for i, path in enumerate(bench.paths)]
            select = Select(title="Recording", options=options, value="0")
            select.sizing_mode = "stretch_width"
            select.on_change("value", lambda attribute, old, new: chosen(int(new)))
            parts.append(styled(select))
        self._reset = styled(Button(label="As in the file", width=120, disabled=True))
        self._reset.on_click(reset)
        self._fit = styled(Button(label="Fit the start", width=120))
        self._fit.on_click(fit)
        self._busy = text(visible=False)
        parts += [row(self._fit, self._reset, spacing=8), self._busy]
        if labels:
            parts += [text(heading("Elements")), self._elements]
        self._parameters = {
            item.path: ParameterSlider(item, moved) for item in bench.model.all_parameters()
        }
        if self._parameters:
            parts.append(text(heading("Parameters")))
            parts += [one.layout for one in self._parameters.values()]
        self.layout = column(*parts, sizing_mode="stretch_width", spacing=6)

    def show(self, bench: Bench) -> None:
        """Show what a bench has set."""
        self._elements.active = [i for i, name in enumerate(self._names) if name not in bench.off]
        values = dict(bench.values)
        for path, slider in self._parameters.items():
            slider.show(values.get(path))
        self._reset.disabled = not bench.changed

    def busy(self, words: str) -> None:
        """Say what is being computed; nothing when all is done."""
        put(self._busy, paragraph(words, "soft"))
        self._busy.visible = bool(words)


class ParameterSlider:
    """A parameter as a slider with the number beside it; ``moved`` gets its value."""

    def __init__(self, item: Parameter, moved: Moved) -> None:
        from bokeh.layouts import column
        from bokeh.models.widgets import NumericInput, Slider

        self._item, self._moved = item, moved
        low, high, step = slider_range(item, item.value)
        unit = "" if item.unit.text == "1" else bracketed(unit_text(item.unit.text))
        self._slider = styled(
            Slider(start=low, end=high, step=step, value=item.value, show_value=False, title="")
        )
        self._slider.sizing_mode = "stretch_width"
        self._number = styled(
            NumericInput(value=item.value, mode="float", title=f"{item.path}{unit}")
        )
        self._number.sizing_mode = "stretch_width"
        self._slider.on_change("value", lambda attribute, old, new: self._slid(new))
        self._number.on_change("value", lambda attribute, old, new: self._set(new))
        self.layout = column(self._number, self._slider, sizing_mode="stretch_width", spacing=2)
        self._value = item.value

    def show(self, value: float | None) -> None:
        """Show a value, None for that of the file."""
        value = self._item.value if value is None else value
        self._value = value
        low, high, step = slider_range(self._item, value)
        if (self._slider.start, self._slider.end) != (low, high):
            self._slider.update(start=low, end=high, step=step)
        if self._apart(value):
            self._slider.value = value
        self._number.value = value

    def _apart(self, value: float) -> bool:
        """Whether the slider stands elsewhere: within half a step it cannot stand better."""
        return bool(abs(self._slider.value - value) > self._slider.step / 2)

    def _slid(self, value: float) -> None:
        """Take a value of the slider, but not the step next to a number that was typed."""
        if abs(value - self._value) > self._slider.step / 2:
            self._set(value)

    def _set(self, value: float | None) -> None:
        if value is None or float(value) == self._value:
            return
        self._value = float(f"{float(value):.6g}") if value != self._item.value else float(value)
        self._moved(self._item.path, self._value)
