"""The page of one browser tab: what is clicked becomes a new bench, and what follows is shown.

Numerics run in a thread of their own; what they return is shown in the turn of the page. A page
that was closed gets nothing more.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, TypeVar

from markupsafe import Markup

from symhyb.errors import InputError
from symhyb.fault import error_sentences
from symhyb.workbench import bench as benches
from symhyb.workbench.bench import Bench
from symhyb.workbench.lacking import Lacking, lacking
from symhyb.workbench.shared import Shared
from symhyb.workbench.side import Side
from symhyb.workbench.simulated import Begun, Prepared, Shown, begin, fit_start, prepare, shown_run
from symhyb.workbench.tabs.columns import ColumnsTab
from symhyb.workbench.tabs.diagnosis import DiagnosisTab
from symhyb.workbench.tabs.force import ForceTab
from symhyb.workbench.tabs.recording import RecordingTab, look_of
from symhyb.workbench.tabs.results import ResultsTab, result_html
from symhyb.workbench.tabs.simulation import SimulationTab
from symhyb.workbench.widgets import problems_of, put, styled, text

POLL = 400  # ms between two looks at a diagnosis
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, eq=False)
class Ran:
    """A run of the model that is set, beside that of the file, and how long it took in s."""

    begun: Begun
    filed: Shown
    shown: Shown
    seconds: float


class Page:
    """The parts of the page, and the bench that they show."""

    def __init__(self, document: Any, shared: Shared) -> None:
        from bokeh.models import TabPanel, Tabs

        self._document, self._shared = document, shared
        self._open = True
        self._problems: dict[str, list[str]] = {}
        self._said = text(visible=False)
        self._results = ResultsTab(shared.address)
        tabs: list[Any] = [self._results]
        self._bench: Bench | None = shared.bench
        if shared.bench is not None:
            self._recording, self._columns = RecordingTab(), ColumnsTab(self._mapped)
            self._simulation, self._force = SimulationTab(), ForceTab()
            self._diagnosis = DiagnosisTab(self._start, self._stop)
            tabs = [
                self._simulation,
                self._force,
                self._recording,
                self._columns,
                self._diagnosis,
                self._results,
            ]
            self._side = Side(
                shared.bench,
                self._chosen,
                self._switched,
                self._moved,
                self._reset,
                self._fit,
            )
            self._prepared: Prepared | None = None
            self._begun: Begun | None = None
            self._filed: Shown | None = None
            self._collected = ""
        self._tabs = styled(
            Tabs(
                tabs=[TabPanel(child=one.root(), title=one.title) for one in tabs],
                sizing_mode="stretch_width",
            )
        )
        if shared.bench is not None:
            self._force_at, self._recording_at = (
                tabs.index(self._force),
                tabs.index(self._recording),
            )

    def begin(self) -> None:
        """Put the page together, and show what was opened."""
        from bokeh.layouts import column

        self._document.add_root(
            column(self._said, self._tabs, sizing_mode="stretch_width", spacing=8, name="main")
        )
        self._results.show(self._shared.results)
        if self._bench is None:
            return
        self._side.layout.name = "side"
        self._document.add_root(self._side.layout)
        self._document.on_session_destroyed(lambda context: self._close())
        self._document.add_periodic_callback(self._poll, POLL)
        self._tabs.on_change("active", lambda attribute, old, new: self._tab())
        self._columns.show(self._bench)
        self._diagnosis.show(self._bench)
        self._poll()
        self._load()

    def _close(self) -> None:
        self._open = False
        self._shared.numerics.forget(lambda kind: isinstance(kind, tuple) and kind[0] is self)

    # what is clicked

    def _chosen(self, number: int) -> None:
        self._change(benches.with_shown(self._now, number))
        self._columns.show(self._now)
        self._load()

    def _mapped(self, channel: str, column: str) -> None:
        self._change(benches.with_column(self._now, channel, column))
        self._columns.show_lines(self._now)
        self._load()

    def _switched(self, names: Sequence[str]) -> None:
        if frozenset(names) != frozenset(self._now.model.elements.names()) - self._now.off:
            self._change(benches.with_elements(self._now, names))
            self._run()

    def _moved(self, path: str, value: float) -> None:
        try:
            self._change(benches.with_value(self._now, path, value))
        except InputError as error:
            self._say("value", [str(one) for one in error.problems])
            return
        self._say("value", [])
        self._run()

    def _reset(self) -> None:
        self._change(benches.as_filed(self._now))
        self._run()

    @property
    def _now(self) -> Bench:
        assert self._bench is not None
        return self._bench

    def _change(self, bench: Bench) -> None:
        self._bench = bench
        self._side.show(bench)
        self._diagnosis.show(bench)

    # what follows

    def _load(self) -> None:
        """Read the recording anew: another one, or with other columns."""
        self._prepared, self._begun, self._filed = None, None, None
        for tab in (self._recording, self._simulation, self._force):
            tab.clear()
        bench = self._now
        self._side.busy("estimating the motion …")
        self._ask("look", lambda: look_of(bench), lambda found: self._recording.show(*found))
        self._ask(
            "prepare",
            lambda: prepare(bench.model, benches.read_shown(bench)),
            self._have,
        )

    def _have(self, prepared: Prepared) -> None:
        self._prepared = prepared
        self._run()
        self._shared.numerics.ask("ready", ready_to_lower)

    def _run(self) -> None:
        """Simulate the model that is set."""
        prepared, before, filed, bench = self._prepared, self._begun, self._filed, self._now
        if prepared is None:
            return
        self._ask("run", lambda: run_of(prepared, bench, before, filed), self._ran)
        self._tab()

    def _ran(self, ran: Ran) -> None:
        self._begun, self._filed = ran.begun, ran.filed
        self._simulation.show(ran.filed, ran.shown, ran.begun.fitted, ran.seconds)
        self._side.busy("")

    def _fit(self) -> None:
        """Fit the start of free runs to the recording, with the model that is set."""
        prepared, bench = self._prepared, self._now
        if prepared is None:
            return

        def fitted(begun: Begun) -> None:
            self._begun, self._filed = begun, None
            self._run()

        self._side.busy("fitting the start …")
        self._ask("run", lambda: fit_start(prepared, benches.current(bench)), fitted)

    def _tab(self) -> None:
        """Draw the recording and work out ΔF where they are looked at."""
        self._recording.draw(self._tabs.active == self._recording_at)
        prepared, bench = self._prepared, self._now
        if prepared is None or self._tabs.active != self._force_at:
            return

        def show(found: tuple[Lacking, ...]) -> None:
            self._force.show(found)

        self._ask("force", lambda: lacking(prepared, benches.current(bench)), show)

    def _ask(self, kind: str, work: Callable[[], Value], show: Callable[[Value], None]) -> None:
        """Do some work in the thread of the numerics, and show what it returns; what is wrong is
        said instead."""

        def done(value: Value) -> None:
            if self._open:
                self._say(kind, [])
                show(value)

        def failed(sentences: list[str]) -> None:
            if self._open:
                self._say(kind, sentences)
                self._side.busy("")

        def whole() -> None:
            try:
                value = work()
            except Exception as error:
                _, sentences = error_sentences(error)
                self._later(lambda: failed(sentences))
            else:
                self._later(lambda: done(value))

        self._shared.numerics.ask((self, kind), whole)

    def _later(self, call: Callable[[], None]) -> None:
        if self._open:
            self._document.add_next_tick_callback(call)

    def _say(self, kind: str, sentences: list[str]) -> None:
        self._problems[kind] = sentences
        every = [one for group in self._problems.values() for one in group]
        put(self._said, problems_of(list(dict.fromkeys(every))))
        self._said.visible = bool(every)

    # the diagnosis

    def _start(self, unseen: tuple[int, ...]) -> None:
        try:
            self._shared.start(self._now, unseen)
        except InputError as error:
            self._diagnosis.refuse([str(one) for one in error.problems])
            return
        self._collected = ""
        self._poll()

    def _stop(self) -> None:
        self._shared.stop()
        self._poll()

    def _poll(self) -> None:
        progress = self._shared.progress()
        if progress is None:
            return
        self._diagnosis.follow(progress)
        if progress.state != "done" or self._collected == str(progress.output):
            return
        self._collected = str(progress.output)
        try:
            result = self._shared.collected()
        except InputError as error:
            self._diagnosis.answer(problems_of([str(one) for one in error.problems]))
            return
        if result is not None:
            self._results.show(self._shared.results, result.name)
            self._diagnosis.answer(Markup("<hr>") + result_html(result, self._shared.address))


def ready_to_lower() -> None:
    """Load what derives equations, before an element is switched: that takes a second."""
    import_module("symhyb.mechanics.equations")


def run_of(prepared: Prepared, bench: Bench, before: Begun | None, filed: Shown | None) -> Ran:
    """Simulate the model that is set, and that of the file where this was not done yet or its run
    starts elsewhere."""
    first = before or begin(prepared, bench.model)
    if filed is None:
        filed = shown_run(prepared, bench.model, begin(prepared, bench.model, first))
    model = benches.current(bench)
    begun = begin(prepared, model, first)
    clock = time.perf_counter()
    shown = shown_run(prepared, model, begun)
    return Ran(begun, filed, shown if bench.changed else filed, time.perf_counter() - clock)
