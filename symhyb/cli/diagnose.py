"""The verb that finds what a model leaves out.

Heavy modules are imported inside, so that help answers at once.
"""

from pathlib import Path
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


def diagnose(
    model: ModelFile,
    recordings: Recordings,
    output: Folder,
    holdout: Holdout = None,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    known: Known = None,
    own: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="What every recording has its own value of, all else being shared: a parameter of"
            " the model ('m') or a key of a law ('drag'); 'drag=mount' shares it within the groups"
            " of a column of --groups. Repeat it.",
        ),
    ] = None,
    groups: Annotated[
        Path | None,
        typer.Option(
            metavar="TABLE",
            help="Groups of recordings: CSV with a column 'recording' and one for each grouping.",
        ),
    ] = None,
    finish: Annotated[
        bool,
        typer.Option(
            "--finish",
            help="Fit all uncertain numbers once more, at the end.",
        ),
    ] = False,
    remainder: Annotated[
        str | None,
        typer.Option(
            metavar="COORDINATE", help="Add a smooth force for what the named laws leave there."
        ),
    ] = None,
    network: Annotated[
        str | None,
        typer.Option(
            metavar="COORDINATE",
            help="Train a network for what the named laws leave there; its weights are left beside"
            " corrected.toml.",
        ),
    ] = None,
    budget: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Time after which it ends, as 90s, 10min or 2h."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Find the physics that a model leaves out.

    Leaves corrected.toml, report.html, simulation.csv and diagnosis.json in DIR. --start and --end
    cut the recordings, not the unseen ones; a study file cuts each one by itself.

    Exit status: 0 nothing is missing, 1 any other verdict, 2 misuse or unreadable input, 3 the
    numerics failed.

    \b
    Example:
      symhyb diagnose models/oscillator.toml studies/oscillator/train.csv \\
          --holdout studies/oscillator/holdout.csv -o out
    """
    from symhyb.console.results import print_result, printed_if_interrupted
    from symhyb.console.terminal import progress
    from symhyb.data.columns import read_map
    from symhyb.data.groups import by_name
    from symhyb.deadline import required_seconds
    from symhyb.report.contract import to_json
    from symhyb.study.file import Study
    from symhyb.study.run import StudyResult, carry_out, leave_files
    from symhyb.study.sources import Source
    from symhyb.writing import require_folder

    study = Study(
        model,
        tuple(Source(path, span=(start, end)) for path in recordings),
        tuple(Source(path) for path in holdout or ()),
        read_map(columns),
        own=by_name(dict(_grouping(name) for name in own or ())),
        last_values=finish,
        remainder=remainder,
        network=network,
        known=known,
        groups=groups,
        budget_s=None if budget is None else required_seconds(budget),
    )
    require_folder(output)
    with printed_if_interrupted(output, as_json) as keep, progress() as say:

        def leave(result: StudyResult) -> None:
            leave_files(result, output)
            keep(result)

        result = carry_out(study, say, leave)
    if as_json:
        print_json(to_json(result.diagnosis, result.verdict))
    else:
        print_result(result, output)
    raise typer.Exit(result.exit_status)


def _grouping(text: str) -> tuple[str, str]:
    """The name and the grouping of an entry of --own."""
    name, _, by = text.partition("=")
    return name.strip(), by.strip()
