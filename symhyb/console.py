"""What the verbs of the command line print: the answer first, then what it rests on."""

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from symhyb.discrepancy.results import Diagnosis, Found
from symhyb.discrepancy.wording import (
    measurement_phrase,
    parameter_phrase,
    percent_text,
    quantity_text,
)
from symhyb.expected import Check
from symhyb.model.types import Model, On, place_text
from symhyb.model.vocabulary import force_unit
from symhyb.report.contract import finite
from symhyb.report.sentences import alternative_sentence, remainder_sentence, score_sentences

if TYPE_CHECKING:  # a verb that only reads a file need not load the numerics
    from symhyb.discrepancy.residual import Discrepancy
    from symhyb.study import StudyResult

NARROWEST = 100  # columns of a table that does not go to a terminal


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """Yield ``say(step)``, which shows the step on a terminal and is silent elsewhere."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda _: None
        return
    with console.status("") as status:
        yield lambda step: status.update(escape(step))


def print_result(result: "StudyResult", directory: Path) -> None:
    """Print a diagnosis: verdict, effects, rivals, scores, and where the files are."""
    diagnosis, verdict = result.diagnosis, result.verdict
    print(diagnosis.sentence)
    for line in _effects(diagnosis):
        print(f"  {line}")
    _print_list(
        "Not ruled out by these recordings:", map(alternative_sentence, diagnosis.alternatives)
    )
    if diagnosis.record_next:
        print(f"Record next: {diagnosis.record_next}")
    units = {sensor.name: sensor.unit.text for sensor in result.model.sensors}
    _print_list("Scores before and after:", score_sentences(verdict, units))
    print(f"  {verdict.carries}")
    _print_list(remainder_sentence(diagnosis.remainder), diagnosis.remainder_notes)
    _print_list("Notes on the recordings:", diagnosis.notes)
    print(f"Report: {directory / 'report.html'}")


def print_checks(checks: Sequence[Check]) -> None:
    """Print what was expected beside what came out."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=max(NARROWEST, console.width))
    table = Table(box=box.SIMPLE)
    for heading in ("expected", "wanted", "got", ""):
        table.add_column(heading, overflow="fold")
    for one in checks:
        cells = (one.subject, one.wanted, one.got, "passed" if one.passed else "FAILED")
        table.add_row(*map(escape, cells))
    console.print(table)


def model_facts(model: Model) -> dict[str, Any]:
    """Give what a checked model declares, by section."""
    return {
        "file": model.file,
        "title": model.title,
        "coordinates": [f"{q.name} [{q.unit}]" for q in model.coordinates],
        "parameters": [
            f"{p.path} = {quantity_text(p.value, p.unit.text, p.sd)}"
            + (", held" if p.sd is None else "")
            for p in model.all_parameters()
        ],
        "inputs": [f"{item.name} [{item.unit}]" for item in model.inputs],
        "bodies": [body.name for body in model.bodies],
        "elements": [f"{e.name}: {e.kind} {place_text(e.place)}" for e in model.elements],
        "sensors": [f"{s.name} [{s.unit}] measures {s.measures}" for s in model.sensors],
    }


def discrepancy_facts(gap: "Discrepancy") -> dict[str, Any]:
    """Give ΔF of one recording by coordinate, root mean squares in the unit of its force."""
    forces = {}
    sizes = [np.sqrt(np.mean(part**2, axis=0)) for part in (gap.force, gap.band, gap.applied)]
    for i, coordinate in enumerate(gap.model.coordinates):
        unit = force_unit(gap.model, On(coordinate.name))
        force, noise, applied = (finite(float(size[i]) / unit.factor) for size in sizes)
        forces[coordinate.name] = {
            "force": force, "noise": noise, "applied": applied, "unit": unit.text,
        }  # fmt: skip
    return {
        "recording": gap.recording,
        "rms": forces,
        "noise": dict(gap.noise),
        "notes": list(gap.notes),
        "summary": gap.summary(),
    }


def warn(sentences: Sequence[str]) -> None:
    """Write sentences to the standard error, one a line."""
    for sentence in sentences:
        print(f"note: {sentence}", file=sys.stderr)


def _effects(diagnosis: Diagnosis) -> Iterator[str]:
    yield from map(_effect, diagnosis.found)
    yield from map(parameter_phrase, diagnosis.parameters)
    yield from map(measurement_phrase, diagnosis.measurement)


def _effect(found: Found) -> str:
    """Write one found element: name, kind, place and every number with its deviation."""
    element = found.element
    numbers = ", ".join(
        f"{one.term} = {quantity_text(one.value, one.unit, one.sd)}" for one in found.estimates
    )
    share = "" if found.share is None else f" (share {percent_text(found.share)})"
    return f"{element.name}: {element.kind} {place_text(element.place)}, {numbers}{share}"


def _print_list(heading: str, sentences: Iterable[str]) -> None:
    lines = list(sentences)
    if lines or heading.endswith("."):
        print(heading)
    for line in lines:
        print(f"  {line}")
