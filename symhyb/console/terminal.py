"""What all verbs share: progress, notes, options that are read, files of a run."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from symhyb.console.progress_line import ProgressLine, ProgressLog, live
from symhyb.errors import InputError, Problem
from symhyb.fault import SO_FAR, STAGE
from symhyb.interruption import is_interruption
from symhyb.steps import Say
from symhyb.writing import require_folder, write_file

if TYPE_CHECKING:  # a verb that only reads a file need not load the numerics
    from symhyb.numeric.lowered.machine import Machine
    from symhyb.numeric.runs.integrate import Trajectory
    from symhyb.numeric.runs.scenario import Scenario

WIDE = 160  # columns of a table that does not go to a terminal


def table_console() -> Console:
    """Where tables are printed: as wide as the terminal, or wide enough without one."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=WIDE)


@contextmanager
def progress(console: Console | None = None, *, logged: bool = False) -> Iterator[Say]:
    """Yield ``say(step)``, which shows the step, for how long all has taken and, of a
    :class:`~symhyb.steps.Counted` one, how much time is left, in one line of a terminal. Elsewhere
    it is silent, or ``logged``: a line a minute. An error that nobody expected learns in which step
    it happened; an interruption says so, and what was known by then."""
    console = console or Console(stderr=True)
    last, line = ["starting"], ProgressLine()
    log = ProgressLog(partial(print, file=sys.stderr, flush=True), line)
    shown = log if logged and not console.is_terminal else line

    def say(step: str) -> None:
        last[0] = step
        shown.say(step)

    try:
        with live(console, line) if console.is_terminal else nullcontext():
            yield say
    except (KeyboardInterrupt, Exception) as stop:
        if is_interruption(stop):
            notes = [note for note in getattr(stop, "__notes__", ()) if note.startswith(SO_FAR)]
            warn([f"interrupted at this step: {last[0]}", *notes[:1]])
        else:
            stop.add_note(f"{STAGE}{last[0]}")
        raise


def require_files(output: Path, events: Path | None) -> None:
    """Refuse files that ``simulate`` cannot leave its tables in.

    Raises:
        InputError: a folder, a folder that cannot be, or one file for both tables.
    """
    for file in (output,) if events is None else (output, events):
        if file.is_dir():
            raise InputError(Problem("is a folder; name a file in it", file=str(file)))
        require_folder(file.parent)
    if events is not None and events.resolve() == output.resolve():
        text = "is the file of the run already; name another for the events"
        raise InputError(Problem(text, file=str(events)))


def leave_run(
    machine: "Machine",
    scenario: "Scenario",
    run: "Trajectory",
    output: Path,
    events: Path | None,
    exact: bool,
) -> None:
    """Write a simulated run, and its events if a file is named, and say so."""
    from symhyb.simulation import events_sentence, events_table, integration_text, run_table

    warn(machine.notes)
    write_file(output, run_table(machine, scenario, run))
    if events is not None:
        write_file(events, events_table(run))
    span = f"{run.t.size} rows from {run.t[0]:g} to {run.t[-1]:g} s"
    print(f"{output}: {span}, by {integration_text(run)}")
    if exact:
        print(events_sentence(run))
    warn((run.note,) if run.note else ())


def warn(sentences: Sequence[str]) -> None:
    """Write sentences to the standard error, one a line."""
    for sentence in sentences:
        print(f"note: {sentence}", file=sys.stderr)
