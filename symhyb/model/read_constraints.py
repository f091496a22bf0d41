"""Read the constraints of a model file: kind, places and values."""

from symhyb.errors import did_you_mean
from symhyb.model.constraints import CONSTRAINTS, Constraint, ConstraintKind
from symhyb.model.tables import Table, describe, shorten

PLAIN = {"zero": "equation", "rate": "nonholonomic"}  # keys that tell the kind


def read_constraint(table: Table) -> Constraint | None:
    """Read one constraint, None if its kind or what it holds together cannot be known."""
    plain = next((PLAIN[key] for key in PLAIN if key in table.entries), None)
    name = plain if plain and table.lacks("kind") else table.text("kind", required=True)
    if name is not None and name not in CONSTRAINTS:
        cure = did_you_mean(name, list(CONSTRAINTS))
        table.fault(f"'{shorten(name)}' is not a known kind of constraint{cure}", "kind")
    if name is None or name not in CONSTRAINTS:
        return None
    kind = CONSTRAINTS[name]
    keys = (*(key for key, _ in kind.places), *kind.keys, *(key for key, _ in kind.axes))
    table = table.checked(("kind", *keys, "about"))
    names = _names(table, kind)
    about = table.about()
    values = [(key, table.expression(key)) for key in kind.keys]
    for key in kind.needs:
        if table.lacks(key):
            table.fault(f"'{key}' is missing: a {name} needs it")
    given = {key: value for key, value in values if value is not None}
    axes = [(key, _axis(table, key, default)) for key, default in kind.axes]
    if names is None or any(key not in given for key in kind.needs):
        return None
    known = tuple((key, axis) for key, axis in axes if axis is not None)
    if len(known) < len(axes):
        return None
    return Constraint(table.path[-1], name, names, tuple(given.items()), about, known)


def _axis(table: Table, key: str, default: str) -> str | None:
    """x, y or z, None with a fault where the file says something else, or nothing."""
    if key not in table.entries and default:
        return default
    name = table.text(key, required=True)
    if name is not None and name not in ("x", "y", "z"):
        table.fault(f"'{shorten(name)}' is no axis: x, y or z", key)
        return None
    return name


def _names(table: Table, kind: ConstraintKind) -> tuple[str, ...] | None:
    """The names of all places of a kind, None with a fault where one is missing or wrong."""
    found: list[str] = []
    whole = True
    for key, count in kind.places:
        names = _listed(table, key, count, kind.section)
        whole = whole and names is not None
        found += names or ()
    if not whole:
        return None
    twice = [name for name in dict.fromkeys(found) if found.count(name) > 1]
    if twice:
        table.fault(f"names '{shorten(twice[0])}' twice, which says nothing", kind.places[-1][0])
        return None
    return tuple(found)


def _listed(table: Table, key: str, count: int, section: str) -> list[str] | None:
    noun = {"points": "point", "coordinates": "coordinate"}[section]
    if key not in table.entries:
        if table.lacks(key):
            what = f"a list of two {section}" if count > 1 else f"the name of a {noun}"
            table.fault(f"'{key}' is missing: {what}")
        return None
    if count == 1:
        name = table.text(key)
        return None if name is None else [name]
    value = table.entries[key]
    if not isinstance(value, list) or [type(name) for name in value] != [str] * count:
        table.fault(f"must be a list of two {section}, not {describe(value)}", key)
        return None
    return list(value)
