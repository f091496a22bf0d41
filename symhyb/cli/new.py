"""The verbs of the command line that begin with a machine: ``symhyb new | draw``.

Heavy modules are imported inside, so that help answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from symhyb.cli.options import Force, ModelFile, listed


def new(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="Model file to write.")
    ] = Path("model.toml"),
    template: Annotated[
        str, typer.Option(metavar="NAME", help="What to begin with; see --list.")
    ] = "",
    coordinate: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME [UNIT]",
            help="Begin with bodies in a line instead, one a coordinate: 'x [m]'. Repeat it.",
        ),
    ] = None,
    recording: Annotated[
        Path | None,
        typer.Option("--from", metavar="RECORDING", help="Its columns become sensors and inputs."),
    ] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN=WHAT",
            help="What a column is: what it measures and its unit (\"acc=x'' [m/s^2]\"), an input"
            " ('u=input f'), or nothing ('temp=-'). Repeat it.",
        ),
    ] = None,
    number: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=NUMBER", help="A parameter, as k=1200±50. Repeat it."),
    ] = None,
    title: Annotated[str, typer.Option(metavar="TEXT", help="Title of the model.")] = "",
    ask: Annotated[
        bool | None,
        typer.Option(
            "--ask/--no-ask",
            show_default=False,
            help="Ask for what no option says, or guess it; default: ask in a terminal.",
        ),
    ] = None,
    which: Annotated[bool, typer.Option("--list", help="List the templates and end.")] = False,
    force: Force = False,
) -> None:
    """Write a first model file, from questions, options and a recording.

    What nobody states is guessed, and the file says so in a comment on the same line. It passes
    'symhyb check'.

    \b
    Example:
      symhyb new --template oscillator --from studies/oscillator/train.csv \\
          --set m=1 --set k=0 -o first.toml
    """
    from symhyb.console.asking import asked, confirmed
    from symhyb.drafting.deliver import Order, drafted, write_draft
    from symhyb.drafting.templates import TEMPLATES, summary
    from symhyb.drafting.written import read_numbers
    from symhyb.writing import require_new

    if which:
        print(*(f"{name:<12} {summary(name)}" for name in TEMPLATES), sep="\n")
        return
    require_new(output, force)
    numbers = tuple(read_numbers(number or ()).items())
    order = Order(template, tuple(coordinate or ()), title, numbers, tuple(column or ()), recording)
    asking = sys.stdin.isatty() if ask is None else ask
    done = drafted(asked(order) if asking else order, confirmed if asking else None, str(output))
    write_draft(done, output)
    guesses = f"{done.guesses} guesses in it are marked" if done.guesses else "nothing is guessed"
    print(f"{output}: {done.model.title}; {guesses}")
    options = "".join(f" {one}" for one in done.maps)
    after = f"symhyb compare {output} RECORDING{options}" if done.maps else f"symhyb draw {output}"
    print(f"next: symhyb check {output}; {after}")


def draw(
    model: ModelFile,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="Picture to write, .svg or .png; default: named as the model, .svg.",
        ),
    ] = None,
    show: Annotated[
        list[str] | None,
        typer.Option(metavar="NAMES", help="Draw these red: elements, bodies. Repeat it."),
    ] = None,
    force: Force = False,
) -> None:
    """Draw the machine of a model file, as it stands at its start.

    Bodies, what links and holds them, elements where they act, and an arrow where each coordinate
    is positive. In space it is seen from the side and above.

    \b
    Example:
      symhyb draw models/cartpole.toml -o machine.svg
    """
    from symhyb.drawing import draw_model
    from symhyb.looking import require_picture

    target = output or Path(f"{model.stem}.svg")
    require_picture(target, force)
    left_out = draw_model(model, target, listed(show))
    print(f"{target}: written")
    for sentence in left_out:
        print(f"note: {sentence}", file=sys.stderr)
