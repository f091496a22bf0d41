"""The verbs of the command line for recordings: ``symhyb look | compare | scan | fit``.

Heavy modules are imported inside, so that help answers at once.
"""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from symhyb.cli.options import (
    End,
    Force,
    Holdout,
    Json,
    Known,
    Map,
    ModelFile,
    Recordings,
    Start,
    listed,
    print_json,
)


def look(
    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING", help="Recording, FILE#PART of one, or FILE+FILE of two loggers."
        ),
    ],
    model: Annotated[
        Path | None,
        typer.Option(metavar="MODEL", help="Model file: look at what it takes, and check that."),
    ] = None,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    known: Known = None,
    figure: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw all channels over time, as .svg or .png."),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say what is in a recording: rates, gaps, ranges, noise, rest, frequencies.

    Without a model every column is shown in the unit of the file; the time is the column t, or one
    called as time usually is, or what --map says (t=index/1000). With a model its channels are
    shown in their units, with the first checks that compare makes.

    \b
    Example:
      symhyb look studies/oscillator/train.csv --figure train.svg
    """
    from symhyb.console.look import look_facts, print_look
    from symhyb.console.terminal import progress
    from symhyb.data.columns import read_map
    from symhyb.looking import look_into, require_picture, write_picture

    if figure is not None:
        require_picture(figure, force)
    with progress() as say:
        seen = look_into(recording, model, read_map(columns), (start, end), say, known)
    if figure is not None:
        write_picture(seen.look, figure)
    if as_json:
        print_json(look_facts(seen))
    else:
        print_look(seen)


def compare(
    model: ModelFile,
    recordings: Recordings,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    known: Known = None,
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
    from symhyb.console.terminal import progress
    from symhyb.data.columns import read_map
    from symhyb.data.known_table import table_of_known, values_in
    from symhyb.data.recording import read_recording
    from symhyb.discrepancy.checks.first_checks import FirstChecks, first_checks, repeats_of
    from symhyb.discrepancy.recorded.residual import compare as compare_recording
    from symhyb.model.read import read_model
    from symhyb.numeric.lowered.machine import build
    from symhyb.steps import Counted

    declared, mapped = read_model(model), read_map(columns)
    machine = build(declared) if declared.engine is None else None
    gaps, checked = [], list[FirstChecks | None]()
    table, span = table_of_known(known, declared), (start, end)
    read = [
        read_recording(one, declared, mapped, span=span, parameters=values_in(table, one))
        for one in recordings
    ]
    with progress() as say:
        for done, recording in enumerate(read):
            say(Counted(f"comparing {recording.name}", done, len(read)))
            gaps.append(compare_recording(machine or declared, recording))
            if machine is None:  # it states no energies and no place of rest
                checked.append(None)
                continue
            say(Counted(f"first checks of {recording.name}", done, len(read)))
            checked.append(first_checks(machine, recording, gaps[-1].motion))
    repeats = repeats_of(declared, read, [gap.motion for gap in gaps])
    pairs = list(zip(gaps, checked, strict=True))
    if as_json:
        facts = [
            {**discrepancy_facts(gap), **({"first_checks": check_facts(one)} if one else {})}
            for gap, one in pairs
        ]
        print_json({"recordings": facts, "repeats": [asdict(one) for one in repeats]})
        return
    for gap, one in pairs:
        print(gap.summary())
        if one is not None:
            print_first_checks(one)
    print(*(one.sentence for one in repeats), sep="\n", end="\n" if repeats else "")


def scan(
    model: ModelFile,
    recording: Annotated[
        Path,
        typer.Argument(
            metavar="RECORDING", help="A .parquet, .csv, .mf4, .mdf or a bag of any size."
        ),
    ],
    columns: Map = None,
    start: Start = None,
    end: End = None,
    stretches: Annotated[
        int, typer.Option(metavar="N", help="Sum over at most so many stretches of time.", min=1)
    ] = 100,
    table: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="Write what each stretch shows as CSV."),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Pass along a recording larger than memory: when a model lacks what.

    The force that the model lacks is summed by stretches of time, and least squares of forces
    proposes laws for the whole. It says which stretches are unlike the others: those to diagnose.

    \b
    Example:
      symhyb scan models/oscillator.toml studies/oscillator/train.csv
    """
    from symhyb.console.scanned import print_scan, scan_facts, scan_table
    from symhyb.console.terminal import progress
    from symhyb.data.columns import read_map
    from symhyb.model.read import read_model
    from symhyb.scanning import scan as scan_along
    from symhyb.writing import require_new, write_file

    require_new(table, force)
    declared, mapped = read_model(model), read_map(columns)
    with progress() as say:
        found = scan_along(
            declared, recording, mapped, span=(start, end), stretches=stretches, say=say
        )
    if table is not None:
        write_file(table, scan_table(found))
    if as_json:
        print_json(scan_facts(found))
    else:
        print_scan(found, str(model))


def fit(
    model: ModelFile,
    recordings: Recordings,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Model file to write."),
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAMES",
            help="Fit these, as k,d or laser.gain, instead of all that state an sd. Repeat it.",
        ),
    ] = None,
    holdout: Holdout = None,
    columns: Map = None,
    start: Start = None,
    end: End = None,
    known: Known = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit parameters of a model to recordings; look for no cause.

    Errors of the simulation over windows are minimised. A stated sd counts as evidence; what is
    fitted keeps its old value under 'was'. Finding what a model leaves out is what diagnose does.

    Exit status: 0 fitted, 2 misuse or unreadable input, 3 the numerics failed.

    \b
    Example:
      symhyb fit models/oscillator.toml studies/oscillator/train.csv --free c -o fitted.toml
    """
    from symhyb.console.fitted import fit_facts, print_fit
    from symhyb.console.terminal import progress
    from symhyb.data.columns import read_map
    from symhyb.fitted_run import fit_study
    from symhyb.model.write import write_model
    from symhyb.report.contract import scores_json
    from symhyb.study.file import Study
    from symhyb.study.sources import Source
    from symhyb.writing import require_new

    require_new(output, force)
    study = Study(
        model,
        tuple(Source(path, span=(start, end)) for path in recordings),
        tuple(Source(path) for path in holdout or ()),
        read_map(columns),
        known=known,
    )
    with progress() as say:
        done = fit_study(study, listed(free), say)
    if output is not None:
        write_model(done.fitted.model, output)
    if as_json:
        print_json({**fit_facts(done.fitted), "scores": scores_json(done.verdict)})
        return
    print_fit(done.fitted, done.verdict, done.model)
    if output is not None:
        print(f"{output}: the model with these values; next: symhyb diff {model} {output}")
