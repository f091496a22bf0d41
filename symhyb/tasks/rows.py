"""The outcomes of the tasks of a study as a table: a row a task, in the order of the study."""

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from symhyb.data.files.extras import needed
from symhyb.report.contract import finite
from symhyb.tasks.fitting import Rung
from symhyb.tasks.outcome import Outcome, Outcomes
from symhyb.writing import write_file

Cell = str | float | None


@dataclass(frozen=True, slots=True)
class Rows:
    """A table: the ``head`` names its columns, a cell of None is empty."""

    head: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]


def rows_of(outcomes: Outcomes, times: bool = False) -> Rows:
    """A row for each task: what the sweep chose, how the task ended, its verdict, every found
    number with its deviation, probabilities of classes, scores, and why it failed.
    Without ``times`` nothing depends on when and where it ran.
    """
    tasks = outcomes.tasks
    axes = list(dict.fromkeys(axis for one in tasks for axis, _ in one.entry.settings))
    found = sorted({(name, number.unit) for one in tasks for name, number in one.found.items()})
    classes = sorted({name for one in tasks for name in one.classes})
    scores = list(dict.fromkeys(path for one in tasks for path in one.scores))
    head = ["task", *axes, "state", "verdict", "found"]
    for name, unit in found:
        head += [f"{name} [{unit}]", f"{name} sd [{unit}]"]
    rungs = list(dict.fromkeys(rung.name for one in tasks for rung in rungs_of(one)))
    head += ["structure"] if rungs else []
    for name in rungs:
        head += [f"structure {name} ln evidence", f"structure {name} probability"]
    head += [f"class {name}" for name in classes] + scores
    head += [*(["seconds"] if times else []), "failure"]
    rows = []
    for one in tasks:
        chosen = dict(one.entry.settings)
        row: list[Cell] = [one.entry.name, *(chosen.get(axis) for axis in axes), one.state]
        row += [one.verdict or None, ", ".join(causes_of(one)) or None]
        for name, unit in found:
            number = one.found.get(name)
            same = number is not None and number.unit == unit
            row += [number.value, number.sd] if number is not None and same else [None, None]
        row += _of_structures(one, rungs) if rungs else []
        row += [one.classes.get(name) for name in classes]
        row += [one.scores.get(path) for path in scores]
        row += [*([one.seconds] if times else []), one.failure or None]
        rows.append(tuple(row))
    return Rows(tuple(head), tuple(rows))


def rungs_of(outcome: Outcome) -> tuple[Rung, ...]:
    """The structures that a task compared, none where it compared none."""
    return () if outcome.fitted is None else outcome.fitted.rungs


def _of_structures(one: Outcome, names: Sequence[str]) -> list[Cell]:
    """The likeliest structure, and evidence and probability of each."""
    found = {rung.name: rung for rung in rungs_of(one)}
    best = max(found.values(), key=lambda rung: rung.probability, default=None)
    row: list[Cell] = [None if best is None else best.name]
    for name in names:
        rung = found.get(name)
        row += [None, None] if rung is None else [finite(rung.evidence), rung.probability]
    return row


def causes_of(outcome: Outcome) -> list[str]:
    """The names of what was found, without those of single recordings."""
    return sorted(name for name in outcome.found if "@" not in name)


def csv_text(table: Rows) -> str:
    """The table as CSV; numbers have all their digits."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table.head)
    for row in table.rows:
        writer.writerow(["" if cell is None else cell for cell in row])
    return stream.getvalue()


def write_parquet(table: Rows, path: Path) -> None:
    """Write the table as Parquet: texts, and numbers as 64 bits; empty cells are null.

    Raises:
        InputError: pyarrow is not installed, or the file cannot be written.
    """
    arrow = needed("pyarrow", "parquet", str(path))
    parquet = needed("pyarrow.parquet", "parquet", str(path))
    columns = {}
    for i, name in enumerate(table.head):
        cells = [row[i] for row in table.rows]
        numbers = any(isinstance(cell, int | float) for cell in cells)
        columns[name] = arrow.array(cells, arrow.float64() if numbers else arrow.string())
    stream = arrow.BufferOutputStream()
    parquet.write_table(arrow.table(columns), stream)
    write_file(path, stream.getvalue().to_pybytes())
