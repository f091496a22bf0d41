"""What the verbs of the command line print: the answer first, then what it rests on."""

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from symhyb.data.catalogue import DATASETS, Dataset, named, unknown
from symhyb.data.datasets import listing
from symhyb.discrepancy.results import Diagnosis, Found
from symhyb.discrepancy.words.effects import amount_text
from symhyb.discrepancy.words.wording import (
    grouped_alternatives,
    measurement_phrase,
    parameter_phrase,
    percent_text,
    quantity_text,
)
from symhyb.errors import InputError, Problem
from symhyb.expected import Check
from symhyb.fault import SO_FAR, STAGE
from symhyb.model.constraints import Constraint
from symhyb.model.types import Model, On, Parameter, place_text
from symhyb.model.vocabulary import force_unit
from symhyb.report.contract import finite
from symhyb.report.sentences import alternative_sentence, remainder_sentence, score_sentences
from symhyb.writing import require_folder, write_file

if TYPE_CHECKING:  # a verb that only reads a file need not load the numerics
    from symhyb.discrepancy.checks.first_checks import FirstChecks
    from symhyb.discrepancy.checks.modes import Mode
    from symhyb.discrepancy.checks.response import Response
    from symhyb.discrepancy.recorded.residual import Discrepancy
    from symhyb.learned_run import Outcome
    from symhyb.numeric.lowered.machine import Machine
    from symhyb.numeric.runs.integrate import Trajectory
    from symhyb.numeric.runs.scenario import Scenario
    from symhyb.study import StudyResult

WIDE = 160  # columns of a table that does not go to a terminal


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """Yield ``say(step)``, which shows the step on a terminal and is silent elsewhere. An
    error that nobody expected learns in which step it happened."""
    console, last = Console(stderr=True), ["starting"]
    status = console.status("") if console.is_terminal else None

    def say(step: str) -> None:
        last[0] = step
        if status is not None:
            status.update(escape(step))

    try:
        with status or nullcontext():
            yield say
    except KeyboardInterrupt as stop:
        notes = [note for note in getattr(stop, "__notes__", ()) if note.startswith(SO_FAR)]
        warn([f"interrupted at this step: {last[0]}", *notes[:1]])
        raise
    except Exception as error:
        error.add_note(f"{STAGE}{last[0]}")
        raise


def print_result(result: "StudyResult", directory: Path) -> None:
    """Print a diagnosis: verdict, effects, rivals, scores, and where the files are."""
    diagnosis, verdict = result.diagnosis, result.verdict
    print(diagnosis.sentence)
    for line in _effects(diagnosis):
        print(f"  {line}")
    _print_list(
        "Not ruled out by these recordings:",
        (alternative_sentence(*group) for group in grouped_alternatives(diagnosis.alternatives)),
    )
    if diagnosis.record_next:
        print(f"Record next: {diagnosis.record_next}")
    units = {sensor.name: sensor.unit.text for sensor in result.model.sensors}
    _print_list("Scores before and after:", score_sentences(verdict, units))
    print(f"  {verdict.carries}")
    _print_list(remainder_sentence(diagnosis.remainder), diagnosis.remainder_notes)
    _print_list("Notes on the recordings:", diagnosis.notes)
    print(f"Report: {directory / 'report.html'}")


def print_learned(outcome: "Outcome", directory: Path) -> None:
    """Print what was learned: terms or networks, scores, and where the files are."""
    learned = outcome.learned
    print(learned.sentence)
    for line in [one.formula + (f" [{one.unit}]") for one in learned.terms]:
        print(f"  {line}")
    for one in learned.networks:
        print(f"  on {one.on}: sees {', '.join(one.inputs)}. {one.sentence}".rstrip())
    units = {sensor.name: sensor.unit.text for sensor in learned.model.sensors}
    _print_list("Scores before and after:", score_sentences(learned.verdict, units))
    print(f"  {learned.verdict.carries}")
    if outcome.beside is not None:
        _print_list("A diagnosis says:", (outcome.beside.diagnosis.sentence,))
    if learned.notes:
        _print_list("Notes:", learned.notes)
    print(f"Report: {directory / 'report.html'}")


def print_checks(checks: Sequence[Check]) -> None:
    """Print what was expected beside what came out."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=WIDE)
    table = Table(box=box.SIMPLE)
    for heading in ("expected", "wanted", "got", ""):
        table.add_column(heading, overflow="fold")
    for one in checks:
        cells = (one.subject, one.wanted, one.got, "passed" if one.passed else "FAILED")
        table.add_row(*map(escape, cells))
    console.print(table)


def print_model(model: Model) -> None:
    """Print what a checked model declares."""
    said = {
        "coordinates": [f"{q.name} [{q.unit}]" for q in model.coordinates],
        "parameters": [_parameter(parameter) for parameter in model.all_parameters()],
        "inputs": [f"{item.name} [{item.unit}]" for item in model.inputs],
        "bodies": [body.name for body in model.bodies],
        "constraints": [_constraint(item) for item in model.constraints],
        "elements": [f"{e.name} ({e.kind} {place_text(e.place)})" for e in model.elements],
        "sensors": [f"{s.name} [{s.unit}] measures {s.measures}" for s in model.sensors],
    }
    print(
        f"{model.file}: no problem found", *([f"  {model.title}"] if model.title else []), sep="\n"
    )
    for section, parts in said.items():
        if parts:
            print(f"  {section}: {', '.join(parts)}")


def _constraint(item: Constraint) -> str:
    of = f" of {' and '.join(item.names)}" if item.names else ""
    return f"{item.name} ({item.kind}{of})"


def model_facts(model: Model) -> dict[str, Any]:
    """Give what a checked model declares as plain values, by section and name."""
    return {
        "file": model.file,
        "title": model.title,
        "coordinates": {q.name: {"unit": q.unit.text} for q in model.coordinates},
        "parameters": {
            p.path: {"value": p.value, "sd": p.sd, "unit": p.unit.text}
            for p in model.all_parameters()
        },
        "inputs": {item.name: {"unit": item.unit.text} for item in model.inputs},
        "bodies": [body.name for body in model.bodies],
        "constraints": {
            item.name: {"kind": item.kind, "of": list(item.names)} for item in model.constraints
        },
        "elements": {
            e.name: {"kind": e.kind, "place": place_text(e.place)} for e in model.elements
        },
        "sensors": {
            s.name: {"unit": s.unit.text, "measures": s.measures.text} for s in model.sensors
        },
    }


def discrepancy_facts(gap: "Discrepancy") -> dict[str, Any]:
    """Give ΔF of one recording by coordinate, root mean squares in the unit of its force."""
    forces = {}
    sizes = [np.sqrt(np.mean(part**2, axis=0)) for part in (gap.force, gap.band, gap.applied)]
    for i, coordinate in enumerate(gap.model.coordinates):
        unit = force_unit(gap.model, On(coordinate.name))
        force, noise, applied = (finite(float(size[i]) / unit.factor) for size in sizes)
        forces[coordinate.name] = {
            "force": force,
            "noise": noise,
            "applied": applied,
            "unit": unit.text,
        }
    return {
        "recording": gap.recording,
        "rms": forces,
        "noise": dict(gap.noise),
        "notes": list(gap.notes),
        "summary": gap.summary(),
    }


def print_first_checks(checks: "FirstChecks") -> None:
    """Print what the first checks of a recording show, a check a row."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=WIDE)
    table = Table(box=None, show_header=False, pad_edge=True, padding=(0, 0, 0, 4))
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    before = ""
    for name, sentence in checks.said:
        table.add_row("" if name == before else name, escape(sentence))
        before = name
    with console.capture() as written:
        console.print(table)
    print("  first checks:", *(line.rstrip() for line in written.get().splitlines()), sep="\n")


def check_facts(checks: "FirstChecks") -> dict[str, Any]:
    """Give the first checks of one recording as plain values; null where one could not be had,
    for which ``skipped`` gives the reason. Frequency responses are [real, imaginary], SI."""
    timing, balance = checks.timing, checks.balance
    return {
        "sampling": {
            "rate": timing.rate,
            "jitter": timing.jitter,
            "held": timing.held,
            "missing": timing.missing,
        },
        "delays": [
            {**asdict(late), "sd": finite(late.sd), "sentence": late.sentence}
            for late in timing.late
        ],
        "rest": asdict(checks.standstill) if checks.standstill else None,
        "modes": [
            {**asdict(swing), "modes": [_mode_facts(mode) for mode in swing.modes]}
            for swing in checks.swings
        ],
        "response": [_response_facts(one) for one in checks.responses],
        "energy": {**asdict(balance), "sentence": balance.sentence} if balance else None,
        "skipped": dict(checks.skipped),
    }


def _mode_facts(mode: "Mode") -> dict[str, Any]:
    shape = {name: [part.real, part.imag] for name, part in mode.shape}
    return {
        "frequency": mode.frequency,
        "damping": mode.damping,
        "rate": mode.rate,
        "shape": shape,
    }


def _response_facts(one: "Response") -> dict[str, Any]:
    gains = {"measured": one.measured, **one.simulated}
    return {
        "sensor": one.sensor,
        "drives": list(one.drives),
        "frequency": one.frequency.tolist(),
        "coherence": one.coherence.tolist(),
        "gain": {
            name: {
                drive: [[float(h.real), float(h.imag)] for h in gain[:, i]]
                for i, drive in enumerate(one.drives)
            }
            for name, gain in gains.items()
        },
        "unexplained": one.unexplained,
        "apart": dict(one.apart),
        "split": asdict(one.split) if one.split else None,
        "sentence": one.sentence,
    }


def read_map(options: Sequence[str] | None) -> dict[str, str]:
    """Read the options ``--map channel=column``.

    Raises:
        InputError: an option without channel, ``=`` or column, or a channel that stands twice.
    """
    columns: dict[str, str] = {}
    problems = []
    for text in options or ():
        channel, equals, column = (part.strip() for part in text.partition("="))
        if not (channel and equals and column):
            problems.append(Problem("write it as channel=column", f"--map {text}"))
        elif channel in columns:
            problems.append(Problem(f"'{channel}' is mapped twice", f"--map {text}"))
        columns[channel] = column
    if problems:
        raise InputError(problems)
    return columns


def dataset_of(name: str) -> Dataset:
    """Find a public recording by its name.

    Raises:
        InputError: no recording is known by that name.
    """
    known = named(name)
    if known is None:
        raise InputError(Problem(unknown(name)))
    return known


def print_dataset(dataset: Dataset) -> None:
    """Print what is known of a public recording, with its addresses."""
    print(listing().split("\n\n")[DATASETS.index(dataset)])
    for file in dataset.files:
        print(f"  {file.name}: {file.address}")
        print(f"    {file.size} bytes, SHA-256 {file.sha256}")


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


def _parameter(parameter: Parameter) -> str:
    value = quantity_text(parameter.value, parameter.unit.text, parameter.sd, digits=8)
    return f"{parameter.path} = {value}" + (" (held)" if parameter.sd is None else "")


def _effects(diagnosis: Diagnosis) -> Iterator[str]:
    yield from map(_effect, diagnosis.found)
    yield from map(parameter_phrase, diagnosis.parameters)
    yield from map(measurement_phrase, diagnosis.measurement)


def _effect(found: Found) -> str:
    """Write one found element: name, kind, place and every number with its deviation."""
    element = found.element
    words = [f"{key} {word}" for key, word in element.options]
    numbers = ", ".join([*words, *(f"{one.term} = {amount_text(one)}" for one in found.estimates)])
    share = "" if found.share is None else f" (share {percent_text(found.share)})"
    return f"{element.name}: {element.kind} {place_text(element.place)}, {numbers}{share}"


def _print_list(heading: str, sentences: Iterable[str]) -> None:
    lines = list(sentences)
    if lines or heading.endswith("."):
        print(heading)
    for line in lines:
        print(f"  {line}")
