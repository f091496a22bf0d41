"""The verb ``symhyb learn``: arguments parsed, an order carried out, what came of it printed.

Heavy modules are imported inside, so that help answers at once.
"""

from enum import StrEnum
from typing import Annotated

import typer

from symhyb.cli.options import (
    End,
    Folder,
    Holdout,
    Json,
    Known,
    Map,
    ModelFile,
    Recordings,
    Start,
    print_json,
)


class By(StrEnum):
    """The two ways of learning."""

    sparse = "sparse"
    network = "network"


class Level(StrEnum):
    """What is learned."""

    force = "force"
    rates = "rates"


class LibraryName(StrEnum):
    """The libraries of candidate terms."""

    laws = "laws"
    polynomial = "polynomial"


class OptimizerName(StrEnum):
    """The optimisers of PySINDy that are offered."""

    stlsq = "stlsq"
    sr3 = "sr3"
    ssr = "ssr"


def learn(
    model: ModelFile,
    recordings: Recordings,
    by: Annotated[
        By,
        typer.Option("--by", metavar="WAY", help="'sparse' for terms of a law, or 'network'."),
    ],
    output: Folder,
    formulation: Annotated[
        Level,
        typer.Option(
            "--formulation",
            metavar="LEVEL",
            show_default=False,
            help="Learn the 'force' dF that is lacking (default), or the 'rates' dx'.",
        ),
    ] = Level.force,
    holdout: Holdout = None,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    known: Known = None,
    on: Annotated[
        list[str] | None,
        typer.Option(metavar="COORDINATE", help="Where to learn; default: everywhere. Repeat it."),
    ] = None,
    library: Annotated[
        LibraryName,
        typer.Option(
            metavar="NAME",
            show_default=False,
            help="Candidate terms: 'laws' (default) or 'polynomial'.",
        ),
    ] = LibraryName.laws,
    degree: Annotated[int, typer.Option(metavar="N", help="Highest of a candidate term.")] = 3,
    optimizer: Annotated[
        OptimizerName,
        typer.Option(
            metavar="NAME",
            show_default=False,
            help="Of PySINDy: 'stlsq' (default), 'sr3' or 'ssr'.",
        ),
    ] = OptimizerName.stlsq,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--sees",
            metavar="NAME",
            help="What a network sees: x, x', an input or t; default: what moves where it acts."
            " Repeat it.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Of the first weights of a network.")] = 0,
    beside: Annotated[
        bool, typer.Option("--beside", help="Diagnose the same recordings, and report both.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Learn what a model leaves out, by sparse regression or by a network.

    Leaves corrected.toml, report.html, simulation.csv and learned.json in DIR. The parameters of
    the model are held. To weigh all named causes against each other is what diagnose does.

    Exit status: 0 something was learned, 1 nothing was, 2 misuse or unreadable input, 3 the
    numerics failed.

    \b
    Example:
      symhyb learn models/oscillator.toml studies/oscillator/train.csv --by sparse \\
          --holdout studies/oscillator/holdout.csv -o out
    """
    from symhyb.console.results import print_learned
    from symhyb.console.terminal import progress
    from symhyb.data.columns import read_map
    from symhyb.learned_run import Order, carry_out_order, leave_learned
    from symhyb.study.file import Study
    from symhyb.study.sources import Source
    from symhyb.writing import require_folder

    study = Study(
        model,
        tuple(Source(path, span=(start, end)) for path in recordings),
        tuple(Source(path) for path in holdout or ()),
        read_map(columns),
        known=known,
    )
    options = {
        "by": by.value,
        "formulation": formulation.value,
        "on": tuple(on or ()),
        "library": library.value,
        "degree": degree,
        "optimizer": optimizer.value,
        "inputs": tuple(inputs or ()),
        "seed": seed,
    }
    require_folder(output)
    with progress() as say:
        outcome = carry_out_order(Order(study, options, beside), say)
        say("writing the report")
        leave_learned(outcome, output)
    if as_json:
        print_json(outcome.content())
    else:
        print_learned(outcome, output)
    raise typer.Exit(0 if outcome.learned.something else 1)
