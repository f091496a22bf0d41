"""A diagnosis, what was learned and what a study expected, printed: the answer comes first."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.markup import escape
from rich.table import Table

from symhyb.console.terminal import table_console
from symhyb.discrepancy.results import Diagnosis, Found
from symhyb.discrepancy.words.effects import amount_text
from symhyb.discrepancy.words.wording import (
    grouped_alternatives,
    measurement_phrases,
    parameter_phrase,
    percent_text,
)
from symhyb.interruption import is_interruption
from symhyb.model.types import place_text
from symhyb.model.vocabulary import said_of
from symhyb.report.sentences import alternative_sentence, remainder_sentence, score_sentences
from symhyb.study.expected import Check

if TYPE_CHECKING:  # a verb that only reads a file need not load the numerics
    from symhyb.learned_run import Outcome
    from symhyb.study.run import Leave, StudyResult


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
    beside = (note for note in diagnosis.notes if note not in diagnosis.sentence)
    _print_list("Notes on the recordings:", beside)
    print(f"Report: {directory / 'report.html'}")


@contextmanager
def printed_if_interrupted(directory: Path, as_json: bool = False) -> Iterator["Leave"]:
    """Yield what keeps a result whose files are left; an interruption then prints the last one,
    in sentences alone, before it goes on."""
    kept: list[StudyResult] = []
    try:
        yield kept.append
    except (KeyboardInterrupt, Exception) as stop:
        if kept and is_interruption(stop) and not as_json:
            print_result(kept[-1], directory)
        raise


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
    console = table_console()
    table = Table(box=box.SIMPLE)
    for heading in ("expected", "wanted", "got", ""):
        table.add_column(heading, overflow="fold")
    for one in checks:
        cells = (one.subject, one.wanted, one.got, "passed" if one.passed else "FAILED")
        table.add_row(*map(escape, cells))
    console.print(table)


def _effects(diagnosis: Diagnosis) -> Iterator[str]:
    yield from map(_effect, diagnosis.found)
    yield from map(parameter_phrase, diagnosis.parameters)
    yield from measurement_phrases(diagnosis.measurement)


def _effect(found: Found) -> str:
    """Write one found element: name, kind, place and every number with its deviation."""
    element = found.element
    words = [f"{key} {word}" for key, word in said_of(element)]
    numbers = ", ".join([*words, *(f"{one.term} = {amount_text(one)}" for one in found.estimates)])
    share = "" if found.share is None else f" (share {percent_text(found.share)})"
    return f"{element.name}: {element.kind} {place_text(element.place)}, {numbers}{share}"


def _print_list(heading: str, sentences: Iterable[str]) -> None:
    lines = list(sentences)
    if lines or heading.endswith("."):
        print(heading)
    for line in lines:
        print(f"  {line}")
