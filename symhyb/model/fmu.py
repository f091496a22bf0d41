"""An FMU that is the machine: which of its variables are what, read and checked.

Nothing of the FMU itself is opened here. What it answers along a recording becomes local equations
(:class:`symhyb.model.local.Local`), which no file states.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from symhyb.errors import did_you_mean
from symhyb.model.beside import named_file
from symhyb.model.tables import Fault, Table
from symhyb.model.trees import Quantity, show
from symhyb.units import Unit, parse_unit

VARIABLES = ("position", "rate", "force")  # of a coordinate, as variables of the FMU
SECTIONS = ("coordinates", "inputs", "parameters")


@dataclass(frozen=True, slots=True)
class FmuPlace:
    """The variables of an FMU that belong to a coordinate: the states ``position`` and ``rate``
    and the input ``force``, which acts along the coordinate; or, where the FMU has no such input
    (empty), the ``mass`` that a force along the coordinate would move."""

    coordinate: str
    position: str
    rate: str
    force: str = ""
    mass: Quantity | None = None

    def facts(self) -> tuple[tuple[str, str], ...]:
        """What a model file states, by key."""
        variables = ((key, getattr(self, key)) for key in VARIABLES)
        stated = [] if self.mass is None else [("mass", show(self.mass))]
        return *((key, name) for key, name in variables if name), *stated


@dataclass(frozen=True, slots=True)
class Fmu:
    """An FMU in place of bodies: its ``file`` beside the model file, a place for every coordinate
    in their order, and by name the variables that ``inputs`` and ``parameters`` of the model file
    set."""

    file: str
    places: tuple[FmuPlace, ...]
    inputs: tuple[tuple[str, str], ...] = ()
    parameters: tuple[tuple[str, str], ...] = ()

    @property
    def section(self) -> str:
        """The table of the model file."""
        return "fmu"

    @property
    def input_names(self) -> tuple[str, ...]:
        """The inputs of the model file that are the FMU's."""
        return tuple(name for name, _ in self.inputs)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """The parameters of the model file that are the FMU's."""
        return tuple(name for name, _ in self.parameters)

    def path(self, model_file: str) -> Path:
        """Where the FMU lies, for a model file."""
        return Path(model_file).parent / self.file


def read_fmu(root: Table) -> Fmu | None:
    """Read the table ``[fmu]``, None if there is none or it is wrong."""
    table = root.table("fmu")
    if table is None:
        return None
    table = table.checked(("file", *SECTIONS))
    file = named_file(table, "file", required=True)
    if table.lacks("coordinates"):
        table.fault("'coordinates' is missing: say which states of the FMU are which coordinates")
    places = [_place(inner) for inner in table.tables("coordinates")]
    pairs = {
        key: tuple(
            (name, variable)
            for around, name in table.pairs(key)
            if (variable := around.text(name)) is not None
        )
        for key in ("inputs", "parameters")
    }
    for key in SECTIONS:
        _require_declared(root, table, key)
    if file is None or None in places:
        return None
    order = root.declared("coordinates")
    known = [place for place in places if place is not None and place.coordinate in order]
    known.sort(key=lambda place: order.index(place.coordinate))
    found = Fmu(file, tuple(known), **pairs)
    _require_apart(found, table)
    if len({bool(place.force) for place in known}) > 1:
        table.fault("some coordinates name a 'force' and others a 'mass'; all need the same")
    return found


def _place(table: Table) -> FmuPlace | None:
    table = table.checked((*VARIABLES, "mass"))
    position, rate = (table.text(key, required=True) for key in ("position", "rate"))
    if table.lacks("force") == table.lacks("mass"):
        table.fault(
            "needs either 'force', an input that acts along the coordinate, or 'mass', where the "
            "FMU has no such input"
        )
        return None
    force, stated = table.text("force"), table.expression("mass")
    mass = stated.tree if stated is not None and isinstance(stated.tree, Quantity) else None
    if stated is not None and not (mass and mass.value > 0):
        table.fault('is no number above 0 with its unit, as "1.3 kg"', "mass")
        return None
    if position is None or rate is None:
        return None
    return FmuPlace(table.path[-1], position, rate, force or "", mass)


def _require_declared(root: Table, table: Table, key: str) -> None:
    """Every name must be one of the model file; and every coordinate must be there."""
    known = root.declared(key)
    for name in table.declared(key):
        if name not in known:
            table.fault(f"'{name}' is not declared in [{key}]{did_you_mean(name, known)}", key)
    if key == "coordinates" and not table.lacks(key):
        for name in known:
            if name not in table.declared(key):
                table.fault(f"'{name}' is missing: its position, rate and force or mass", key)


def _require_apart(fmu: Fmu, table: Table) -> None:
    """No variable may stand for two things."""
    used: Sequence[str] = [
        *(
            name
            for place in fmu.places
            for name in (place.position, place.rate, place.force)
            if name
        ),
        *(variable for pairs in (fmu.inputs, fmu.parameters) for _, variable in pairs),
    ]
    for name in dict.fromkeys(name for name in used if used.count(name) > 1):
        table.fault(f"the variable '{name}' of the FMU is named twice")


def mass_faults(fmu: Fmu, units: Mapping[str, Unit]) -> Iterator[Fault]:
    """Masses of other units than what a force along a coordinate, of these ``units``, moves."""
    for place in fmu.places:
        unit = units[place.coordinate]
        needed = parse_unit("kg*m^2") / unit**2
        if place.mass is not None and not place.mass.unit.same_dimension(needed):
            where = ("fmu", "coordinates", place.coordinate, "mass")
            yield where, f"is {place.mass.unit}, needs {needed} on a coordinate in {unit}"


def fmu_faults(sections: Sequence[str], imposed: Sequence[str]) -> Iterator[Fault]:
    """What may not stand beside an FMU: ``sections`` of the file, and ``imposed`` coordinates."""
    for key in sections:
        yield (key,), "the FMU is the machine, with its masses and all that holds it; leave it out"
    for name in imposed:
        text = "an imposed coordinate is not possible with an FMU; leave it to the FMU's inputs"
        yield ("coordinates", name, "imposed"), text
