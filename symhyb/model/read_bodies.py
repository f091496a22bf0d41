"""Read the points and bodies of a model file: where they are, and what they hang on."""

from symhyb.errors import did_you_mean
from symhyb.model.expression import parse_expression
from symhyb.model.read_space import read_inertia, read_turned
from symhyb.model.tables import Table, describe, shorten
from symhyb.model.types import Body, Point, Vector

_KEYS = ("mass", "at", "inertia", "angle", "about", "parent", "joint", "rotations", "quaternion")
_TURNING = ("angle", "rotations", "quaternion")


def read_point(table: Table, name: str) -> Point | None:
    """Read a point: a list of two expressions, or a table with its ``body``."""
    value = table.entries[name]
    if isinstance(value, list):
        at = table.vector(name)
        return None if at is None else Point(name, at)
    if not isinstance(value, dict):
        sentence = "must be a list of two expressions or a table with 'body' and 'at'"
        table.fault(f"{sentence}, not {describe(value)}", name)
        return None
    inner = Table((*table.path, name), value, table.faults).checked(("body", "at", "about"))
    body, about = inner.text("body"), inner.about()
    at = inner.vector("at") if "at" in inner.entries else None
    if inner.lacks("at"):
        inner.fault("'at' is missing: a list of two expressions")
    if at is None or (body is None and "body" in value):
        return None
    return Point(name, at, body or "", about)


def read_body(
    table: Table, root: Table, points: tuple[Point, ...], dimension: int = 2
) -> Body | None:
    """Read one body; ``points`` are those that could be read, vectors have ``dimension``
    components."""
    table = table.checked(_KEYS)
    mass, about = table.expression("mass", required=True), table.about()
    (inertia, tensor), angle = read_inertia(table), table.expression("angle")
    turned = read_turned(table)
    if turned is None and any(key in table.entries for key in ("rotations", "quaternion")):
        return None
    hung = not (table.lacks("parent") and table.lacks("joint"))
    parent = table.text("parent")
    _turning_faults(table, hung, dimension)
    if not hung:
        placed = _standing(table, root, points)
        if mass is None or placed is None:
            return None
        at, parent, joint = placed
        return Body(table.path[-1], mass, at, inertia, angle, about, parent, joint, turned, tensor)
    joint = _joint(table, root, points, dimension)
    own = _own_place(table, root, points, dimension)
    unread = parent is None and not table.lacks("parent")
    if mass is None or joint is None or own is None or unread:
        return None
    name = table.path[-1]
    return Body(name, mass, own, inertia, angle, about, parent or "", joint, turned, tensor)


def _gives(table: Table, key: str) -> bool:
    return key in table.entries


def _turning_faults(table: Table, hung: bool, dimension: int) -> None:
    """A body that turns needs ``inertia`` and ``angle``; one that hangs may lack either."""
    turns = [key for key in _TURNING if _gives(table, key)]
    still = not turns and all(table.lacks(key) for key in _TURNING)
    if _gives(table, "inertia") and still and table.lacks("parent"):
        missing = "'angle'; say which angle turns the body"
        if dimension == 3:
            missing = "'rotations' or 'quaternion'; say what turns the body"
        table.fault(f"has 'inertia' but no {missing}")
    if turns and table.lacks("inertia") and not hung:
        table.fault(f"has '{turns[0]}' but no 'inertia'")


def _standing(
    table: Table, root: Table, points: tuple[Point, ...]
) -> tuple[Vector, str, Vector | None] | None:
    """Read ``at`` of a body without a joint: its place, and the body that carries the point there
    with the joint that this makes."""
    if table.lacks("at"):
        table.fault("'at' is missing: the name of a point or a list of two expressions")
        return None
    if not isinstance(table.entries.get("at"), str):
        vector = table.vector("at") if _gives(table, "at") else None
        return None if vector is None else (vector, "", None)
    point = _named_point(table, "at", root, points)
    if point is None:
        return None
    if not point.body:
        return point.at, "", None
    carried = f"the point '{point.name}' is fixed to the body '{point.body}'"
    if point.body == table.path[-1]:
        table.fault(f"{carried}: its place follows from this body, not the reverse", "at")
        return None
    if any(_gives(table, key) for key in (*_TURNING, "inertia")):
        cure = f'write parent = "{point.body}" and joint = "{point.name}" instead of \'at\''
        table.fault(f"{carried}, where only a point mass can sit; {cure}", "at")
        return None
    return _zero(len(point.at)), point.body, point.at


def _joint(table: Table, root: Table, points: tuple[Point, ...], dimension: int) -> Vector | None:
    """Read ``joint``: a point of the parent by name, or two expressions in the parent's axes."""
    if not _gives(table, "joint"):
        return _zero(dimension) if table.lacks("joint") else None
    if not isinstance(table.entries["joint"], str):
        return table.vector("joint")
    point = _named_point(table, "joint", root, points)
    if point is None:
        return None
    own, parent = table.path[-1], table.entries.get("parent", "")
    if point.body == parent or not isinstance(parent, str):
        return point.at
    if point.body == own:
        sentence = f"the point '{point.name}' is fixed to this body itself"
        table.fault(f"{sentence}; a joint is a point of what the body hangs on", "joint")
    elif not point.body:
        sentence = f"the point '{point.name}' is not fixed to '{shorten(parent)}'"
        cure = f"leave 'parent' out, or declare the point with body = \"{shorten(parent)}\""
        table.fault(f"{sentence}; {cure}", "joint")
    else:
        ground = f"'{shorten(parent)}'" if parent else "the ground"
        sentence = f"the point '{point.name}' is fixed to the body '{point.body}', not to {ground}"
        table.fault(f'{sentence}; write parent = "{point.body}"', "joint")
    return None


def _own_place(
    table: Table, root: Table, points: tuple[Point, ...], dimension: int
) -> Vector | None:
    """Read ``at`` of a body that hangs: its centre of mass in its own axes."""
    if not _gives(table, "at"):
        return _zero(dimension) if table.lacks("at") else None
    if not isinstance(table.entries["at"], str):
        return table.vector("at")
    point = _named_point(table, "at", root, points)
    if point is None:
        return None
    if point.body != table.path[-1]:
        where = f"to the body '{point.body}'" if point.body else "to the ground"
        sentence = f"the point '{point.name}' is fixed {where}"
        table.fault(f"{sentence}; the centre of a body that hangs is in its own axes", "at")
        return None
    return point.at


def _named_point(table: Table, key: str, root: Table, points: tuple[Point, ...]) -> Point | None:
    """Find the point that a key names; one that could not be read is no second fault."""
    name, known = str(table.entries[key]), root.declared("points")
    if name not in known:
        table.fault(f"'{shorten(name)}' is not a known point{did_you_mean(name, known)}", key)
    return next((point for point in points if point.name == name), None)


def _zero(dimension: int) -> Vector:
    return (parse_expression("0"),) * dimension
