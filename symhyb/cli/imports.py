"""The verb `symhyb import`: a robot from another program as a model file.

Heavy modules are imported inside, so that help answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer


def import_(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT", help="URDF or MJCF file.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="MODEL", help="Model file to write.")
    ],
    joints: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Joints that move, as a,b,c; the others are locked."),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT=POSITION",
            help="Where a joint is locked, or starts: rad or m. Default 0, or the middle of a"
            " travel that 0 does not belong to. Repeat it.",
        ),
    ] = None,
    passive: Annotated[
        str, typer.Option(metavar="NAMES", help="Joints without a motor, as a,b,c.")
    ] = "",
    rates: Annotated[bool, typer.Option("--rates", help="Sensors of rates, too.")] = False,
    floating_base: Annotated[
        bool,
        typer.Option(
            "--floating-base/--fixed-base", help="Whether the root link moves freely in space."
        ),
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
) -> None:
    """Write a model file of a robot that another program describes.

    The file gives links, joints, masses, damping and dry friction; meshes are not needed. The model
    has a torque or force for each joint and a sensor of its position, and every number is a
    parameter. What is written otherwise than in the file is said, here and in the model.

    \b
    Example:
      symhyb import arm.urdf -o arm.toml
    """
    from symhyb.imports.deliver import Order, deliver

    def listed(text: str) -> tuple[str, ...]:
        return tuple(part.strip() for part in text.split(",") if part.strip())

    order = Order(
        None if joints is None else listed(joints),
        tuple(at or ()),
        listed(passive),
        rates,
        floating_base,
        force,
    )
    done = deliver(robot, order, output)
    for note in done.notes:
        print(f"note: {note}", file=sys.stderr)
    print(done.sentence)
