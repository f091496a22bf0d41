"""An FMU that is the machine: which of its variables are what, read and checked.

Nothing of the FMU itself is opened here. What it answers along a recording becomes local equations
(:class:`symhyb.model.local.Local`), which no file states.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from symhyb.errors import did_you_mean
from symhyb.model.beside import named_file
from symhyb.model.tables import Fault, Table

PLACE_KEYS = ("position", "rate", "force")
SECTIONS = ("coordinates", "inputs", "parameters")


@dataclass(frozen=True, slots=True)
class FmuPlace:
    """The variables of an FMU that belong to a coordinate: the states ``position`` and ``rate``
    and the input ``force``, which acts along the coordinate."""

    coordinate: str
    position: str
    rate: str
    force: str


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
    return found


def _place(table: Table) -> FmuPlace | None:
    table = table.checked(PLACE_KEYS)
    position, rate, force = (table.text(key, required=True) for key in PLACE_KEYS)
    if position is None or rate is None or force is None:
        return None
    return FmuPlace(table.path[-1], position, rate, force)


def _require_declared(root: Table, table: Table, key: str) -> None:
    """Every name must be one of the model file; and every coordinate must be there."""
    known = root.declared(key)
    for name in table.declared(key):
        if name not in known:
            table.fault(f"'{name}' is not declared in [{key}]{did_you_mean(name, known)}", key)
    if key == "coordinates" and not table.lacks(key):
        for name in known:
            if name not in table.declared(key):
                table.fault(f"'{name}' is missing: its position, rate and force", key)


def _require_apart(fmu: Fmu, table: Table) -> None:
    """No variable may stand for two things."""
    used: Sequence[str] = [
        *(name for place in fmu.places for name in (place.position, place.rate, place.force)),
        *(variable for pairs in (fmu.inputs, fmu.parameters) for _, variable in pairs),
    ]
    for name in dict.fromkeys(name for name in used if used.count(name) > 1):
        table.fault(f"the variable '{name}' of the FMU is named twice")


def fmu_faults(sections: Sequence[str], imposed: Sequence[str]) -> Iterator[Fault]:
    """What may not stand beside an FMU: ``sections`` of the file, and ``imposed`` coordinates."""
    for key in sections:
        yield (key,), "the FMU is the machine, with its masses and all that holds it; leave it out"
    for name in imposed:
        text = "an imposed coordinate is not possible with an FMU; leave it to the FMU's inputs"
        yield ("coordinates", name, "imposed"), text
