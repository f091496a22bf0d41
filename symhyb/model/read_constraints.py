"""Read the constraints of a model file: kind, places and values."""

from symhyb.errors import did_you_mean
from symhyb.model.constraints import CONSTRAINTS, Constraint, ConstraintKind
from symhyb.model.tables import Table, describe, shorten


def read_constraint(table: Table) -> Constraint | None:
    """Read one constraint, None if its kind or what it holds together cannot be told."""
    plain = "zero" in table.entries and table.lacks("kind")
    name = "equation" if plain else table.text("kind", required=True)
    if name is not None and name not in CONSTRAINTS:
        cure = did_you_mean(name, list(CONSTRAINTS))
        table.fault(f"'{shorten(name)}' is not a known kind of constraint{cure}", "kind")
    if name is None or name not in CONSTRAINTS:
        return None
    kind = CONSTRAINTS[name]
    table = table.checked(("kind", *(key for key, _ in kind.places), *kind.keys, "about"))
    names = _names(table, kind)
    about = table.about()
    values = [(key, table.expression(key)) for key in kind.keys]
    for key in kind.needs:
        if table.lacks(key):
            table.fault(f"'{key}' is missing: a {name} needs it")
    given = {key: value for key, value in values if value is not None}
    if names is None or any(key not in given for key in kind.needs):
        return None
    return Constraint(table.path[-1], name, names, tuple(given.items()), about)


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
