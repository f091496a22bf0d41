"""Arguments and options that several verbs of the command line share."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

ModelFile = Annotated[Path, typer.Argument(metavar="MODEL", help="Model file.")]
Recordings = Annotated[
    list[Path], typer.Argument(metavar="RECORDING", help="Recordings of the machine.")
]
Map = Annotated[
    list[str] | None,
    typer.Option(
        "--map",
        metavar="CHANNEL=COLUMN",
        help="Where a channel of the model stands in the recordings: a column, with its unit if"
        " need be ('laser=qm [mm]'), or an expression in columns ('f=gtau*vir'). Repeat it.",
    ),
]
Start = Annotated[
    float | None, typer.Option(metavar="S", help="Drop what the recordings hold before, in s.")
]
End = Annotated[
    float | None, typer.Option(metavar="S", help="Drop what the recordings hold after, in s.")
]
Holdout = Annotated[
    list[Path] | None,
    typer.Option(metavar="RECORDING", help="Unseen recording, for the proof alone. Repeat it."),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON for scripts instead of sentences.")]
Folder = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for the files; made if new.")
]


def print_json(content: Any) -> None:
    """Print what a script asked for; a number that is not finite is a fault."""
    print(json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))
