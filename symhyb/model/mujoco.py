"""A file of MuJoCo (MJCF) that is the machine: which of its parts are what, read and checked.

Nothing of the file itself is opened here. What MuJoCo answers along a recording becomes local
equations (:class:`symhyb.model.local.Local`), which no file states.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from symhyb.errors import did_you_mean
from symhyb.model.beside import named_file
from symhyb.model.tables import Fault, Table
from symhyb.units import ONE, Unit, parse_unit

FIELDS: Mapping[str, tuple[str, ...]] = {
    "body": ("mass",),
    "joint": ("damping", "frictionloss", "armature", "stiffness", "springref"),
    "tendon": ("damping", "frictionloss", "armature", "stiffness"),
    "geom": ("friction",),
}
ACTING = ("actuator", "joint", "tendon", "site")  # what an input may act by
SECTIONS = ("coordinates", "inputs", "parameters")


@dataclass(frozen=True, slots=True)
class Drive:
    """An ``input`` and what it acts by: the control of an actuator, a force along a joint or a
    tendon, or at a site a force ``along`` a direction in the axes of the world."""

    input: str
    kind: str
    part: str
    along: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Number:
    """A ``parameter`` and the number that it sets: the ``field`` of a body, joint, tendon or
    geom."""

    parameter: str
    kind: str
    part: str
    field: str


@dataclass(frozen=True, slots=True)
class Mujoco:
    """A file of MuJoCo in place of bodies: its ``file`` beside the model file, the name of a joint
    for every coordinate in their order, what the ``inputs`` act by, and what ``parameters`` set."""

    file: str
    joints: tuple[tuple[str, str], ...]
    inputs: tuple[Drive, ...] = ()
    parameters: tuple[Number, ...] = ()

    @property
    def section(self) -> str:
        """The table of the model file."""
        return "mujoco"

    @property
    def input_names(self) -> tuple[str, ...]:
        """The inputs of the model file that act in MuJoCo."""
        return tuple(one.input for one in self.inputs)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """The parameters of the model file that are set in MuJoCo."""
        return tuple(one.parameter for one in self.parameters)

    def path(self, model_file: str) -> Path:
        """Where the file lies, for a model file."""
        return Path(model_file).parent / self.file


def read_mujoco(root: Table) -> Mujoco | None:
    """Read the table ``[mujoco]``, None if there is none or it is wrong."""
    table = root.table("mujoco")
    if table is None:
        return None
    table = table.checked(("file", *SECTIONS))
    file = named_file(table, "file", required=True)
    named = {name: around.text(name) for around, name in table.pairs("coordinates")}
    drives = [_drive(around, name) for around, name in table.pairs("inputs")]
    numbers = [_number(inner) for inner in table.tables("parameters")]
    for key in SECTIONS:
        known = root.declared(key)
        for name in table.declared(key):
            if name not in known:
                table.fault(f"'{name}' is not declared in [{key}]{did_you_mean(name, known)}", key)
    if file is None:
        return None
    joints = tuple((name, named.get(name) or name) for name in root.declared("coordinates"))
    inputs = tuple(one for one in drives if one is not None)
    found = Mujoco(file, joints, inputs, tuple(one for one in numbers if one is not None))
    _require_apart(found, table)
    return found


def _drive(around: Table, name: str) -> Drive | None:
    """What an input acts by: the name of an actuator, or a table with one of ``ACTING``."""
    value = around.entries[name]
    if isinstance(value, str):
        part = around.text(name)
        return None if part is None else Drive(name, "actuator", part)
    table = around.table(name)
    if table is None:
        return None
    table = table.checked((*ACTING, "along"))
    named = _part(table, ACTING)
    if named is None:
        return None
    kind, part = named
    if kind != "site":
        if "along" in table.entries:
            table.fault("is for a site; leave it out", "along")
        return Drive(name, kind, part)
    shape = "a direction in the axes of the world, a list of three numbers"
    if table.lacks("along"):
        table.fault(f"'along' is missing: {shape}")
        return None
    along = table.numbers(table.entries.get("along"), "along", 3, shape)
    if along is None:
        return None
    if not 0 < sum(x**2 for x in along) < float("inf"):
        table.fault("has no direction; one of the three must not be 0", "along")
        return None
    return Drive(name, kind, part, tuple(along))


def _number(table: Table) -> Number | None:
    """What a parameter sets: a field of a body, joint, tendon or geom."""
    table = table.checked((*FIELDS, "field"))
    named, field = _part(table, tuple(FIELDS)), table.text("field", required=True)
    if named is None or field is None:
        return None
    kind, part = named
    if field not in FIELDS[kind]:
        known = FIELDS[kind]
        what = f"must be one of {', '.join(known)} for a {kind}, not '{field}'"
        table.fault(what + did_you_mean(field, known), "field")
        return None
    return Number(table.path[-1], kind, part, field)


def _part(table: Table, kinds: Sequence[str]) -> tuple[str, str] | None:
    """The one of ``kinds`` that a table names, and its name."""
    there = [kind for kind in kinds if kind in table.entries]
    if len(there) != 1:
        said = "names " + (" and ".join(there) if there else "nothing")
        table.fault(f"{said}; name one of {', '.join(kinds)}")
        return None
    part = table.text(there[0])
    return None if part is None else (there[0], part)


def _require_apart(found: Mujoco, table: Table) -> None:
    """No joint may be two coordinates, no actuator two inputs, no number two parameters."""
    used: list[tuple[str, str]] = [
        *(("coordinates", f"the joint '{joint}'") for _, joint in found.joints),
        *(
            ("inputs", f"the actuator '{one.part}'")
            for one in found.inputs
            if one.kind == "actuator"
        ),
        *(
            ("parameters", f"{one.field} of the {one.kind} '{one.part}'")
            for one in found.parameters
        ),
    ]
    for one in dict.fromkeys(one for one in used if used.count(one) > 1):
        table.fault(f"{one[1]} is named twice", one[0])


def unit_faults(
    found: Mujoco,
    coordinates: Mapping[str, Unit],
    inputs: Mapping[str, Unit],
    parameters: Mapping[str, Unit],
) -> Iterator[Fault]:
    """What has another unit than what it sets in MuJoCo, or moves otherwise than a joint."""
    metre, joule, second = (parse_unit(text) for text in ("m", "J", "s"))
    for name, unit in coordinates.items():
        if not (unit.is_angle or unit.same_dimension(metre)):
            yield ("coordinates", name, "unit"), f"is {unit}; a joint is an angle or a length"
    moved = {joint: coordinates[name] for name, joint in found.joints if name in coordinates}
    for drive in found.inputs:
        stated, needed = inputs.get(drive.input), None
        if drive.kind == "site":
            needed = joule / metre
        elif drive.kind == "joint" and drive.part in moved:
            needed = joule / moved[drive.part]
        if stated and needed and not stated.same_dimension(needed):
            yield ("inputs", drive.input, "unit"), f"is {stated}, needs {needed}: a force there"
    for number in found.parameters:
        stated, needed = parameters.get(number.parameter), None
        if number.kind == "body":
            needed = parse_unit("kg")
        elif number.kind == "geom":
            needed = ONE
        elif number.kind == "joint" and number.part in moved:
            needed = _of_joint(number.field, moved[number.part], joule, second)
        if stated and needed and not stated.same_dimension(needed):
            what = f"is {stated}, needs {needed}: {number.field} of a {number.kind}"
            yield ("parameters", number.parameter, "unit"), what


def _of_joint(field: str, moved: Unit, joule: Unit, second: Unit) -> Unit:
    """The unit of a field of a joint whose coordinate is in ``moved``."""
    if field == "springref":
        return moved
    by = {"damping": second, "armature": second**2, "stiffness": ONE}
    return joule / moved if field == "frictionloss" else joule * by[field] / moved**2


def reserved(sections: Sequence[str], imposed: Sequence[str]) -> Iterator[Fault]:
    """What may not stand beside a file of MuJoCo: ``sections`` of the model file, and ``imposed``
    coordinates."""
    for key in sections:
        text = "MuJoCo has the machine, with its masses and all that holds it; leave it out"
        yield (key,), text
    for name in imposed:
        text = "an imposed coordinate is not possible with MuJoCo; leave it to an input"
        yield ("coordinates", name, "imposed"), text
