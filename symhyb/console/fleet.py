"""A fleet, printed: its numbers, the units that deviate, and what is worth looking at next."""

from collections.abc import Sequence

from rich import box
from rich.markup import escape
from rich.table import Table

from symhyb.console.tasks import counted
from symhyb.console.terminal import table_console
from symhyb.fleet.fleet import Fleet
from symhyb.fleet.looking_next import Next
from symhyb.fleet.words import (
    common_text,
    fleet_notes,
    slope_sentences,
    spread_text,
    structure_texts,
    unit_text,
)

MOST = 30  # units that are printed; files have all


def print_fleet(fleet: Fleet, directory: object) -> None:
    """Print what units have in common, and which deviate."""
    named = fleet.deviating
    alike = len(fleet.units) - len(named)
    if fleet.title:
        print(fleet.title)
    deviate = f"{len(named)} deviate" if len(named) != 1 else "1 deviates"
    print(f"{counted(len(fleet.units), 'unit')}: {alike} alike, {deviate}")
    if fleet.structures:
        _print_table(
            ("structure", "ln evidence", "probability", "likeliest in"),
            [(one.name, *structure_texts(one)) for one in fleet.structures],
        )
        print(f"\nnumbers of the structure '{fleet.structure}':")
    _print_table(
        ("number", "mean", "spread between units"),
        [(one.name, common_text(one), spread_text(one)) for one in fleet.numbers],
    )
    print()
    for sentence in slope_sentences(fleet):
        print(sentence)
    for unit in named[:MOST]:
        print(unit_text(unit))
    if len(named) > MOST:
        print(f"and {len(named) - MOST} more")
    for note in fleet_notes(fleet):
        print(f"note: {note}")
    print(f"next: symhyb next {directory}")


def _print_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    console, table = table_console(), Table(box=box.SIMPLE)
    for heading in head:
        table.add_column(heading, overflow="fold")
    for row in rows:
        table.add_row(*map(escape, row))
    with console.capture() as written:
        console.print(table)
    print("\n".join(line.rstrip() for line in written.get().rstrip().splitlines()))


def print_next(found: Sequence[Next], most: int) -> None:
    """Print what is worth looking at, in order."""
    if not found:
        print("Nothing stands out: all tasks are finished, and no unit deviates.")
    for number, one in enumerate(found[:most], 1):
        print(f"{number:3d}. {one.unit}: {one.sentence}")
        shown = ", ".join(one.recordings[:3])
        more = f" and {len(one.recordings) - 3} more" if len(one.recordings) > 3 else ""
        if shown and shown != one.unit:
            print(f"     {shown}{more}")
    if len(found) > most:
        print(f"and {len(found) - most} more")
