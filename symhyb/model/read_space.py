"""Read what only a model in space says: how a body is turned, and its tensor of inertia.

A model is in space where its vectors have three components. The first vector of the file decides
(gravity, then points, then bodies); all others must be of its size.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from symhyb.errors import did_you_mean
from symhyb.laws.base import Key, Law
from symhyb.model.expression import Expression
from symhyb.model.tables import Table, describe, shorten
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import Vector

AXES = ("x", "y", "z")
_STEP = 'a list of [axis, angle], as in [["z", "psi"], ["y", "theta"], ["x", "phi"]]'


def dimension_of(document: Mapping[str, object]) -> int:
    """Return how many components the vectors of a parsed file have: 2, or 3 in space."""
    return next((len(found) for found in _vectors(document) if len(found) in (2, 3)), 2)


def _vectors(document: Mapping[str, object]) -> Iterator[list[object]]:
    gravity = document.get("gravity")
    if isinstance(gravity, list):
        yield gravity
    for section, keys in (("points", ("at",)), ("bodies", ("joint", "at"))):
        entries = document.get(section)
        for entry in entries.values() if isinstance(entries, dict) else ():
            if isinstance(entry, list) and section == "points":
                yield entry
            for key in keys if isinstance(entry, dict) else ():
                if isinstance(entry.get(key), list):
                    yield entry[key]


def read_turned(table: Table) -> Rotations | Quaternion | None:
    """Read ``rotations`` or ``quaternion`` of a body, None if it has neither."""
    if "rotations" in table.entries and "quaternion" in table.entries:
        table.fault("is turned by 'rotations' and by 'quaternion'; one of them is enough")
        return None
    if "rotations" in table.entries:
        return _rotations(table)
    return _quaternion(table) if "quaternion" in table.entries else None


def _rotations(table: Table) -> Rotations | None:
    value = table.entries["rotations"]
    if not isinstance(value, list) or not value:
        table.fault(f"must be {_STEP}, not {describe(value)}", "rotations")
        return None
    steps: list[tuple[str, Expression]] = []
    for step in value:
        if not isinstance(step, list) or len(step) != 2:
            table.fault(f"must be {_STEP}; one of its items is {describe(step)}", "rotations")
            continue
        axis, angle = step[0], table.as_expression(step[1], "rotations")
        if axis not in AXES:
            cure = "a body turns about 'x', 'y' or 'z' of its own axes"
            table.fault(f"has the axis {describe(axis)}; {cure}", "rotations")
        elif angle is not None:
            steps.append((axis, angle))
    return Rotations(tuple(steps)) if len(steps) == len(value) else None


def _quaternion(table: Table) -> Quaternion | None:
    value = table.entries["quaternion"]
    if isinstance(value, list) and len(value) == 4 and all(isinstance(n, str) for n in value):
        return Quaternion(tuple(str(name) for name in value))
    sentence = 'must be a list of four coordinates, as in ["qw", "qx", "qy", "qz"]'
    table.fault(f"{sentence}, not {describe(value)}", "quaternion")
    return None


def read_inertia(table: Table) -> tuple[Expression | None, Vector]:
    """Read ``inertia``: one value for every axis, or a list of three or six (the tensor)."""
    value = table.entries.get("inertia")
    if not isinstance(value, list):
        return table.expression("inertia"), ()
    if len(value) not in (3, 6):
        kinds = "one value, three principal ones or six (Jxx, Jyy, Jzz, Jxy, Jxz, Jyz)"
        table.fault(f"must be {kinds}, not {describe(value)}", "inertia")
        return None, ()
    return None, table.expressions(value, "inertia") or ()


def kind_in(kind: Law, dimension: int) -> Law:
    """Return a kind as it is in a model of this dimension: in space a torque may be a vector, at a
    point that is fixed to a body."""
    if dimension == 2 or kind.name != "torque":
        return kind
    keys = tuple(_vectorial(key) for key in kind.keys)
    return replace(kind, keys=keys, placements=("on", "at"))


def _vectorial(key: Key) -> Key:
    return replace(key, placements=("on", "at"), vector=True)


def read_axes(table: Table, bodies: list[str], dimension: int) -> tuple[tuple[str, str], ...]:
    """Read ``axes`` of a force at a point in space: the body in whose axes it is given."""
    body = table.text("axes")
    if body is None:
        return ()
    if dimension == 2:
        table.fault("is for forces in space; in the plane they are in the inertial axes", "axes")
        return ()
    if body not in bodies:
        cure = did_you_mean(body, bodies)
        table.fault(f"'{shorten(body)}' is not a known body{cure}", "axes")
        return ()
    return (("axes", body),)
