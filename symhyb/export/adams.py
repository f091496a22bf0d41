"""C source of an Adams user subroutine (SFOSUB) around the exported element. Experimental.

Never compiled against Adams by us. The interface is that of the published manual: ``Sfosub`` with a
structure that holds ID and PAR, ``c_sysfnc`` for kinematics, ``c_errmes`` for errors; its header,
``slv_c_utils.h``, is the user's own and not part of what is written. An FMU is the surer way.
"""

from symhyb.errors import InputError, Problem
from symhyb.export.c_code import c_files, filled
from symhyb.export.spec import Spec


def adams_files(spec: Spec) -> dict[str, str]:
    """The plain C of the element and NAME_adams.c, which calls it.

    Raises:
        InputError: the whole model, inner states or recorded inputs, which this source cannot hold.
    """
    _require_plain(spec)
    name = spec.identifier
    exported = spec.exported
    coordinates = list(dict.fromkeys(n for kind, n in exported.inputs if kind in "qv"))
    angles = {
        c.name for c in exported.model.coordinates if c.name in coordinates and c.unit.is_angle
    }
    reads = []
    for i, (kind, coordinate) in enumerate(exported.inputs):
        which = {"q": ("DZ", "AZ"), "v": ("VZ", "WZ")}[kind][coordinate in angles]
        scale = "1.0" if coordinate in angles else "LENGTH"
        pair = 2 * coordinates.index(coordinate)
        reads.append(f'  u[{i}] = {scale} * measured(sforce, {pair}, "{which}", dflag);')
    markers = ", ".join(f"I and J marker of {coordinate}" for coordinate in coordinates)
    forces = [f"{i + 1}: {n}" for i, (kind, n) in enumerate(exported.outputs) if kind == "dF"]
    turning = [f"{int(n in angles)}" for kind, n in exported.outputs]
    values = {
        "NAME": name,
        "READS": "\n".join(reads),
        "MARKERS": markers,
        "FORCES": ", ".join(forces),
        "WHICH": str(2 * len(coordinates)),
        "TURNING": ", ".join(turning),
        "INPUTS": str(max(1, len(exported.inputs))),
        "OUTPUTS": str(len(exported.outputs)),
    }
    return {**c_files(spec), f"{name}_adams.c": filled("adams.c", values)}


def _require_plain(spec: Spec) -> None:
    exported, file = spec.exported, spec.exported.model.file
    problems = []
    if spec.whole:
        problems.append(Problem("Adams source holds force elements, not a whole model", file=file))
    for kind, name in exported.states:
        what = "is a declared state" if kind == "s" else "has an inner state"
        text = f"{what}, which the Adams source does not hold; export an FMU (--to fmu)"
        section = "states" if kind == "s" else "elements"
        problems.append(Problem(text, f"{section}.{name.partition('.')[0]}", file))
    for kind, name in exported.inputs:
        if kind == "u":
            text = "is a recorded input, which the Adams source cannot read; export an FMU"
            problems.append(Problem(text, f"inputs.{name}", file))
    if problems:
        raise InputError(list(dict.fromkeys(problems)))
