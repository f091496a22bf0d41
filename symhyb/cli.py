"""The command line: verbs that parse arguments, print, and end with an exit status.

Heavy modules are imported inside the verb that needs them, so that help answers at once.
Exit status: 0 nothing missing, 1 any other verdict, 2 misuse or unreadable input, 3 the numerics
failed, 130 interrupted.
"""

import os
import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from symhyb import __version__
from symhyb.cli_data import data
from symhyb.cli_doctor import doctor
from symhyb.cli_fleet import fleet, next_
from symhyb.cli_learn import learn
from symhyb.cli_model import check, diff, equations, simulate
from symhyb.cli_new import draw, new
from symhyb.cli_options import (
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
from symhyb.cli_recording import compare, fit, look, scan
from symhyb.cli_study import compare_studies, results, run
from symhyb.cli_view import view
from symhyb.cli_watch import watch
from symhyb.export.verb import export
from symhyb.imports.verb import import_
from symhyb.interruption import is_interruption, listen

# Of the linear algebra, before NumPy is loaded: problems are small, and threads that wait for each
# other cost more than they bring.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

app = typer.Typer(
    name="symhyb",
    epilog="Each verb has its own page: symhyb diagnose --help",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(data, name="data")


def _version(wanted: bool) -> None:
    if wanted:
        print(f"symhyb {__version__}")
        raise typer.Exit


@app.callback()
def everywhere(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Find the physics that a model of a machine leaves out, from a recording of the machine."""


for verb in (new, check, draw, equations, diff, simulate, look, compare, scan, fit):
    app.command()(verb)


@app.command()
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
    from symhyb.study import StudyResult, carry_out, leave_files
    from symhyb.study_file import Study
    from symhyb.study_sources import Source
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


app.command()(run)
app.command()(results)
app.command("compare-studies")(compare_studies)
app.command()(fleet)
app.command("next")(next_)
app.command()(learn)
app.command()(export)
app.command("import")(import_)
app.command()(view)
app.command()(watch)
app.command()(doctor)


def main() -> NoReturn:
    """Run the command line and end the process with its exit status."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a pipe may not know every letter of a sentence
            stream.reconfigure(errors="replace")
    listen()
    for name in _THREADS:
        os.environ.setdefault(name, "1")
    try:
        app(prog_name="symhyb")
        status = 0
    except SystemExit as stop:
        status = stop.code if isinstance(stop.code, int) else 0
    except (Exception, KeyboardInterrupt) as error:
        status = 130 if is_interruption(error) else _failed(error)
    if status == 130:
        _complain("interrupted; nothing more was written")
    sys.exit(status)


def _failed(error: BaseException) -> int:
    """Say what an error is about, and return the exit status."""
    from symhyb.fault import error_sentences

    status, sentences = error_sentences(error)
    _complain(*sentences)
    return status


def _complain(*sentences: str) -> None:
    for sentence in sentences:
        print(sentence, file=sys.stderr)
