"""The verbs for fleets: ``symhyb fleet`` and ``symhyb next``.

Heavy modules are imported inside the verb that needs them, so that help answers at once.
"""

from pathlib import Path
from typing import Annotated

import typer

from symhyb.cli.options import Force, Json, listed, print_json

Left = Annotated[Path, typer.Argument(metavar="DIR", help="Folder that symhyb run left.")]
Unit = Annotated[
    str,
    typer.Option(
        metavar="GROUPING",
        help="Grouping of the recordings that says which unit each is of; without it every task is"
        " a unit.",
    ),
]
Over = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAMES",
        help="Conditions, as temperature,hours: groupings with numbers, or known parameters."
        " Repeat it.",
    ),
]

Among = Annotated[
    list[str] | None,
    typer.Option(
        metavar="GROUPINGS",
        help="Groupings, as mount,load: each unit is compared with those that share all of them."
        " Repeat it.",
    ),
]
Structure = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Of tasks that compared structures: compare the numbers of this one; without it those"
        " of the likeliest.",
    ),
]


def fleet(
    directory: Left,
    unit: Unit = "",
    over: Over = None,
    among: Among = None,
    structure: Structure = "",
    csv: Annotated[
        Path | None,
        typer.Option(
            "--csv", metavar="FILE", help="Write a row for each unit, as .csv or as .parquet."
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw all numbers of all units, as .svg or as .png."),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Show what the units of a fleet have in common, and which deviate.

    Of a study whose tasks fit the same numbers to every unit: mean and spread between units, how
    they change with conditions, and the units that are not like the others, each with its reason:
    numbers that are off, or a structure that does not hold.

    Exit status: 0 all units are alike, 1 some deviate, 2 misuse or unreadable input.

    \b
    Example:
      symhyb fleet out --unit drive --over temperature,hours --picture fleet.svg
    """
    from symhyb.console.fleet import print_fleet
    from symhyb.fleet.fleet import fleet_of
    from symhyb.fleet.written import fleet_facts, write_picture, write_units
    from symhyb.tasks.outcome import read_outcomes
    from symhyb.writing import require_new

    for file in (csv, picture):
        require_new(file, force)
    outcomes = read_outcomes(directory)
    found = fleet_of(outcomes, unit, listed(over), listed(among), structure)
    if csv is not None:
        write_units(found, csv)
    if picture is not None:
        write_picture(found, picture)
    if as_json:
        print_json(fleet_facts(found))
    else:
        print_fleet(found, directory)
    raise typer.Exit(int(bool(found.deviating)))


def next_(
    directory: Left,
    unit: Unit = "",
    over: Over = None,
    among: Among = None,
    structure: Structure = "",
    most: Annotated[int, typer.Option(metavar="N", min=1, help="List so many at most.")] = 20,
    as_json: Json = False,
) -> None:
    """List the recordings of a study that are worth looking at, and why.

    In order: units whose structure does not hold or whose numbers deviate, diagnoses that are
    undecided or find what others do not, tasks that failed, and those not run, beginning with the
    conditions that are farthest from all that is finished.

    \b
    Example:
      symhyb next out --unit drive --over temperature
    """
    from dataclasses import asdict

    from symhyb.console.fleet import print_next
    from symhyb.fleet.looking_next import worth_looking
    from symhyb.tasks.outcome import read_outcomes

    outcomes = read_outcomes(directory)
    found = worth_looking(outcomes, unit, listed(over), listed(among), structure)
    if as_json:
        print_json([asdict(one) for one in found[:most]])
        return
    print_next(found, most)
