"""The tab of the simulation beside the recording, with the error of every channel."""

from dataclasses import replace
from typing import Any

from markupsafe import Markup

from symhyb.discrepancy.words.amounts import percent_text, unit_text
from symhyb.report.tables import Table
from symhyb.workbench.figures import Drawn, simulation_data, simulation_figures
from symhyb.workbench.simulated import Shown
from symhyb.workbench.widgets import Picker, paragraph, problems_of, put, tables_of, text

KEYS = Markup(
    '<div class="keys"><span><span class="swatch line-measured"></span>measured</span>'
    '<span><span class="swatch line-before"></span>model of the file</span>'
    '<span><span class="swatch line-after"></span>model as set</span></div>'
)
MEANS = "NRMSE: RMSE over the range of the measurement."
STARTS = {
    False: "Free run from the first state of the smoothed recording.",
    True: "Free run from a fitted start.",
}
ENDED = "The simulation ended early: {reason}."


def error_table(filed: Shown, shown: Shown) -> Table:
    """The errors of all channels, of the model of the file and of the one that is shown."""
    before, after = filed.nrmse(), shown.nrmse()
    rows = tuple(
        (
            f"{one.sensor.name} [{unit_text(one.sensor.unit.text) or '1'}]",
            percent_text(before.get(one.sensor.name)),
            percent_text(after[one.sensor.name]),
        )
        for one in shown.sensors
    )
    return Table("Errors (NRMSE)", ("channel", "model of the file", "model as set"), rows, (1, 2))


class SimulationTab:
    """A simulation beside a recording."""

    title = "Simulation"

    def __init__(self) -> None:
        from bokeh.layouts import column

        self._said = text()
        self._figures = column(sizing_mode="stretch_width")
        self._drawn: Drawn | None = None
        self._picker = Picker(self._redraw)
        self._runs: tuple[Shown, Shown] | None = None
        self.layout = column(
            self._said, self._picker.layout, self._figures, sizing_mode="stretch_width"
        )

    def show(self, filed: Shown, shown: Shown, fitted: bool, seconds: float) -> None:
        """Show a run of the model as it is set beside that of the file."""
        self._runs = filed, shown
        self._draw()
        ended = [ENDED.format(reason=shown.reason)] if shown.reason else []
        put(
            self._said,
            problems_of(ended),
            tables_of([error_table(filed, shown)]),
            paragraph(f"{MEANS} {STARTS[fitted]} Simulated in {seconds:.2f} s.", "soft"),
            KEYS,
        )

    def _draw(self) -> None:
        """Draw the sensors that are picked."""
        if self._runs is None:
            return
        filed, shown = self._runs
        picks = self._picker.picked([one.sensor.name for one in shown.sensors])
        part = replace(shown, sensors=tuple(shown.sensors[i] for i in picks))
        drawn = self._drawn or simulation_figures(part)
        before = {one.sensor.name: one for one in filed.sensors}
        for one, source, scale in zip(part.sensors, drawn.sources, drawn.scales, strict=True):
            other = None if filed is shown else before.get(one.sensor.name)
            source.data = simulation_data(shown.t, one, other, scale)
        if self._drawn is None:
            self._drawn = drawn
            self._figures.children = [drawn.layout]

    def _redraw(self) -> None:
        self._drawn = None
        self._draw()

    def clear(self) -> None:
        """Show nothing: another recording has other sensors."""
        self._drawn, self._runs = None, None
        self._figures.children = []
        put(self._said, Markup(""))

    def root(self) -> Any:
        """The part of the page."""
        return self.layout
