"""The verb ``symhyb watch``: a model beside its machine, while it runs.

Heavy modules are imported inside, so that help answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from symhyb.cli.options import Map, ModelFile


def watch(
    model: ModelFile,
    source: Annotated[
        str,
        typer.Argument(
            metavar="SOURCE",
            help="A file that grows, - for standard input, or udp:PORT for datagrams from this"
            " machine: rows as in a CSV file, the names of the columns first. Or a bag of ROS, MCAP"
            " also while it is written.",
        ),
    ],
    columns: Map = None,
    reference: Annotated[
        float,
        typer.Option(metavar="S", min=1.0, help="So much of the source, in s, is the reference."),
    ] = 60.0,
    false_alarms: Annotated[
        float,
        typer.Option(metavar="N", min=1e-6, max=1e4, help="False alarms a day that are allowed."),
    ] = 1.0,
    log: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Append every event to a file, as lines of JSON."),
    ] = None,
    once: Annotated[
        bool, typer.Option("--once", help="End at the end of the file instead of waiting for more.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print events as lines of JSON instead of sentences.")
    ] = False,
) -> None:
    """Watch a machine while it runs: say when something changes, what, and by how much.

    The first part of the source is the reference: the machine as it is, and what the model lacks
    already. From then on every block is held against it by all causes that a diagnosis knows.
    Exit status: 1 if something has changed, 0 if not.

    \b
    Example:
      symhyb watch corrected.toml rig.csv --log events.jsonl
    """
    from contextlib import closing, nullcontext

    from symhyb.data.columns import read_map
    from symhyb.model.read import read_model
    from symhyb.monitoring.events import Log
    from symhyb.monitoring.played import is_bag, of_bag
    from symhyb.monitoring.sources import source_of
    from symhyb.monitoring.watching import Watch, watch

    declared, mapped, moved = read_model(model), read_map(columns), False
    if is_bag(source):
        lines, mapped = of_bag(source, declared, mapped, follow=not once), {}
    else:
        lines = source_of(source, follow=not once)
    settings = Watch(declared, reference, false_alarms, mapped or None, source)
    with Log(log) if log is not None else nullcontext() as kept, closing(lines):
        for event in watch(settings, lines):
            moved |= event.kind == "changed"
            if kept is not None:
                kept.add(event)
            print(event.json() if as_json else f"{event.at_s:10.2f} s  {event.sentence}")
            sys.stdout.flush()
    raise typer.Exit(int(moved))
