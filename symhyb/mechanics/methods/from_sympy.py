"""A model from the equations of motion that SymPy's mechanics derived."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.physics.mechanics import dynamicsymbols

from symhyb.asked import asked
from symhyb.errors import InputError, Problem
from symhyb.mechanics.methods.derived import Derived, derived
from symhyb.mechanics.methods.text import Naming, UnwritableError, written
from symhyb.model.expression import RESERVED
from symhyb.model.read import parse_model
from symhyb.model.types import Model

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")

Value = tuple[float, str] | tuple[float, str, float]
"""A number, its unit, and one standard deviation where it is uncertain."""


@asked
def from_sympy(
    method: object,
    values: Mapping[Any, Value],
    units: Mapping[Any, str],
    *,
    sensors: Mapping[str, tuple[Any, str]] | None = None,
    start: Mapping[Any, float] | None = None,
    title: str = "",
) -> Model:
    """The model of a ``KanesMethod``, a ``LagrangesMethod`` or a ``System`` of
    ``sympy.physics.mechanics`` whose equations are formed, without constraints.

    ``values`` gives each constant (a symbol, or its name) its value and unit, and one standard
    deviation where it may be estimated: ``{m: (1.2, "kg"), k: (980.0, "N/m", 40.0)}``; ``units``
    gives the units of all coordinates, and of the functions of time that act as inputs: ``{x: "m",
    f: "N"}``. ``sensors`` are expressions with the unit that they are recorded in, by the name of
    the column (default: every coordinate by its name); ``start`` are coordinates at the start of a
    simulation, in their units. The text of the model (``write_model``) is an ordinary model file.

    Raises:
        InputError: every problem at once: what has no value or unit, a function that a model file
            does not know, units that do not fit.
    """
    parts = derived(method)
    asked = _Asked(parts, _named(values), _named(units), _named(start or {}), sensors)
    problems = _of_sensors(sensors or {}) or asked.problems()
    if problems:
        raise InputError(problems)
    return parse_model("\n".join(_lines(asked, title)) + "\n", "the model from SymPy")


def _of_sensors(sensors: Mapping[str, Any]) -> list[Problem]:
    """Sensors that are no expression with a unit; text is never evaluated."""
    found = []
    for name, wanted in sensors.items():
        pair = isinstance(wanted, Sequence) and len(wanted) == 2
        if not (pair and isinstance(wanted[0], sp.Expr) and isinstance(wanted[1], str)):
            text = f"{wanted!r} is no expression of SymPy with its unit, as in (x.diff(), 'm/s')"
            found.append(Problem(text, f"sensors.{name}"))
    return found


def _named(given: Mapping[Any, Any]) -> dict[str, Any]:
    return {_name(key): value for key, value in given.items()}


def _name(key: Any) -> str:
    """The name of a symbol, of a function of time, or a name as it is."""
    if isinstance(key, str):
        return key
    return str(getattr(getattr(key, "func", None), "__name__", "")) if _timed(key) else str(key)


def _timed(key: Any) -> bool:
    return isinstance(key, sp.core.function.AppliedUndef)


@dataclass(frozen=True, slots=True)
class _Asked:
    """What is asked for: the ``parts`` of the equations, and what was given by name."""

    parts: Derived
    values: Mapping[str, Value]
    units: Mapping[str, str]
    start: Mapping[str, float]
    wanted: Mapping[str, tuple[Any, str]] | None

    @property
    def coordinates(self) -> list[str]:
        return [_name(one) for one in self.parts.q]

    @property
    def sensors(self) -> dict[str, tuple[sp.Expr, str]]:
        """Expressions and units by name."""
        if self.wanted is None:
            pairs = zip(self.coordinates, self.parts.q, strict=True)
            return {name: (q, self.units.get(name, "")) for name, q in pairs}
        return dict(self.wanted)

    @property
    def expressions(self) -> list[sp.Expr]:
        """All that must be written."""
        parts, sensed = self.parts, [one for one, _ in self.sensors.values()]
        return [parts.kinetic, parts.potential, *parts.forces, *sensed]

    @property
    def constants(self) -> list[str]:
        """The names of the constants, in alphabetical order."""
        t = dynamicsymbols._t
        found = set().union(*(one.free_symbols for one in self.expressions)) - {t}
        return sorted(str(one) for one in found)

    @property
    def inputs(self) -> list[str]:
        """The names of the functions of time that are no coordinate."""
        kind = sp.core.function.AppliedUndef
        found = set().union(*(one.atoms(kind) for one in self.expressions)) - set(self.parts.q)
        return sorted(map(_name, found))

    @property
    def naming(self) -> Naming:
        return Naming(frozenset(self.coordinates), frozenset(self.inputs))

    def problems(self) -> list[Problem]:
        """All that keeps the model from being written."""
        found = []
        for name in (*self.coordinates, *self.inputs):
            if name not in self.units:
                found.append(Problem(f"'{name}' has no unit: units={{{name}: 'm'}}", "units"))
        for name in self.constants:
            if name not in self.values:
                example = f"values={{{name}: (1.0, 'kg')}}"
                found.append(Problem(f"'{name}' has no value: {example}", "values"))
        for name in (*self.coordinates, *self.inputs, *self.constants):
            if not _NAME.match(name) or name in RESERVED:
                text = f"'{name}' cannot be a name in a model file; rename the symbol"
                found.append(Problem(text, "method"))
        for name, value in self.values.items():
            if not _is_value(value):
                text = f"{name}: {value!r} is no value with its unit, as in (1.2, 'kg')"
                found.append(Problem(text, "values"))
        for where, expression in self._places():
            try:
                written(expression, self.naming)
            except UnwritableError as error:
                found.append(Problem(str(error), where))
        return found

    def _places(self) -> list[tuple[str, sp.Expr]]:
        forces = zip(self.coordinates, self.parts.forces, strict=True)
        return [
            ("kinetic energy", self.parts.kinetic),
            ("potential energy", self.parts.potential),
            *((f"force on {name}", one) for name, one in forces),
            *((f"sensors.{name}", one) for name, (one, _) in self.sensors.items()),
        ]


def _is_value(value: object) -> bool:
    if not isinstance(value, Sequence) or len(value) not in (2, 3):
        return False
    numbers = (value[0], *value[2:])
    real = all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in numbers)
    return real and isinstance(value[1], str)


def _lines(asked: _Asked, title: str) -> list[str]:
    """The text of the model file, line by line."""
    parts, naming = asked.parts, asked.naming
    lines = [
        "# Derived by sympy.physics.mechanics: energies, and the generalized forces beside them.",
        "symhyb = 1",
        f"title = {_quoted(title or 'A machine derived by SymPy')}",
        "",
        "[coordinates]",
    ]
    for name in asked.coordinates:
        begin = f", start = {float(asked.start[name])!r}" if name in asked.start else ""
        lines.append(f"{name} = {{ unit = {_quoted(asked.units[name])}{begin} }}")
    lines += ["", "[parameters]"]
    for name in asked.constants:
        number, unit, *sd = asked.values[name]
        more = f", sd = {float(sd[0])!r}" if sd else ""
        lines.append(f"{name} = {{ value = {float(number)!r}, unit = {_quoted(unit)}{more} }}")
    if asked.inputs:
        lines += ["", "[inputs]"]
        lines += [f"{name} = {{ unit = {_quoted(asked.units[name])} }}" for name in asked.inputs]
    lines += ["", "[energy]", f'kinetic = "{written(parts.kinetic, naming)}"']
    if parts.potential != 0:
        lines.append(f'potential = "{written(parts.potential, naming)}"')
    for name, force in zip(asked.coordinates, parts.forces, strict=True):
        if force != 0:
            lines += ["", f"[elements.force_on_{name}]", 'kind = "law"', f'on = "{name}"']
            lines.append(f'{_key(asked.units[name])} = "{written(force, naming)}"')
    lines += ["", "[sensors]"]
    for name, (expression, unit) in asked.sensors.items():
        text = written(expression, naming)
        lines.append(f'{name} = {{ measures = "{text}", unit = {_quoted(unit)} }}')
    return lines


def _key(unit: str) -> str:
    """Under which key a force on a coordinate of a unit stands."""
    return "torque" if unit.strip() in ("rad", "deg", "°", "turn", "rev") else "force"


def _quoted(text: str) -> str:
    """A string of TOML."""
    plain = "".join(letter if letter.isprintable() else " " for letter in str(text))
    return '"' + plain.replace("\\", "\\\\").replace('"', '\\"') + '"'
