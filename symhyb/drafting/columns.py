"""What the columns of a recording may be in a model: guesses, each with what it rests on."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from symhyb.data.columns import TIMES
from symhyb.data.files.table import Column, Table
from symhyb.model.expression import RESERVED
from symhyb.model.types import Model
from symhyb.units import Unit, UnitError, parse_unit

GRAVITY = "g"  # as a unit: of an accelerometer, not a gram
_ACTS = re.compile(r"force|torque|current|volt|drive|motor|command|input|tau|^[fui]\d*$", re.I)
_ORDERS = (
    (2, re.compile(r"acc", re.I)),
    (1, re.compile(r"vel|speed|rate|omega|gyro|^v\d*$|dot", re.I)),
    (0, re.compile(r"pos|disp|ang|enc|travel|laser|deflect|^[xyzq]\d*$|phi|theta", re.I)),
)


@dataclass(frozen=True, slots=True)
class Role:
    """What a ``column`` (its header) is in a model: ``kind`` is ``sensor``, ``input`` or ``none``.

    A sensor has the ``name`` that it gets, what it ``measures`` and its ``unit``; an input the
    ``name`` that the model has for it. ``source`` is what stands in a map, empty where the names
    agree. ``guessed`` says what nobody has stated, empty where it was confirmed.
    """

    column: str
    kind: str
    name: str = ""
    measures: str = ""
    unit: str = ""
    source: str = ""
    guessed: str = ""


def guessed_roles(table: Table, model: Model) -> tuple[Role, ...]:
    """What each column of numbers of a table may be; the time is none of them."""
    roles: list[Role] = []
    for column in table.columns:
        if column.problem is None and column.values.ndim == 1 and not _is_time(column):
            roles.append(_role(column, model, roles))
    return tuple(roles)


def _is_time(column: Column) -> bool:
    small = column.name.lower()
    return small in ("t", "index") or any(
        small == one or small.startswith((f"{one}_", f"{one} ")) for one in TIMES
    )


def _role(column: Column, model: Model, taken: Sequence[Role]) -> Role:
    unit, free = unit_in(column), free_inputs(model, taken)
    named = [name for name in free if name == column.name]
    alike = [item.name for item in model.inputs if item.name in free and _fits(unit, item.unit)]
    if named or (_ACTS.search(column.name) and free) or (unit and alike and not _measures(column)):
        name = (named or alike or free)[0]
        return as_input(column, name, model, "" if named else "which input this is")
    sensors = {sensor.name: sensor for sensor in model.sensors}
    if column.name in sensors:
        known = sensors[column.name]
        if unit is not None and unit.same_dimension(known.unit):
            return as_sensor(column, known.measures.text, unit.text, model, taken)
        sensor = as_sensor(column, known.measures.text, known.unit.text, model, taken)
        return replace(sensor, guessed="its unit")
    found = _reading(column, unit, model, taken)
    if found is None:
        return Role(column.header, "none", guessed="what it measures is not known")
    measures, stated, why = found
    return replace(as_sensor(column, measures, stated, model, taken), guessed=why)


def as_input(column: Column, name: str, model: Model, guessed: str = "") -> Role:
    """A column as the input of that name."""
    unit = next(item.unit.text for item in model.inputs if item.name == name)
    stated = unit_in(column)
    if stated is None:
        guessed = f"{guessed}; " * bool(guessed) + f"that it is in {unit}"
    source = column.header if column.name != name else ""
    return Role(column.header, "input", name, "", unit, source, guessed)


def as_sensor(
    column: Column, measures: str, unit: str, model: Model, taken: Sequence[Role]
) -> Role:
    """A column as a sensor that measures an expression, under a name that a model file can have."""
    used = {*RESERVED, *(c.name for c in model.coordinates), *(p.name for p in model.parameters)}
    used |= {item.name for item in model.inputs} | {role.name for role in taken}
    name = re.sub(r"\W+", "_", column.name, flags=re.ASCII).strip("_") or "channel"
    name = name if name[0].isalpha() else f"channel_{name}"
    base, number = name, 2
    while name in used:
        name, number = f"{base}_{number}" if number > 2 else f"{base}_sensor", number + 1
    source = column.header if name != column.name else ""
    return Role(column.header, "sensor", name, measures, unit, source)


def free_inputs(model: Model, taken: Sequence[Role]) -> list[str]:
    """The inputs of a model that no column is yet."""
    used = {role.name for role in taken if role.kind == "input"}
    return [item.name for item in model.inputs if item.name not in used]


def unit_in(column: Column) -> Unit | None:
    """The unit in the header of a column, None where there is none that is known."""
    if column.unit is None:
        return None
    if column.unit.strip() == GRAVITY:
        return parse_unit("m/s^2")
    try:
        return parse_unit(column.unit)
    except UnitError:
        return None


def _fits(unit: Unit | None, other: Unit) -> bool:
    return unit is None or unit.same_dimension(other)


def _measures(column: Column) -> bool:
    return any(pattern.search(column.name) for _, pattern in _ORDERS)


def _reading(
    column: Column, unit: Unit | None, model: Model, taken: Sequence[Role]
) -> tuple[str, str, str] | None:
    """What a column measures, in which unit, and what of it is guessed; None if neither says it."""
    second, done = parse_unit("s"), {role.measures for role in taken}
    fitting: list[tuple[int, str, str]] = []
    for order in _orders(column, unit):
        for coordinate in model.coordinates:
            own = coordinate.unit
            for _ in range(order):
                own = own / second
            if _fits(unit, own):
                rank = (coordinate.name.lower() not in column.name.lower()) * 2
                text = coordinate.name + "'" * order
                fitting.append((rank + (text in done), text, own.text))
        if fitting:
            break
    if not fitting:
        return None
    _, measures, own_unit = min(fitting, key=lambda one: one[0])
    if unit is None:
        return measures, own_unit, f"that it measures {measures}, and its unit"
    text = "m/s^2" if (column.unit or "").strip() == GRAVITY else unit.text
    return measures, text, f"that it measures {measures}"


def _orders(column: Column, unit: Unit | None) -> Iterator[int]:
    """How often a coordinate may be differentiated to give the column: as its name says, else, if
    its unit says so, in any order."""
    named = next((order for order, pattern in _ORDERS if pattern.search(column.name)), None)
    if named is not None:
        yield named
    if unit is not None:
        yield from (order for order in (0, 1, 2) if order != named)
