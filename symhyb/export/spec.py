"""What is exported, said for other programs: variables with names, units, starts and numbers.

A name is a kind and a name of the model, ``q.x``, ``v.x`` (q'), ``a.x`` (q''), ``u.f``, ``s.i``,
``z.rub``, ``dF.x``, ``y.laser``, ``trust.rest``, ``p.k``, ``mode.rub``, ``event.rub.upper``, so
that no two are equal. Everything is in SI.

    wall |--/\\/\\--[ m ]--> q.x        dF.x > 0 pushes the mass along +q.x: the host adds +dF.x
                 ΔF ──▶
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from symhyb.errors import InputError, Problem
from symhyb.export.functions.exportable import name_of
from symhyb.export.functions.exported import Exported, export_elements, export_machine
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import memories, stretch_unit
from symhyb.units import ONE, Unit, parse_unit

Role = Literal["time", "input", "output", "indicator", "state", "rate", "parameter", "mode"]

C_WORDS = frozenset(
    {
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "main",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
        "model",
    }  # begins the names of our own functions
)
_BASE = ("m", "kg", "s", "A", "K", "mol", "cd")
_NAMED = ("N", "N*m", "V")


@dataclass(frozen=True, slots=True)
class Variable:
    """One number that a program may read or set: ``reference`` is its place in the flat array of
    the C code, ``unit`` its SI unit, ``of`` the reference of the state that a rate belongs to."""

    name: str
    reference: int
    role: Role
    start: float
    unit: Unit
    about: str
    of: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Spec:
    """An export with the variables in the order of their references: t, inputs, outputs,
    indicators of events, states, rates, parameters, modes. ``identifier`` names the files and is a
    C name; ``whole`` is false for force elements alone."""

    identifier: str
    title: str
    exported: Exported
    variables: tuple[Variable, ...]
    whole: bool

    def of_role(self, role: Role) -> tuple[Variable, ...]:
        """The variables of one role."""
        return tuple(v for v in self.variables if v.role == role)

    @property
    def events(self) -> bool:
        """Whether laws that jump are in modes, which indicators show."""
        return bool(self.exported.ways)

    @property
    def inner(self) -> tuple[Variable, ...]:
        """The states whose start the code computes: at rest, or as declared."""
        states = self.of_role("state")
        return states[len(states) - self.exported.inner :]

    def nominal(self, variable: Variable) -> float:
        """The typical size of a state, SI: what a law remembers is a small stretch."""
        return 1e-3 if variable.name.startswith("z.") else 1.0


def spec_of(
    model: Model,
    identifier: str,
    elements: Sequence[str] = (),
    whole: bool = False,
    events: bool = False,
) -> Spec:
    """Say what to export: the whole ``model``, or the forces of ``elements`` (default: those that a
    diagnosis found). With ``events``, what jumps is in modes that an importer switches.

    Raises:
        InputError: names that are not valid in C, elements that are missing or cannot be exported,
            or nothing that switches.
    """
    require_c_names(model, identifier)
    if whole:
        if elements:
            text = "name elements or export the whole model, not both"
            raise InputError(Problem(text, file=model.file))
        exported = export_machine(model, events)
    else:
        exported = export_elements(model, chosen(model, elements), events)
        if not exported.outputs:
            text = "the elements exert no force; name others with --element"
            raise InputError(Problem(text, "elements", model.file))
    if events and not exported.ways:
        text = (
            "nothing in what is exported switches: no friction along one direction, no gap, no "
            "sign(...); export it without --events"
        )
        raise InputError(Problem(text, "elements", model.file))
    return Spec(identifier, model.title, exported, _variables(exported), whole)


def chosen(model: Model, elements: Sequence[str]) -> tuple[str, ...]:
    """The names of the ``elements`` that are exported; none named: those that a diagnosis found.

    Raises:
        InputError: elements that are missing, or none at all.
    """
    known = [element.name for element in model.elements]
    missing = [name for name in elements if name not in known]
    if missing:
        there = ", ".join(known) or "none"
        text = f"the model has no such element; it has: {there}"
        raise InputError([Problem(text, f"elements.{name}", model.file) for name in missing])
    found = tuple(element.name for element in model.elements if element.found)
    if not elements and not found:
        text = (
            "no element of the model was found by a diagnosis; name what to export with --element, "
            "or export everything with --whole"
        )
        raise InputError(Problem(text, "elements", model.file))
    return tuple(elements) or found


def require_c_names(model: Model, identifier: str) -> None:
    """Refuse names that are none in C.

    Raises:
        InputError: the ``identifier`` of an export, or names of the model.
    """
    problems = []
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,63}", identifier) or identifier in C_WORDS:
        text = (
            f"'{identifier}' names files and functions in C and must be letters, digits and _, "
            "begin with a letter, and be no word of C; choose another with --name"
        )
        problems.append(Problem(text))
    groups: Mapping[str, Sequence[str]] = {
        "coordinates": [c.name for c in model.coordinates],
        "inputs": [i.name for i in model.inputs],
        "states": [s.name for s in model.states],
        "parameters": [p.path for p in model.all_parameters()],
        "elements": [e.name for e in model.elements],
        "sensors": [s.name for s in model.sensors],
    }
    for group, names in groups.items():
        for name in names:
            if not name.isascii():
                text = f"'{name}' is no name in C; use the letters a to z, digits and _"
                problems.append(Problem(text, f"{group}.{name}", model.file))
    if problems:
        raise InputError(problems)


def _variables(exported: Exported) -> tuple[Variable, ...]:
    model, made = exported.model, [Variable("time", 0, "time", 0.0, parse_unit("s"), "time")]

    def add(role: Role, name: str, start: float, what: tuple[Unit, str], of: int = 0) -> None:
        made.append(Variable(name, len(made), role, start, what[0], what[1], of))

    for (kind, name), start in zip(exported.inputs, exported.u, strict=True):
        add("input", f"{kind}.{name}", float(start), _said(model, kind, name))
    for kind, name in exported.outputs:
        role: Role = "indicator" if kind == "event" else "output"
        add(role, f"{kind}.{name}", 0.0, _said(model, kind, name))
    first = len(made)
    for (kind, name), start in zip(exported.states, exported.x, strict=True):
        add("state", f"{kind}.{name}", float(start), _said(model, kind, name))
    for i, (kind, name) in enumerate(exported.states):
        unit, about = _said(model, kind, name)
        what = (si_unit(unit / parse_unit("s")), f"rate of {about}")
        add("rate", f"der({kind}.{name})", 0.0, what, first + i)
    for (kind, name), value in zip(exported.parameters, exported.p, strict=True):
        role = "mode" if kind == "mode" else "parameter"
        add(role, f"{kind}.{name}", float(value), _said(model, kind, name))
    return tuple(made)


def _said(model: Model, kind: str, name: str) -> tuple[Unit, str]:
    """Unit and description of an entry."""
    second = parse_unit("s")
    coordinate = {c.name: c for c in model.coordinates}.get(name)
    if kind in ("q", "v", "a", "dF") and coordinate is not None:
        unit, about = coordinate.unit, coordinate.about or name
        match kind:
            case "q":
                return si_unit(unit), about
            case "v":
                return si_unit(unit / second), f"speed of {name}: {about}"
            case "a":
                return si_unit(unit / second**2), f"acceleration of {name}: {about}"
        force = model.energy_unit / unit
        return si_unit(force), f"force on {name} that the model lacked; the host adds it (+)"
    match kind:
        case "u":
            item = next(i for i in model.inputs if i.name == name)
            return si_unit(item.unit), item.about or name
        case "y":
            sensor = next(s for s in model.sensors if s.name == name)
            late = " (its delay is left to the host)" if sensor.delay else ""
            return si_unit(sensor.unit), (sensor.about or f"what {name} records") + late
        case "trust":
            return ONE, f"1 where the network {name} was trained, falling to 0 outside"
        case "event":
            return ONE, f"its sign tells when the mode of {name.removesuffix('.lower')} changes"
        case "mode":
            return ONE, f"of {name}: -1, 0 (turning) or 1; of a stop 1 where it acts, else 0"
        case "s":
            state = next(s for s in model.states if s.name == name)
            return si_unit(state.unit), state.about or name
        case "z":
            return _said_inner(model, name)
    if name == "smoothing":
        return ONE, "width, in SI, over which a jump of sgn is passed; 0: exact"
    parameter = next(p for p in model.all_parameters() if p.path == name)
    return si_unit(parameter.unit), parameter.about or name


def _said_inner(model: Model, name: str) -> tuple[Unit, str]:
    """An inner state is a stretch, or the rate of one: of a coordinate or an expression, or between
    points in m."""
    element, state = next(one for one in memories(model) if name_of(*one) == name)
    unit = stretch_unit(model, element.place)
    if isinstance(element.place, On) and element.place.plain:
        unit = next(c.unit for c in model.coordinates if c.name == element.place.coordinate)
    return si_unit(unit * parse_unit("s") ** state.time), f"inner state of {name}"


def si_unit(unit: Unit) -> Unit:
    """The coherent SI unit of the same dimension, as short as it can be said."""
    if unit.factor == 1.0 and len(unit.text) <= 16 and unit.text.count("*") < 3:
        named = _short(unit)
        return named if named is not None else unit
    if unit.is_number:
        return parse_unit("rad") if unit.is_angle else ONE
    named = _short(unit)
    if named is not None:
        return named
    parts = zip(_BASE, unit.dimension, strict=True)
    up = "*".join(_power(name, power) for name, power in parts if power > 0) or "1"
    parts = zip(_BASE, unit.dimension, strict=True)
    down = "".join("/" + _power(name, -power) for name, power in parts if power < 0)
    return Unit(up + down, 1.0, unit.dimension)


def _short(unit: Unit) -> Unit | None:
    for text in _NAMED:
        if parse_unit(text).same_dimension(unit) and unit.text.count("*") + unit.text.count("/"):
            return parse_unit(text) if text != "V" or "V" in unit.text else None
    return None


def _power(name: str, power: Fraction) -> str:
    if power == 1:
        return name
    return f"{name}^{power}" if power.denominator == 1 else f"{name}^({power})"
