"""Arguments and options that several verbs of the command line share."""

import json
from collections.abc import Sequence
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
Known = Annotated[
    Path | None,
    typer.Option(
        metavar="TABLE",
        help="Known values of parameters in each recording: CSV with a column 'recording' and one"
        " for each parameter ('m [kg]').",
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
Force = Annotated[bool, typer.Option("--force", help="Replace a file that is there.")]
Folder = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for the files; made if new.")
]


def listed(options: Sequence[str] | None) -> tuple[str, ...]:
    """The names of an option that is repeated, or lists them as ``a,b``."""
    parts = (part.strip() for text in options or () for part in text.split(","))
    return tuple(part for part in parts if part)


def print_json(content: Any) -> None:
    """Print what a script asked for; a number that is not finite is a fault."""
    print(json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))
