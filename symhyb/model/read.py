"""Read a model file (TOML, format 1): a checked Model, or every problem at once.

Nothing of the file is executed: ``tomllib`` gives values, expressions go through a whitelist.
"""

import re
import tomllib
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path as FilePath
from typing import TypeVar

from symhyb.asked import asked
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.limits import COORDINATES, DECLARED, text_of
from symhyb.model.actuators import ACTUATOR_KEYS, FAULT_KEYS, refused, usual_unit
from symhyb.model.check import energy_unit, faults_of
from symhyb.model.fmu import read_fmu
from symhyb.model.limits import read_limit
from symhyb.model.mujoco import read_mujoco
from symhyb.model.read_bodies import read_body, read_point
from symhyb.model.read_constraints import read_constraint
from symhyb.model.read_curves import read_curve
from symhyb.model.read_elements import read_element, read_parameter
from symhyb.model.read_maps import read_map
from symhyb.model.read_space import dimension_of
from symhyb.model.read_states import read_state
from symhyb.model.render import FORMAT
from symhyb.model.source import Source, scan
from symhyb.model.tables import Fault, Table, describe
from symhyb.model.types import Coordinate, Energy, Input, Model, Parameter, Sensor
from symhyb.units import Unit

SECTIONS = (
    "symhyb",
    "title",
    "about",
    "gravity",
    "fmu",
    "mujoco",
    "coordinates",
    "states",
    "parameters",
    "inputs",
    "points",
    "bodies",
    "energy",
    "constraints",
    "curves",
    "maps",
    "elements",
    "sensors",
    "limits",
)
_CHANNEL_KEYS = ("unit", "about", *FAULT_KEYS)
BETWEEN = ("line", "smooth", "held")  # how an input runs between its samples

Value = TypeVar("Value")


@asked
def read_model(path: str | FilePath) -> Model:
    """Read and check a model file.

    Raises:
        InputError: every problem of the file, each with file, line and dotted name.
    """
    if "\n" in str(path):
        text = "is the text of a model, not the path of a file; read it with parse_model(text)"
        raise InputError(Problem(text, file=str(path).strip().splitlines()[0][:40]))
    return parse_model(text_of(path, "utf-8"), str(path))


@asked
def parse_model(text: str, file: str = "") -> Model:
    """Read and check the text of a model file; ``file`` is its name in messages.

    Raises:
        InputError: every problem of the text.
    """
    if not text.strip().removeprefix("\ufeff"):
        raise InputError(Problem("the file is empty", file=file))
    document, source = _toml(text, file)
    faults: list[Fault] = []
    root = Table((), document, faults)
    unit = None
    if _format_is_known(root):
        model, unreadable = _draft(root.checked(SECTIONS), text, file)
        unit, energy_faults = energy_unit(model, unreadable)
        faults += [*energy_faults, *faults_of(model, unit, unreadable)]
        if unit is None and not faults:
            root.fault("the unit of energy cannot be told; state a mass or an energy", "bodies")
    if faults or unit is None:
        raise InputError(_problems(faults, source, file))
    return replace(model, energy_unit=unit)


def _toml(text: str, file: str) -> tuple[dict[str, object], Source]:
    try:
        return tomllib.loads(text.removeprefix("\ufeff")), scan(text)
    except RecursionError:
        raise InputError(Problem("is nested too deeply", file=file)) from None
    except ValueError as error:  # TOMLDecodeError, and integers beyond Python's digit limit
        where = re.search(r"\(at line (\d+), column \d+\)", str(error))
        line = int(where[1]) if where else text.count("\n") + 1 if "end of doc" in str(error) else 0
        reason = re.sub(r" \(at .*\)$", "", str(error))
        if re.search("twice|overwrite|redefine", reason):
            reason = f"a name is stated twice ({reason})"
        raise InputError(Problem(f"is not valid TOML: {reason}", file=file, line=line)) from None


def _problems(faults: Iterable[Fault], source: Source, file: str) -> list[Problem]:
    """Give faults their lines, in the order of the file."""
    found = [Problem(text, ".".join(path), file, source.line(*path)) for path, text in faults]
    return sorted(dict.fromkeys(found), key=lambda problem: problem.line)


def _format_is_known(root: Table) -> bool:
    """Check ``symhyb = 1``; a file of a newer format is not read any further."""
    version = root.entries.get("symhyb")
    if version is None:
        if root.lacks("symhyb"):
            root.fault(f"the file does not state its format; begin it with: symhyb = {FORMAT}")
        return True
    if isinstance(version, bool) or not isinstance(version, int) or version < 1:
        root.fault(f"must be the number {FORMAT}, not {describe(version)}", "symhyb")
        return True
    if version > FORMAT:
        root.fault(f"format {version} is newer than {FORMAT}, which this version reads", "symhyb")
    return version <= FORMAT


def _draft(root: Table, text: str, file: str) -> tuple[Model, frozenset[str]]:
    """Read every section; also return the dotted names of what could not be read.

    Those names stay known, so that one mistake does not return as "unknown name" elsewhere.
    """
    points = _present(read_point(table, name) for table, name in root.pairs("points"))
    home = FilePath(file).parent if file else None
    curves = _present(read_curve(table, home) for table in root.tables("curves"))
    maps = _present(read_map(table, home) for table in root.tables("maps"))
    known = {**dict.fromkeys(root.declared("curves")), **{curve.name: curve for curve in curves}}
    mapped = {**dict.fromkeys(root.declared("maps")), **{item.name: item for item in maps}}
    size = dimension_of(root.entries)
    energy = root.table("energy")
    model = Model(
        title=root.text("title") or "",
        about=root.about(),
        coordinates=_present(map(_coordinate, root.tables("coordinates"))),
        states=_present(map(read_state, root.tables("states"))),
        parameters=_present(read_parameter(table) for table in root.tables("parameters")),
        inputs=_present(map(_input, root.tables("inputs"))),
        points=points,
        bodies=_present(read_body(table, root, points, size) for table in root.tables("bodies")),
        curves=curves,
        maps=maps,
        elements=_present(
            read_element(table, root, size, home, known, mapped)
            for table in root.tables("elements")
        ),
        sensors=_present(map(_sensor, root.tables("sensors"))),
        energy=_energy(energy) if energy else Energy(),
        constraints=_present(map(read_constraint, root.tables("constraints"))),
        limits=_present(read_limit(table, root) for table in root.tables("limits")),
        fmu=read_fmu(root),
        mujoco=read_mujoco(root),
        gravity=root.vector("gravity") if "gravity" in root.entries else None,
        text=text,
        file=file,
    )
    if root.lacks("coordinates"):
        root.fault("[coordinates] is missing: name at least one coordinate")
    elif root.entries.get("coordinates") == {}:
        root.fault("has no coordinate; name at least one", "coordinates")
    read = {
        *(f"coordinates.{value.name}" for value in model.coordinates),
        *(f"states.{value.name}" for value in model.states),
        *(f"parameters.{value.name}" for value in model.parameters),
        *(f"inputs.{value.name}" for value in model.inputs),
        *(f"points.{value.name}" for value in model.points),
        *(f"bodies.{value.name}" for value in model.bodies),
        *(f"elements.{value.name}" for value in model.elements),
        *(f"curves.{value.name}" for value in model.curves),
        *(f"maps.{value.name}" for value in model.maps),
    }
    moving = ("coordinates", "states")
    tables = ("curves", "maps")
    sections = (*moving, "parameters", "inputs", "points", "bodies", "elements", *tables)
    for key in sections:
        most = COORDINATES if key in moving else DECLARED
        if (count := len(root.declared(key))) > most:
            root.fault(f"are {count}; a machine has at most {most}", key)
    unreadable = {f"{key}.{name}" for key in sections for name in root.declared(key)} - read
    for key in ("fmu", "mujoco"):
        if key in root.entries and model.engine is None:
            unreadable |= {f"bodies.{key}"}  # it has mass, as an unreadable body has
    if "fmu" in root.entries and "mujoco" in root.entries:
        root.fault("stands beside [fmu]; a machine is one of them", "mujoco")
    if "energy" not in root.entries:
        unreadable |= {f"energy.{name}" for name in root.declared("energy")}
    return model, frozenset(unreadable)


def _present(values: Iterable[Value | None]) -> tuple[Value, ...]:
    return tuple(value for value in values if value is not None)


def _coordinate(table: Table) -> Coordinate | None:
    table = table.checked(("unit", "start", "start_rate", "about", "imposed"))
    unit, imposed = table.unit(), table.truth("imposed")
    start, rate, about = table.number("start"), table.number("start_rate"), table.about()
    if unit is None:
        return None
    stated = tuple(key for key in ("start", "start_rate") if key in table.entries)
    return Coordinate(table.path[-1], unit, start or 0.0, rate or 0.0, about, imposed, stated)


def _input(table: Table) -> Input | None:
    table = table.checked((*_CHANNEL_KEYS, *ACTUATOR_KEYS, "between"))
    unit, about, between = table.unit(), table.about(), table.text("between")
    gain, offset, delay = (_channel(table, key, unit) for key in FAULT_KEYS)
    shaped = _present(_channel(table, key, unit) for key in ACTUATOR_KEYS)
    if between is not None and between not in BETWEEN:
        near = did_you_mean(between, BETWEEN)
        table.fault(f"must be one of {', '.join(BETWEEN)}, not '{between}'{near}", "between")
    if unit is None:
        return None
    name, way = table.path[-1], between or ""
    return Input(name, unit, about, gain, offset, delay, way, actuator=shaped)


def _sensor(table: Table) -> Sensor | None:
    table = table.checked(("measures", "sd", *_CHANNEL_KEYS))
    measures, unit = table.expression("measures", required=True), table.unit()
    sd, about = table.deviation(), table.about()
    gain, offset, delay = (_channel(table, key, unit) for key in FAULT_KEYS)
    if measures is None or unit is None:
        return None
    return Sensor(table.path[-1], measures, unit, sd, about, gain, offset, delay)


def _channel(table: Table, key: str, unit: Unit | None) -> Parameter | None:
    """Read a number of a channel or of its actuator: a number, or a table with value and sd."""
    owner = table.path[-1]
    usual = None if unit is None else usual_unit(key, unit)
    if not isinstance(table.entries.get(key), dict):
        value, own, sd, was, about = table.number(key), None, None, None, ""
    else:
        inner = Table((*table.path, key), table.entries[key], table.faults)  # type: ignore[arg-type]
        inner = inner.checked(("value", "sd", "unit", "was", "about"))
        value, own = inner.number("value", required=True), inner.unit(required=False)
        sd, was, about = inner.deviation(), inner.number("was"), inner.about()
    if own and usual and not own.same_dimension(usual):
        table.fault(f"is in {own}, needs {usual}", key, "unit")
    if value is not None and (why := refused(key, value)):
        table.fault(why, key)
    if value is None or usual is None:
        return None
    return Parameter(key, value, own or usual, sd, about, was, owner)


def _energy(table: Table) -> Energy:
    table = table.checked(("kinetic", "potential"))
    return Energy(table.expression("kinetic"), table.expression("potential"))
