"""The verbs of the command line for public recordings: ``symhyb data list | show | fetch``."""

import sys
from dataclasses import asdict
from typing import Annotated

import typer

from symhyb.cli.options import Json, print_json

data = typer.Typer(
    help="Public recordings that symhyb knows by name.", no_args_is_help=True, rich_markup_mode=None
)


@data.command("list")
def data_list(as_json: Json = False) -> None:
    """List the known recordings, and which are already here.

    \b
    Example:
      symhyb data list
    """
    from symhyb.data.catalogue import DATASETS
    from symhyb.data.datasets import listing

    if as_json:
        print_json([asdict(known) for known in DATASETS])
    else:
        print(listing())


@data.command("show")
def data_show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a public recording.")],
) -> None:
    """Say what a recording holds and where it comes from.

    \b
    Example:
      symhyb data show emps
    """
    from symhyb.console.recordings import dataset_of, print_dataset

    print_dataset(dataset_of(name))


@data.command("fetch")
def data_fetch(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of a recording, or NAME/FILE.")],
) -> None:
    """Get the files of a recording and print where they are.

    Nothing is fetched that is already here; every file must have the known SHA-256.

    \b
    Example:
      symhyb data fetch emps/DATA_EMPS.mat
    """
    from symhyb.console.recordings import dataset_of
    from symhyb.data.datasets import fetch

    dataset, _, file = name.partition("/")
    known = dataset_of(dataset)
    for wanted in [file] if file else [one.name for one in known.files]:
        print(fetch(known, wanted, progress=sys.stderr.isatty()))
