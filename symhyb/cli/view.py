"""The verb ``symhyb view``: a workbench in the browser, on this computer alone.

Heavy modules are imported inside, so that help answers at once.
"""

from pathlib import Path
from typing import Annotated

import typer

from symhyb.cli.options import Map


def view(
    given: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR|MODEL RECORDING…",
            help="Folders of results, or a model file and its recordings.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Where diagnoses leave numbered folders."
        ),
    ] = Path("view-results"),
    columns: Map = None,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")
    ] = 0,
    show: Annotated[bool, typer.Option("--open", help="Open it in the browser.")] = False,
) -> None:
    """Look at a model, its recordings and results in a browser.

    Prints the address of a page on this computer (127.0.0.1), with a secret that it needs; nothing
    leaves the computer. Of a model and recordings: columns, spectra, simulation against recording
    with elements to switch and parameters to move, the missing force, and diagnoses. Of folders
    that diagnose left, or that hold such folders: the results, one or two side by side. Ctrl-C ends
    it.

    \b
    Example:
      symhyb view models/oscillator.toml studies/oscillator/train.csv
    """
    import webbrowser

    from symhyb.data.columns import read_map
    from symhyb.workbench.bench import open_bench
    from symhyb.workbench.results import result_folders
    from symhyb.workbench.serving import Workbench
    from symhyb.workbench.shared import Shared

    mapped = read_map(columns)
    if all(path.is_dir() for path in given):
        shared = Shared(None, result_folders(given), output)
    else:
        shared = Shared(open_bench(given[0], given[1:], mapped), (), output)
    workbench = Workbench(shared, port)

    def begun() -> None:
        print(f"{workbench.address}\nCtrl-C ends it", flush=True)
        if show:
            webbrowser.open(workbench.address)

    workbench.serve(begun)
