"""The verbs for studies: ``symhyb run``, ``symhyb results`` and ``symhyb compare-studies``.

Heavy modules are imported inside the verb that needs them, so that help answers at once.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from symhyb.cli.options import Folder

if TYPE_CHECKING:
    from symhyb.study.file import Study
    from symhyb.tasks.run import How

Left = Annotated[Path, typer.Argument(metavar="DIR", help="Folder that symhyb run left.")]


def run(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file.")],
    output: Folder,
    within: Annotated[
        list[Path] | None,
        typer.Option(metavar="FOLDER", help="Folder that the study may name files of. Repeat it."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Processes for a sweep; without it all cores."),
    ] = None,
    scheduler: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Run a sweep on this Dask scheduler.")
    ] = "",
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a sweep; what is finished is kept.")
    ] = False,
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="PATTERN", help="Tasks of a sweep that fit, as 'm=0.5*'. Repeat it."),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="List the tasks of a sweep, and run none.")
    ] = False,
) -> None:
    """Run a study: a diagnosis with a manifest, or each of its sweep.

    Leaves the files of diagnose and manifest.json in DIR. Where expected.json lies beside the
    study, what came out is held against it; a failed expectation ends with exit status 1,
    otherwise the status is that of the diagnosis. Of a sweep, the files of every task stand in
    DIR/tasks, and the status is 1 if a task failed. A study names files of its own folder, of its
    project (the nearest folder above it with .git or pyproject.toml), and of those of --within.

    \b
    Example:
      symhyb run studies/emps/study.toml -o out
    """
    from symhyb.errors import InputError, Problem
    from symhyb.study.file import read_study
    from symhyb.tasks.run import How

    how = How(workers, scheduler, resume, tuple(only or ()))
    if workers is not None and scheduler:
        text = "the scheduler has workers of its own; leave out one of both"
        raise InputError(Problem(text, "--workers"))
    read = read_study(study, within or ())
    if read.sweep is not None:
        _run_sweep(read, study, output, how, dry_run)
        return
    if how != How() or dry_run:
        text = (
            "has no [sweep], for which --workers, --scheduler, --resume, --only and --dry-run are"
        )
        raise InputError(Problem(text, file=str(study)))
    _run_one(read, output)


def _run_one(study: "Study", output: Path) -> None:
    from symhyb.console.results import print_checks, print_result, printed_if_interrupted
    from symhyb.console.terminal import progress
    from symhyb.study.run import run_read

    with printed_if_interrupted(output) as keep, progress() as say:
        result = run_read(study, output, say, keep)
    print_result(result, output)
    if result.checks:
        print_checks(result.checks)
        failed = sum(not one.passed for one in result.checks)
        total = len(result.checks)
        print(f"{failed} of {total} expectations failed" if failed else "as expected")
    raise typer.Exit(result.exit_status)


def _run_sweep(study: "Study", file: Path, output: Path, how: "How", dry_run: bool) -> None:
    from symhyb.console.tasks import print_planned, print_ran
    from symhyb.console.terminal import progress, warn
    from symhyb.interruption import is_interruption
    from symhyb.tasks.expand import chosen, tasks_of
    from symhyb.tasks.run import done_of, run_sweep

    if dry_run:
        tasks = chosen(tasks_of(study), how.only)
        print_planned(tasks, len(tasks) - done_of(tasks, output))
        return
    try:
        with progress(logged=True) as say:
            ran = run_sweep(study, output, how, say)
    except (KeyboardInterrupt, Exception) as stop:
        if is_interruption(stop):
            warn([f"what is finished is kept; go on with: symhyb run {file} -o {output} --resume"])
        raise
    print_ran(ran, output)
    raise typer.Exit(int(bool(ran.failed)))


def results(
    directory: Left,
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write the whole table as CSV.")
    ] = None,
    parquet: Annotated[
        Path | None,
        typer.Option("--parquet", metavar="FILE", help="Write the whole table as Parquet."),
    ] = None,
    times: Annotated[
        bool, typer.Option("--times", help="Add how many seconds each task took.")
    ] = False,
) -> None:
    """Show what came out of all tasks of a study.

    A row a task, in the order of the study: verdict, what was found with values and deviations,
    and in the files also probabilities of classes, scores, and why a task failed.

    \b
    Example:
      symhyb results out --csv results.csv
    """
    from symhyb.console.tasks import print_outcomes
    from symhyb.tasks.outcome import read_outcomes
    from symhyb.tasks.rows import csv_text, rows_of, write_parquet
    from symhyb.writing import write_file

    outcomes = read_outcomes(directory)
    print_outcomes(outcomes, times)
    table = rows_of(outcomes, times)
    if csv is not None:
        write_file(csv, csv_text(table))
    if parquet is not None:
        write_parquet(table, parquet)


def compare_studies(
    first: Left,
    second: Annotated[Path, typer.Argument(metavar="OTHER", help="Another such folder.")],
) -> None:
    """Show what two runs of a study say differently, task by task.

    Tasks are matched by their names: verdict, what was found, and values in deviations of their
    difference. Exit status: 0 nothing differs, 1 something does.

    \b
    Example:
      symhyb compare-studies before after
    """
    from symhyb.console.tasks import print_differences
    from symhyb.tasks.differences import differences_of
    from symhyb.tasks.outcome import read_outcomes

    differences = differences_of(read_outcomes(first), read_outcomes(second))
    print_differences(differences, first, second)
    raise typer.Exit(int(not differences.same))
