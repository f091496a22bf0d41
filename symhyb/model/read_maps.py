"""Read maps of a model file: a grid in the file itself, or in a CSV beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite
from pathlib import Path

from symhyb.limits import MAP_PLACES, VALUE
from symhyb.model.curves import EXTRAPOLATIONS
from symhyb.model.map_file import Gridded, grid_in
from symhyb.model.maps import Map
from symhyb.model.read_beside import by_name, disorder, report, text_beside, word_of, wrong_number
from symhyb.model.tables import Table, describe
from symhyb.units import Unit, UnitError, parse_unit

GRID_KEYS = ("x", "y", "values")
MAP_KEYS = (*GRID_KEYS, "file", "units", "extrapolation")


def read_map(table: Table, home: Path | None) -> Map | None:
    """Read one map of ``[maps]``; ``home`` is the folder of the model file."""
    table = table.checked((*MAP_KEYS, "about"))
    found = _read(table, home, table.path[-1])
    return None if found is None else replace(found, about=table.about())


def read_own_map(table: Table, home: Path | None, maps: Mapping[str, Map | None]) -> Map | None:
    """Read the map of an element: its own, or by its name one of ``maps`` (None: one that could not
    be read)."""
    if "map" not in table.entries:
        return _read(table, home, f"elements.{table.path[-1]}")
    return by_name(table, "map", "map", maps, MAP_KEYS)


def _read(table: Table, home: Path | None, name: str) -> Map | None:
    """Read the keys of a map, None if one of them is missing or wrong."""
    before = len(table.faults)
    extrapolation = EXTRAPOLATIONS[word_of(table, "extrapolation", EXTRAPOLATIONS)]
    units = _units(table)
    given = [key for key in GRID_KEYS if key in table.entries]
    file, content = "", ""
    if "file" in table.entries:
        if given:
            table.fault(f"states '{given[0]}' and 'file'; the grid of a map stands in one place")
            return None
        beside = text_beside(table, home)
        if beside is None:
            return None
        file, content = beside
        grid = _of_file(table, file, content)
    else:
        grid = _listed(table)
    if grid is None or units is None or len(table.faults) > before:
        return None
    found = Map(name, grid.x, grid.y, grid.values, units, extrapolation, file, content)
    return found if _is_finite(table, found, "file" if file else "values") else None


def _units(table: Table) -> tuple[Unit, Unit, Unit] | None:
    """Read the units of x, y and the value."""
    match table.entries.get("units"):
        case None:
            if table.lacks("units"):
                table.fault('the units are missing: units = ["mm", "m/s", "N"], of x, y and value')
            return None
        case [str() as x, str() as y, str() as up]:
            pass
        case other:
            shape = "a list of three texts, of x, y and value"
            table.fault(f"must be {shape}, not {describe(other)}", "units")
            return None
    try:
        return parse_unit(x), parse_unit(y), parse_unit(up)
    except UnitError as error:
        table.fault(str(error), "units")
        return None


def _of_file(table: Table, file: str, content: str) -> Gridded | None:
    """Check the grid of a file."""
    grid = grid_in(content.removeprefix("\ufeff"))
    if grid.faults:
        said = [f"{file}{f':{line}' if line else ''}: {text}" for line, text in grid.faults]
        report(table, "file", said)
        return None
    sound = [_count_is_sound(table, "file", *axis) for axis in (("x", grid.x), ("y", grid.y))]
    report(table, "file", list(disorder("x", grid.x, [f"{file}:{line}:" for line in grid.lines])))
    report(table, "file", list(disorder("y", grid.y, [f"{file}:{grid.head}:"] * len(grid.y))))
    return grid if all(sound) else None


def _listed(table: Table) -> Gridded | None:
    """Read ``x``, ``y`` and ``values``, a row of values for each x."""
    missing = [key for key in GRID_KEYS if table.lacks(key)]
    if missing:
        usage = "x and y with a row of 'values' for each x, or 'file' with such a grid"
        named = " and ".join(f"'{key}'" for key in missing)
        table.fault(f"{named} {'is' if len(missing) == 1 else 'are'} missing: {usage}")
        return None
    x, y = (_places(table, key) for key in ("x", "y"))
    rows = table.entries.get("values")
    if rows is None or x is None or y is None:
        return None
    if not isinstance(rows, list) or len(rows) != len(x):
        table.fault(f"must be {len(x)} rows, one for each x, not {describe(rows)}", "values")
        return None
    wrong = [f"row {i} {said}" for i, row in enumerate(rows, 1) if (said := _not_a_row(row, y))]
    report(table, "values", wrong)
    return None if wrong else Gridded(x, y, tuple(tuple(map(float, row)) for row in rows))


def _places(table: Table, key: str) -> tuple[float, ...] | None:
    """Read the places along an axis, in increasing order."""
    given = table.entries.get(key)
    if given is None:
        return None
    if not isinstance(given, list):
        table.fault(f"must be a list of numbers, not {describe(given)}", key)
        return None
    if not _count_is_sound(table, key, key, given):
        return None
    wrong = [
        f"place {i} is {said}" for i, one in enumerate(given, 1) if (said := wrong_number(one))
    ]
    numbers = () if wrong else tuple(map(float, given))
    names = [f"place {i + 1}" for i in range(len(numbers))]
    wrong += disorder(key, numbers, names)
    report(table, key, wrong)
    return None if wrong else numbers


def _not_a_row(row: object, y: Sequence[float]) -> str:
    if not isinstance(row, list):
        return f"must be a list of {len(y)} numbers, not {describe(row)}"
    if len(row) != len(y):
        return f"holds {len(row)} values; y has {len(y)} places"
    wrong = next(filter(None, map(wrong_number, row)), "")
    return f"holds {wrong}" if wrong else ""


def _count_is_sound(table: Table, key: str, axis: str, places: Sequence[object]) -> bool:
    count = len(places)
    if count < 2:
        table.fault(f"holds {('no', 'one')[count]} place of {axis}; a map has two at least", key)
    elif count > MAP_PLACES:
        most = f"a map has at most {MAP_PLACES}: thin it out"
        table.fault(f"holds {count} places of {axis}; {most}", key)
    return 2 <= count <= MAP_PLACES


def _is_finite(table: Table, found: Map, key: str) -> bool:
    """Values that are no measurement, and neighbours so close that the slope is not finite."""
    every = (found.x, found.y, [value for row in found.values for value in row])
    for axis, unit, numbers in zip(("x", "y", "value"), found.units, every, strict=True):
        largest = max(numbers, key=abs)
        if abs(largest * unit.factor) > VALUE:
            table.fault(f"{axis} = {largest:g} is no measurement; at most {VALUE:g} in SI", key)
            return False
    surface = found.surface
    most = max(1.0, max(abs(value) for row in surface.values for value in row))
    hats = (*surface.over_x, *surface.over_y)
    if all(isfinite(most * c) for hat in hats for piece in hat.pieces for c in piece):
        return True
    table.fault("holds places so close to each other that no slope is finite between them", key)
    return False
