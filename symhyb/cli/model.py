"""The verbs of the command line for a model alone: ``symhyb check | equations | diff | simulate``.

Heavy modules are imported inside, so that help answers at once.
"""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from symhyb.cli.options import Json, Known, Map, ModelFile, print_json
from symhyb.errors import InputError


def check(model: ModelFile, as_json: Json = False) -> None:
    """Check a model file and say what it declares.

    Every problem is reported at once, as file:line: name: what is wrong; did you mean ...?

    \b
    Example:
      symhyb check models/emps.toml
    """
    from symhyb.console.model import model_facts, print_model
    from symhyb.console.terminal import progress
    from symhyb.model.bare import bare
    from symhyb.model.read import read_model
    from symhyb.numeric.lowered.machine import build

    try:
        declared = read_model(model)
        with progress() as say:
            say("deriving the equations")
            build(bare(declared))
    except InputError as error:
        if as_json:
            print_json({"ok": False, "problems": [asdict(one) for one in error.problems]})
        raise
    if as_json:
        print_json({"ok": True, "problems": [], **model_facts(declared)})
    else:
        print_model(declared)


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


def simulate(
    model: ModelFile,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="CSV to write.")],
    inputs: Annotated[
        Path | None,
        typer.Option("--input", metavar="RECORDING", help="Recording that holds the inputs."),
    ] = None,
    columns: Map = None,
    known: Known = None,
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
    from symhyb.console.terminal import leave_run, progress, require_files, warn
    from symhyb.data.columns import read_map
    from symhyb.model.read import read_model
    from symhyb.model.switching import left_smooth
    from symhyb.simulation import read_inputs, run_model

    exact = exact or events is not None
    declared, mapped = read_model(model), read_map(columns)
    require_files(output, events)
    driven = read_inputs(inputs, declared, mapped, known) if inputs else None
    warn(driven.notes if driven else ())
    warn(left_smooth(declared) if exact else ())
    with progress() as say:
        say("simulating")
        done = run_model(declared, driven, end, step, exact)
    leave_run(*done, output, events, exact)
