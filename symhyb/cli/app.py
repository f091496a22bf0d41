"""The command line: verbs that parse arguments, print, and end with an exit status.

Heavy modules are imported inside the verb that needs them, so that help answers at once.
Exit status: 0 nothing missing, 1 any other verdict, 2 misuse or unreadable input, 3 the numerics
failed, 130 interrupted.
"""

import os
import sys
from io import TextIOWrapper
from typing import Annotated, NoReturn

import typer

from symhyb import __version__
from symhyb.cli.data import data
from symhyb.cli.diagnose import diagnose
from symhyb.cli.doctor import doctor
from symhyb.cli.export import export
from symhyb.cli.fleet import fleet, next_
from symhyb.cli.imports import import_
from symhyb.cli.learn import learn
from symhyb.cli.model import check, diff, equations, simulate
from symhyb.cli.new import draw, new
from symhyb.cli.recording import compare, fit, look, scan
from symhyb.cli.study import compare_studies, results, run
from symhyb.cli.view import view
from symhyb.cli.watch import watch
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


for verb in (new, check, draw, equations, diff, simulate, look, compare, scan, fit, diagnose):
    app.command()(verb)


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
