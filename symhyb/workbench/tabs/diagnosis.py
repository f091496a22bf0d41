"""The tab of a diagnosis: started, followed, stopped, and what it said."""

from collections.abc import Callable
from typing import Any

from markupsafe import Markup

from symhyb.workbench.bench import Bench
from symhyb.workbench.job import Progress
from symhyb.workbench.widgets import paragraph, problems_of, put, styled, text

SHOWN = 12  # of the last steps
ENDINGS = {
    "done": "Done; the result is in {output}.",
    "stopped": "Stopped; what was not written is lost.",
    "failed": "The diagnosis failed.",
}


def asked_sentence(bench: Bench, unseen: int) -> str:
    """What a diagnosis would be asked now."""
    off = f" without {', '.join(sorted(bench.off))}" if bench.off else ""
    changed = [path for path, _ in bench.values]
    values = f", with {', '.join(changed)} as set" if changed else ""
    count = len(bench.paths) - unseen
    seen = f"{count} recording{'s' * (count != 1)}"
    proof = f", proven on {unseen} unseen" if unseen else "; none is left out for a proof"
    return f"Diagnoses the model{off}{values} on {seen}{proof}."


def progress_html(progress: Progress) -> Markup:
    """How far a diagnosis is, or how it ended."""
    steps = Markup('<ol class="steps">{}</ol>').format(
        Markup("").join(Markup("<li>{}</li>").format(one) for one in progress.steps[-SHOWN:])
    )
    if progress.state == "running":
        return paragraph(progress.words, "lead") + steps
    said = paragraph(ENDINGS[progress.state].format(output=progress.output), "lead")
    return said + problems_of(progress.problems) + steps


class DiagnosisTab:
    """What starts and stops a diagnosis, and shows how far it is."""

    title = "Diagnosis"

    def __init__(self, start: Callable[[tuple[int, ...]], None], stop: Callable[[], None]) -> None:
        from bokeh.layouts import column, row
        from bokeh.models.widgets import Button, CheckboxGroup

        self._asked, self._progress, self._answer = text(), text(), text()
        self._unseen = styled(CheckboxGroup(labels=[], active=[]))
        self._choice = column(
            text(paragraph("Unseen recordings, for the proof alone:", "soft")), self._unseen
        )
        self._start = styled(Button(label="Diagnose", button_type="primary", width=120))
        self._stop = styled(Button(label="Stop", width=90, disabled=True))
        self._start.on_click(lambda: start(self.unseen()))
        self._stop.on_click(stop)
        self._bench: Bench | None = None
        self._unseen.on_change("active", lambda attribute, old, new: self._say())
        self.layout = column(
            self._choice,
            self._asked,
            row(self._start, self._stop, spacing=8),
            self._progress,
            self._answer,
            sizing_mode="stretch_width",
            spacing=6,
        )

    def unseen(self) -> tuple[int, ...]:
        """The recordings that are left out for the proof, by number."""
        return tuple(self._unseen.active)

    def show(self, bench: Bench) -> None:
        """Show what would be diagnosed."""
        self._bench = bench
        labels = [path.name for path in bench.paths]
        if self._unseen.labels != labels:
            self._unseen.labels = labels
        self._choice.visible = len(labels) > 1
        self._say()

    def follow(self, progress: Progress | None) -> None:
        """Show how far a diagnosis is."""
        running = progress is not None and progress.state == "running"
        self._start.disabled, self._stop.disabled = running, not running
        if progress is None:
            put(self._progress, Markup(""))
            return
        html = progress_html(progress)
        if self._progress.text != str(html):
            put(self._progress, html)
        if running:
            put(self._answer, Markup(""))

    def answer(self, html: Markup) -> None:
        """Show a result below the steps."""
        put(self._answer, html)

    def refuse(self, sentences: list[str]) -> None:
        """Say why no diagnosis was started."""
        put(self._progress, problems_of(sentences))

    def _say(self) -> None:
        if self._bench is not None:
            put(self._asked, paragraph(asked_sentence(self._bench, len(self.unseen())), "soft"))

    def root(self) -> Any:
        """The part of the page."""
        return self.layout
