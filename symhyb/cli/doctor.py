"""The verb ``symhyb doctor``: is this installation in order?

Heavy modules are imported inside, so that help answers at once.
"""

import typer

from symhyb.cli.options import Json, print_json


def doctor(as_json: Json = False) -> None:
    """Say whether this installation works, and what it lacks.

    Versions, the C compiler, what extras would add and the line that installs them, the cache,
    processors, and a run of a few seconds whose answer is known.

    Exit status: 0 it works, 1 something that is needed is broken.

    \b
    Example:
      symhyb doctor
    """
    from symhyb.console.doctor import doctor_facts, findings, healthy, print_finding

    found = []
    for one in findings():
        found.append(one)
        if not as_json:
            print_finding(one)
    if as_json:
        print_json(doctor_facts(found))
    elif not healthy(found):
        print("Something that is needed is broken; see above.")
    raise typer.Exit(0 if healthy(found) else 1)
