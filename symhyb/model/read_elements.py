"""Read the elements of a model file: kind, place, values and their own parameters."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from symhyb.errors import did_you_mean
from symhyb.laws.base import Key, Law
from symhyb.model.curves import Curve
from symhyb.model.expression import Expression, Name
from symhyb.model.maps import Map
from symhyb.model.read_curves import BY_STRETCH, CURVE_KEYS, read_factor, read_own
from symhyb.model.read_maps import MAP_KEYS, read_own_map
from symhyb.model.read_network import NETWORK_KEYS, read_network
from symhyb.model.read_space import kind_in, read_axes
from symhyb.model.tables import Table, describe, shorten
from symhyb.model.types import At, Between, Element, On, Pair, Parameter, Place
from symhyb.model.vocabulary import KINDS, placement_of

NO_CURVES: Mapping[str, Curve | None] = {}
NO_MAPS: Mapping[str, Map | None] = {}
_MORE_KEYS: Mapping[str, Sequence[str]] = {
    "network": NETWORK_KEYS,
    "curve": ("curve", BY_STRETCH, *CURVE_KEYS),
    "map": ("map", *MAP_KEYS),
}
_PLACES = ("on", "between", "at", "pair")
_COMMON = ("kind", *_PLACES, "about", "found", "parameters")


def read_parameter(table: Table, owner: str = "") -> Parameter | None:
    """Read one parameter; with a wrong value it stays known by its unit."""
    table = table.checked(("value", "unit", "sd", "about", "was"))
    value, unit = table.number("value", required=True), table.unit()
    sd, was, about = table.deviation(), table.number("was"), table.about()
    if unit is None:
        return None
    return Parameter(table.path[-1], 1.0 if value is None else value, unit, sd, about, was, owner)


def read_element(
    table: Table,
    root: Table,
    dimension: int = 2,
    home: Path | None = None,
    curves: Mapping[str, Curve | None] = NO_CURVES,
    maps: Mapping[str, Map | None] = NO_MAPS,
) -> Element | None:
    """Read one element, None if its kind or place cannot be known; vectors have ``dimension``
    components. Files lie in the folder ``home``; ``curves`` and ``maps`` are those of the model by
    name."""
    kind = _kind(table)
    if kind is None:
        return None
    kind = kind_in(kind, dimension)
    trained, curved, mapped = (kind.name == one for one in ("network", "curve", "map"))
    vectorial = any(key.vector for key in kind.keys) and "at" in table.entries
    axes_keys = ("axes",) if vectorial and "axes" in table.entries else ()
    own_keys = (*(key.name for key in kind.keys), *_MORE_KEYS.get(kind.name, ()), *axes_keys)
    table = table.checked((*_COMMON, *own_keys))
    place = _place(table, kind)
    owner = table.path[-1]
    parameters = tuple(read_parameter(inner, owner) for inner in table.tables("parameters"))
    about, found = table.about(), table.table("found")
    network = read_network(table) if trained else None
    curve = read_own(table, home, curves) if curved else None
    by_stretch = read_factor(table, home, curves) if curved else None
    own_map = read_own_map(table, home, maps) if mapped else None
    if place is None:
        return None
    values, options = _values(table, kind, place), _options(table, kind)
    options += read_axes(table, root.declared("bodies"), dimension) if axes_keys else ()
    unread = by_stretch is None and BY_STRETCH in table.entries
    if (trained and network is None) or (curved and (curve is None or unread)):
        return None
    if mapped and own_map is None:
        return None
    if None in parameters:  # the fault is noted; without its unit the laws cannot be checked
        return None
    return Element(
        name=owner,
        kind=kind.name,
        place=place,
        values=values,
        parameters=tuple(parameter for parameter in parameters if parameter),
        found=tuple((key, _frozen(value)) for key, value in found.entries.items()) if found else (),
        about=about,
        options=options,
        network=network,
        curve=curve,
        by_stretch=by_stretch,
        map=own_map,
    )


def _kind(table: Table) -> Law | None:
    name = table.text("kind", required=True)
    if name is None or name in KINDS:
        return KINDS[name] if name else None
    table.fault(f"'{shorten(name)}' is not a known kind{did_you_mean(name, list(KINDS))}", "kind")
    return None


def _place(table: Table, kind: Law) -> Place | None:
    """Read ``on``, ``between``, ``at`` or ``pair``; exactly one of them, and one that the kind can
    have."""
    given = [key for key in _PLACES if key in table.entries]
    allowed = " or ".join(f"'{key}'" for key in kind.placements)
    if len(given) > 1:
        listed = " and ".join(f"'{key}'" for key in given)
        table.fault(f"stands {listed}; an element has one place")
        return None
    if not given:
        if not set(table.excused) & set(kind.placements):
            table.fault(f"the place is missing: {allowed}")
        return None
    if given[0] not in kind.placements:
        table.fault(f"kind '{kind.name}' cannot stand '{given[0]}'; it needs {allowed}", given[0])
        return None
    if given[0] == "between":
        return _between(table)
    if given[0] == "pair":
        return _pair(table)
    name = table.text(given[0])
    if name is None:
        return None
    return _on(table, name) if given[0] == "on" else At(name)


def _on(table: Table, text: str) -> On | None:
    """Read a coordinate or an expression of coordinates; which they are is checked later."""
    stretch = _stretch(table, text, "on")
    return None if stretch is None else On(stretch)


def _stretch(table: Table, text: str, key: str) -> str | None:
    """A stretch as it was written; of a coordinate alone its name."""
    expression = table.as_expression(text, key)
    if expression is None:
        return None
    match expression.tree:
        case Name(name, 0):
            return name
    return text


def _pair(table: Table) -> Pair | None:
    """Read two stretches, each a coordinate or an expression of coordinates."""
    given = table.entries.get("pair")
    if not isinstance(given, list) or [type(one) for one in given] != [str, str]:
        table.fault(f"must be a list of two coordinates, not {describe(given)}", "pair")
        return None
    first, second = (_stretch(table, text, "pair") for text in given)
    if first is None or second is None:
        return None
    if first == second:
        table.fault(f"couples '{shorten(first)}' with itself", "pair")
        return None
    return Pair(first, second)


def _between(table: Table) -> Place | None:
    names = table.entries.get("between")
    if not isinstance(names, list) or [type(name) for name in names] != [str, str]:
        table.fault(f"must be a list of two points, not {describe(names)}", "between")
        return None
    if names[0] == names[1]:
        table.fault(f"goes from the point '{shorten(names[0])}' to itself", "between")
        return None
    return Between(names[0], names[1])


def _values(table: Table, kind: Law, place: Place) -> tuple[tuple[str, Expression], ...]:
    """Read the keys of the kind, in the order of the kind, and say which are missing."""
    placement = placement_of(place)
    values: list[tuple[str, Expression]] = []
    for key in kind.keys:
        if key.name not in table.entries or key.choices:
            continue
        if placement not in key.placements:
            where = " or ".join(f"'{name}'" for name in key.placements)
            table.fault(f"'{key.name}' is for an element {where}, not '{placement}'", key.name)
            continue
        values += _value(table, key, placement)
    _complete(table, kind, placement)
    return tuple(values)


def _value(table: Table, key: Key, placement: str) -> list[tuple[str, Expression]]:
    if key.vector and placement == "at":
        vector = table.vector(key.name) or ()
        return [(f"{key.name}.{axis}", part) for axis, part in zip("xyz", vector, strict=False)]
    value = table.expression(key.name)
    return [(key.name, value)] if value else []


def _options(table: Table, kind: Law) -> tuple[tuple[str, str], ...]:
    """Read the keys that take one of several words."""
    options: list[tuple[str, str]] = []
    for key in kind.keys:
        word = table.text(key.name) if key.choices else None
        if word in key.choices:
            options.append((key.name, str(word)))
        elif word is not None:
            cure = did_you_mean(word, key.choices)
            listed = ", ".join(key.choices)
            known = cure if "did you mean" in cure else f"; it is one of {listed}"
            table.fault(f"'{shorten(word)}' is not a word for it{known}", key.name)
    return tuple(options)


def _complete(table: Table, kind: Law, placement: str) -> None:
    """Check that the element has a strength, and only one where it is a signal."""
    usable = [
        key for key in kind.keys if key.name in kind.strengths and placement in key.placements
    ]
    given = [key for key in usable if key.name in table.entries]
    listed = " or ".join(f"'{key.name}'" for key in usable)
    elsewhere = any(name in table.entries for name in kind.strengths)
    if usable and not given and not elsewhere and not set(table.excused) & set(kind.strengths):
        table.fault(f"kind '{kind.name}' needs {listed}")
    if len(given) > 1 and given[0].signal:
        table.fault(f"kind '{kind.name}' takes only one of {listed}")
    for name in kind.needs:
        faulted = name in kind.strengths and not given  # by the sentence above
        if table.lacks(name) and not faulted:
            about = kind.key(name)
            reason = f": {about.about}" if about and about.about else ""
            table.fault(f"kind '{kind.name}' needs '{name}'{reason}")
    if "static" in table.entries and kind.key("stribeck") and table.lacks("stribeck"):
        table.fault("'static' needs 'stribeck', the speed at which it falls to 'coulomb'")
    for name, other, grows in _TOGETHER:
        if name in table.entries and kind.key(other) and table.lacks(other):
            table.fault(f"'{name}' needs '{other}': friction {grows}")


_BY_LOAD, _BY_PLACE = "grows by load_coefficient*abs(load)", "changes by slope*(s - around)"
_TOGETHER = (
    ("load_coefficient", "load", _BY_LOAD),
    ("load", "load_coefficient", _BY_LOAD),
    ("around", "slope", _BY_PLACE),
    ("slope", "coulomb", _BY_PLACE),
)


def _frozen(value: object) -> object:
    """Turn the lists of the file into tuples."""
    if isinstance(value, list):
        return tuple(_frozen(item) for item in value)
    if isinstance(value, dict):
        return tuple((key, _frozen(item)) for key, item in value.items())
    return value
