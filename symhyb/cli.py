"""The command line: verbs that parse arguments, print, and end with an exit status.

Heavy modules are imported inside the verb that needs them, so that help answers at once.
Exit status: 0 nothing missing, 1 any other verdict, 2 misuse or unreadable input, 3 the numerics
failed, 130 interrupted.
"""

import os
import sys
from dataclasses import asdict
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from symhyb.cli_data import data
from symhyb.cli_learn import learn
from symhyb.cli_options import (
    End,
    Folder,
    Holdout,
    Json,
    Map,
    ModelFile,
    Recordings,
    Start,
    print_json,
)
from symhyb.errors import InputError, NumericsError, visible
from symhyb.export.verb import export
from symhyb.imports.verb import import_
from symhyb.interruption import is_interruption, listen

# Of the linear algebra, before NumPy is loaded: problems are small, and threads that wait for each
# other cost more than they bring.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

app = typer.Typer(
    name="symhyb",
    help="Find the physics that a model of a machine leaves out, from a recording of the machine.",
    epilog="Each verb has its own page: symhyb diagnose --help",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.add_typer(data, name="data")


@app.command()
def check(model: ModelFile, as_json: Json = False) -> None:
    """Check a model file and say what it declares.

    Every problem is reported at once, as file:line: name: what is wrong; did you mean ...?

    \b
    Example:
      symhyb check models/emps.toml
    """
    from symhyb.console.model import model_facts, print_model
    from symhyb.console.terminal import progress
    from symhyb.model.read import read_model
    from symhyb.numeric.lowered.machine import build

    try:
        declared = read_model(model)
        with progress() as say:
            say("deriving the equations")
            build(declared)
    except InputError as error:
        if as_json:
            print_json({"ok": False, "problems": [asdict(one) for one in error.problems]})
        raise
    if as_json:
        print_json({"ok": True, "problems": [], **model_facts(declared)})
    else:
        print_model(declared)


@app.command()
def equations(
    model: ModelFile,
    latex: Annotated[bool, typer.Option("--latex", help="Write LaTeX.")] = False,
    matrices: Annotated[
        bool, typer.Option("--matrices", help="Print M, k_c and k_e entry by entry, summed up.")
    ] = False,
) -> None:
    """Print the equations of motion of a model.

    M q'' + k_c = k_e: one block for each coordinate, with one row for each body and element. Then
    the rates of inner states, names for what several rows use, parameters and sensors.

    \b
    Example:
      symhyb equations models/pendulum.toml --latex
    """
    from symhyb.mechanics.show import show_equations
    from symhyb.model.read import read_model

    print(show_equations(read_model(model), latex, matrices), end="")


@app.command()
def simulate(
    model: ModelFile,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="CSV to write.")],
    inputs: Annotated[
        Path | None,
        typer.Option("--input", metavar="RECORDING", help="Recording that holds the inputs."),
    ] = None,
    columns: Map = None,
    end: Annotated[float | None, typer.Option(metavar="S", help="Time to stop at, in s.")] = None,
    step: Annotated[float | None, typer.Option(metavar="S", help="Between two rows, in s.")] = None,
    exact: Annotated[
        bool, typer.Option("--exact", help="Friction sticks and stops touch, as located events.")
    ] = False,
    events: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV for the events; this too makes the run exact."),
    ] = None,
) -> None:
    """Simulate a model and write what its sensors record.

    The run begins as the model declares. Without --input all inputs are zero and --end is needed;
    with it the run covers the recording. Dry friction is smoothed, and creeps where the machine
    sticks, unless the run is --exact.

    \b
    Example:
      symhyb simulate models/oscillator.toml -o run.csv \\
          --input studies/oscillator/train.csv
    """
    from symhyb.console.terminal import leave_run, progress, read_map, require_files, warn
    from symhyb.model.read import read_model
    from symhyb.model.switching import left_smooth
    from symhyb.simulation import read_inputs, run_model

    exact = exact or events is not None
    declared, mapped = read_model(model), read_map(columns)
    require_files(output, events)
    driven = read_inputs(inputs, declared, mapped) if inputs else None
    warn(driven.notes if driven else ())
    warn(left_smooth(declared) if exact else ())
    with progress() as say:
        say("simulating")
        done = run_model(declared, driven, end, step, exact)
    leave_run(*done, output, events, exact)


@app.command()
def compare(
    model: ModelFile,
    recordings: Recordings,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    as_json: Json = False,
) -> None:
    """Say how large the force is that a model lacks, and what the first checks show.

    That force is dF = M q'' + k_c - k_e along the recorded motion; it is given beside its noise.
    First checks: sample rates and delays, rest position, modes, frequency responses, energy
    balance, repeated runs. Naming a cause is what diagnose does.

    \b
    Example:
      symhyb compare models/oscillator.toml studies/oscillator/train.csv
    """
    from symhyb.console.comparison import check_facts, discrepancy_facts, print_first_checks
    from symhyb.console.terminal import progress, read_map
    from symhyb.data.recording import read_recording
    from symhyb.discrepancy.checks.first_checks import first_checks, repeats_of
    from symhyb.discrepancy.recorded.residual import compare as compare_recording
    from symhyb.model.read import read_model
    from symhyb.numeric.lowered.machine import build
    from symhyb.steps import Counted

    declared, mapped = read_model(model), read_map(columns)
    machine, gaps, checked = build(declared), [], []
    read = [read_recording(one, declared, mapped, span=(start, end)) for one in recordings]
    with progress() as say:
        for done, recording in enumerate(read):
            say(Counted(f"comparing {recording.name}", done, len(read)))
            gaps.append(compare_recording(machine, recording))
            say(Counted(f"first checks of {recording.name}", done, len(read)))
            checked.append(first_checks(machine, recording, gaps[-1].motion))
    repeats = repeats_of(declared, read, [gap.motion for gap in gaps])
    pairs = list(zip(gaps, checked, strict=True))
    if as_json:
        facts = [{**discrepancy_facts(gap), "first_checks": check_facts(one)} for gap, one in pairs]
        print_json({"recordings": facts, "repeats": [asdict(one) for one in repeats]})
        return
    for gap, one in pairs:
        print(gap.summary())
        print_first_checks(one)
    print(*(one.sentence for one in repeats), sep="\n", end="\n" if repeats else "")


@app.command()
def diagnose(
    model: ModelFile,
    recordings: Recordings,
    output: Folder,
    holdout: Holdout = None,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    own: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="What every recording has its own value of, all else being shared: a parameter of"
            " the model ('m') or a key of a law ('drag'). Repeat it.",
        ),
    ] = None,
    finish: Annotated[
        bool,
        typer.Option(
            "--finish",
            help="Fit every uncertain number of the corrected model once more, on all recordings.",
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
    from symhyb.console.results import print_result
    from symhyb.console.terminal import progress, read_map
    from symhyb.report.contract import to_json
    from symhyb.study import carry_out, leave_files
    from symhyb.study_file import Source, Study
    from symhyb.writing import require_folder

    study = Study(
        model,
        tuple(Source(path, span=(start, end)) for path in recordings),
        tuple(Source(path) for path in holdout or ()),
        read_map(columns),
        own=tuple(own or ()),
        last_values=finish,
        remainder=remainder,
        network=network,
    )
    require_folder(output)
    with progress() as say:
        result = carry_out(study, say, lambda result: leave_files(result, output))
    if as_json:
        print_json(to_json(result.diagnosis, result.verdict))
    else:
        print_result(result, output)
    raise typer.Exit(result.exit_status)


@app.command()
def diff(
    first: Annotated[Path, typer.Argument(metavar="MODEL", help="Model file.")],
    second: Annotated[Path, typer.Argument(metavar="MODEL", help="Model file to compare it with.")],
) -> None:
    """Say what two model files say differently.

    In sentences first, then line by line.

    \b
    Example:
      symhyb diff models/oscillator.toml out/corrected.toml
    """
    from symhyb.model.diff import diff as difference
    from symhyb.model.read import read_model

    print(difference(read_model(first), read_model(second)))


@app.command()
def run(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file.")],
    output: Folder,
    within: Annotated[
        list[Path] | None,
        typer.Option(metavar="FOLDER", help="Folder that the study may name files of. Repeat it."),
    ] = None,
) -> None:
    """Run a study: a diagnosis with a manifest.

    Leaves the files of diagnose and manifest.json (hashes, versions, duration) in DIR. Where
    expected.json lies beside the study, what came out is held against it; a failed expectation
    ends with exit status 1, otherwise the status is that of the diagnosis. A study names files of
    its own folder, of its project (the nearest folder above it with .git or pyproject.toml), and
    of the folders that --within allows.

    \b
    Example:
      symhyb run studies/emps/study.toml -o out
    """
    from symhyb.console.results import print_checks, print_result
    from symhyb.console.terminal import progress
    from symhyb.study import run_study

    with progress() as say:
        result = run_study(study, output, say, within or ())
    print_result(result, output)
    if result.checks:
        print_checks(result.checks)
        failed = sum(not one.passed for one in result.checks)
        total = len(result.checks)
        print(f"{failed} of {total} expectations failed" if failed else "as expected")
    raise typer.Exit(result.exit_status)


app.command()(learn)
app.command()(export)
app.command("import")(import_)


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
    except Exception as error:
        status = 130 if is_interruption(error) else _failed(error)
    if status == 130:
        _complain("interrupted; nothing more was written")
    sys.exit(status)


def _failed(error: Exception) -> int:
    """Say what an error is about, and return the exit status."""
    match error:
        case InputError():
            _complain(*(str(problem) for problem in error.problems))
            return 2
        case NumericsError():
            _complain(f"the numerics failed: {error}")
        case _:
            said = f"{type(error).__name__}: {visible(str(error))[:300]}"
            _complain(said, _fault_sentence(error))
    return 3


def _fault_sentence(error: Exception) -> str:
    from symhyb.fault import leave_fault

    place = leave_fault(error)
    where = f"; what happened, without any of your data, is in {place}" if place else ""
    return f"this is a fault of symhyb itself{where}; please send it to its authors"


def _complain(*sentences: str) -> None:
    for sentence in sentences:
        print(sentence, file=sys.stderr)
