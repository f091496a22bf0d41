"""The verb `symhyb export`: arguments parsed, an order carried out, what it is printed.

Heavy modules are imported inside, so that help answers at once.
"""

from pathlib import Path
from typing import Annotated

import typer


def export(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="Model file.")],
    to: Annotated[
        str,
        typer.Option(
            "--to",
            metavar="FORM",
            help="One of fmu, c, casadi, adams, simulink, curve, latex, urdf, mjcf, monitor.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="File; for c, adams, simulink, curve and monitor a folder.",
        ),
    ],
    elements: Annotated[
        list[str] | None,
        typer.Option("--element", metavar="NAME", help="Element to export alone. Repeat it."),
    ] = None,
    whole: Annotated[bool, typer.Option("--whole", help="Export the whole model.")] = False,
    name: Annotated[str, typer.Option(metavar="NAME", help="Name of the C code, else OUT's.")] = "",
    fmi: Annotated[int, typer.Option(metavar="2|3", help="Version of FMI.")] = 2,
    kinds: Annotated[
        str | None,
        typer.Option(
            metavar="KINDS",
            help="cs (co-simulation), me (model exchange), or both: cs,me; default: all there are.",
        ),
    ] = None,
    platforms: Annotated[
        str, typer.Option(metavar="NAMES", help="linux64,win64; default: all that can be compiled.")
    ] = "",
    robot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="For urdf and mjcf: the robot's own file."),
    ] = None,
    stretch: Annotated[
        str, typer.Option(metavar="LOW:HIGH", help="For curve: the range of stretches, in SI.")
    ] = "",
    rate: Annotated[
        str, typer.Option(metavar="LOW:HIGH", help="For curve: the range of rates, in SI.")
    ] = "",
    events: Annotated[
        bool,
        typer.Option(
            "--events",
            help="Model exchange with event indicators: the importer locates where friction turns, "
            "stops touch and sign(...) jumps.",
        ),
    ] = False,
    recording: Annotated[
        str,
        typer.Option(metavar="FILE", help="For monitor: a recording of the machine as it is."),
    ] = "",
    columns: Annotated[
        list[str] | None,
        typer.Option(
            "--map",
            metavar="CHANNEL=COLUMN",
            help="For monitor: where a channel stands in the recording. Repeat it.",
        ),
    ] = None,
    false_alarms: Annotated[
        float,
        typer.Option(
            metavar="N", min=1e-6, max=1e4, help="For monitor: false alarms a day that are allowed."
        ),
    ] = 1.0,
) -> None:
    """Write a correction, or a whole model, for another program.

    By default the elements that a diagnosis found, as a force element: coordinates and speeds in,
    +dF out, which the host adds to its applied forces. With --whole the inputs of the model in, its
    sensors and coordinates out. Everything is in SI. To urdf and mjcf: a copy of the robot's own
    file with the damping, friction and rotor inertia that the model has in its joints and the
    masses of its bodies. To curve: tables of the force over stretch or rate, a file for each place.
    To monitor: what symhyb watch does as C code, for a target without Python.

    \b
    Examples:
      symhyb export out/corrected.toml --to fmu -o correction.fmu
      symhyb export out/corrected.toml --to curve --rate -0.5:0.5 -o tables
      symhyb export out/corrected.toml --to urdf --robot arm.urdf -o arm-corrected.urdf
      symhyb export out/corrected.toml --to monitor --recording good.csv -o monitor
    """
    from symhyb.data.columns import read_map
    from symhyb.export.curve_table import span_of
    from symhyb.export.deliver import Order, deliver
    from symhyb.model.read import read_model

    targets = tuple(one for one in platforms.split(",") if one)
    chosen = None if kinds is None else tuple(one for one in kinds.split(",") if one)
    asked = {"stretch": stretch, "rate": rate}
    spans = {over: span_of(over, text) for over, text in asked.items() if text}
    named = tuple(elements or ())
    order = Order(
        to,
        named,
        whole,
        name,
        fmi,
        chosen,
        targets,
        events,
        robot,
        spans,
        recording,
        read_map(columns),
        false_alarms,
    )
    print(*deliver(read_model(model), order, output), sep="\n")
