"""Read characteristic curves of a model file: points in the file itself, or in a CSV beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path

from symhyb.limits import CURVE_POINTS, VALUE
from symhyb.model.curve_file import points_in
from symhyb.model.curves import EXTRAPOLATIONS, INTERPOLATIONS, Curve
from symhyb.model.read_beside import by_name, disorder, report, text_beside, word_of, wrong_number
from symhyb.model.tables import Table, describe, shorten
from symhyb.units import Unit, UnitError, parse_unit

CURVE_KEYS = ("points", "file", "columns", "units", "interpolation", "extrapolation")
BY_STRETCH = "by_stretch"  # of an element: what its curve over the rate is multiplied by

Point = tuple[float, float]
Pair = tuple[str, str]


def read_curve(table: Table, home: Path | None) -> Curve | None:
    """Read one curve of ``[curves]``; ``home`` is the folder of the model file."""
    table = table.checked((*CURVE_KEYS, "about"))
    curve = read_points(table, home, table.path[-1])
    return None if curve is None else replace(curve, about=table.about())


def read_own(table: Table, home: Path | None, curves: Mapping[str, Curve | None]) -> Curve | None:
    """Read the curve of an element: its own, or by its name one of ``curves`` (None: one that
    could not be read)."""
    if "curve" not in table.entries:
        return read_points(table, home, f"elements.{table.path[-1]}")
    return by_name(table, "curve", "curve", curves, CURVE_KEYS)


def read_factor(
    table: Table, home: Path | None, curves: Mapping[str, Curve | None]
) -> Curve | None:
    """Read what a curve over the rate is multiplied by: a curve over the stretch in a table of its
    own, or by its name one of ``curves``; None where nothing is stated, or a fault is noted."""
    match table.entries.get(BY_STRETCH):
        case None:
            return None
        case str():
            return by_name(table, BY_STRETCH, "curve", curves)
        case dict():
            own = table.table(BY_STRETCH)
            assert own is not None
            named = f"elements.{table.path[-1]}.{BY_STRETCH}"
            return read_points(own.checked(CURVE_KEYS), home, named)
        case other:
            said = "must be a table with points and units, or the name of a curve"
            table.fault(f"{said}, not {describe(other)}", BY_STRETCH)
    return None


def read_points(table: Table, home: Path | None, name: str) -> Curve | None:
    """Read the keys of a curve, None if one of them is missing or wrong."""
    before = len(table.faults)
    interpolation = word_of(table, "interpolation", INTERPOLATIONS)
    extrapolation = word_of(table, "extrapolation", EXTRAPOLATIONS)
    stated, columns = _pair(table, "units"), _pair(table, "columns") or ()
    source = _Source()
    match [key for key in ("points", "file") if key in table.entries]:
        case ["points"]:
            source = _Source(_listed(table))
            if columns:
                table.fault("names columns of a 'file', which is not stated", "columns")
        case ["file"]:
            source = _from_file(table, home, columns)
        case [_, _]:
            table.fault("states 'points' and 'file'; a curve has one of them")
        case _ if table.lacks("points") and table.lacks("file"):
            table.fault("'points' is missing: a list of [x, y], or 'file' with such points")
    units = _units(table, stated, source) if source.points else None
    if units is None or len(table.faults) > before:
        return None
    curve = Curve(
        name,
        source.points,
        units,
        INTERPOLATIONS[interpolation],
        EXTRAPOLATIONS[extrapolation],
        source.file,
        columns,
        source.content,
    )
    return curve if _is_finite(table, curve, "file" if source.file else "points") else None


@dataclass(frozen=True, slots=True)
class _Source:
    """Where the points come from: a file with its text, and the units that its header states."""

    points: tuple[Point, ...] = ()
    file: str = ""
    content: str = ""
    headed: tuple[str | None, str | None] = (None, None)


def _pair(table: Table, key: str) -> Pair | None:
    """Read two texts, of x and of y."""
    match table.entries.get(key):
        case None:
            return None
        case [str() as first, str() as second]:
            return first, second
        case other:
            table.fault(f"must be a list of two texts, of x and of y, not {describe(other)}", key)
            return None


def _listed(table: Table) -> tuple[Point, ...]:
    """Read ``points = [[x, y], …]``."""
    given = table.entries["points"]
    if not isinstance(given, list):
        table.fault(f"must be a list of [x, y], not {describe(given)}", "points")
        return ()
    if not _count_is_sound(table, "points", len(given)):
        return ()
    inner = Table(table.path, table.entries, [])
    pairs = [inner.numbers(item, "points", 2, "[x, y]") for item in given]
    wrong = [(i, item) for i, item in enumerate(given, 1) if pairs[i - 1] is None]
    if wrong:
        report(table, "points", [f"point {i} {_not_a_point(item)}" for i, item in wrong])
        return ()
    points = tuple((pair[0], pair[1]) for pair in pairs if pair)
    places = [f"point {i + 1}" for i in range(len(points))]
    report(table, "points", list(disorder("x", [x for x, _ in points], places)))
    return points


def _not_a_point(item: object) -> str:
    if isinstance(item, list) and len(item) == 2:
        return f"holds {next(filter(None, map(wrong_number, item)))}"
    return f"must be [x, y], not {describe(item)}"


def _from_file(table: Table, home: Path | None, columns: Sequence[str]) -> _Source:
    """Read the points of the file beside the model file."""
    beside = text_beside(table, home)
    if beside is None:
        return _Source()
    file, content = beside
    found = points_in(content.removeprefix("\ufeff"), columns)
    places = [f"{file}:{line}:" for line in found.lines]
    if found.faults:
        told = [f"{file}{f':{line}' if line else ''}: {text}" for line, text in found.faults]
        report(table, "file", told)
    elif _count_is_sound(table, "file", len(found.points)):
        report(table, "file", list(disorder("x", [x for x, _ in found.points], places)))
        return _Source(found.points, file, content, found.units)
    return _Source()


def _count_is_sound(table: Table, key: str, count: int) -> bool:
    if count < 2:
        few = "no point" if count == 0 else "one point"
        table.fault(f"holds {few}; a curve has two at least", key)
    elif count > CURVE_POINTS:
        table.fault(f"holds {count} points; a curve has at most {CURVE_POINTS}: thin it out", key)
    return 2 <= count <= CURVE_POINTS


def _units(table: Table, stated: Pair | None, source: _Source) -> tuple[Unit, Unit] | None:
    """The units of x and y: those stated, else those of the header; both must not differ."""
    units: list[Unit] = []
    for i, axis in enumerate("xy"):
        own, headed = stated[i] if stated else None, source.headed[i]
        text = headed if own is None else own
        if text is None:
            if not any(key.startswith("units") for key in (*table.entries, *table.excused)):
                also = ", or brackets in the first line of the file" if source.file else ""
                usage = 'units = ["m/s", "N"]'
                table.fault(f"the unit of {axis} is missing: {usage}{also}")
            continue
        key = "file" if own is None else "units"
        try:
            unit, other = parse_unit(text), parse_unit(headed or text)
        except UnitError as error:
            table.fault(str(error), key)
            continue
        if unit.dimension != other.dimension or unit.factor != other.factor:
            sentence = f"'{shorten(text)}' of {axis} is '{shorten(str(headed))}' in {source.file}"
            table.fault(f"{sentence}; state it once", "units")
            continue
        units.append(unit)
    return (units[0], units[1]) if len(units) == 2 else None


def _is_finite(table: Table, curve: Curve, key: str) -> bool:
    """Values that are no measurement, and neighbours so close that the slope is not finite."""
    for axis, unit, values in zip("xy", curve.units, zip(*curve.points, strict=True), strict=True):
        largest = max(values, key=abs)
        if abs(largest * unit.factor) > VALUE:
            table.fault(f"{axis} = {largest:g} is no measurement; at most {VALUE:g} in SI", key)
            return False
    numbers = (c for piece in curve.characteristic.area().pieces for c in piece)
    if all(map(isfinite, numbers)):
        return True
    table.fault("holds points so close to each other that no slope is finite between them", key)
    return False
