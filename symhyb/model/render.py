"""Write values of a model as TOML text that reads back to the same values."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence

from symhyb.errors import visible
from symhyb.model.constraints import CONSTRAINTS, Constraint
from symhyb.model.curves import EXTRAPOLATIONS, INTERPOLATIONS, Curve
from symhyb.model.expression import Expression
from symhyb.model.fmu import Fmu
from symhyb.model.limits import Limit
from symhyb.model.maps import Map
from symhyb.model.mujoco import Drive, Mujoco
from symhyb.model.states import State
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import (
    At,
    Between,
    Body,
    Coordinate,
    Element,
    Input,
    Model,
    Network,
    On,
    Pair,
    Parameter,
    Point,
    Sensor,
)

FORMAT = 1
"""The version of the file format that is written and read."""


Comments = Mapping[str, Sequence[str]]
"""Lines for people by the dotted name of the table or entry above which they stand (``bodies.arm``,
``parameters.m``), those of the head of the file by an empty name."""


def render(model: Model, comments: Comments | None = None) -> str:
    """Write a whole model as text that reads back to the same values, with comments."""
    return "\n".join(_commented(_lines(model), comments or {})) + "\n"


def _commented(lines: Iterable[str], comments: Comments) -> Iterator[str]:
    """Put comments above the tables and entries that they are about."""

    def said(place: str) -> Iterator[str]:
        for text in comments.get(place, ()):
            yield f"# {visible(' '.join(text.splitlines()))}".rstrip()

    if comments.get(""):
        yield from (*said(""), "")
    table = ""
    for line in lines:
        if line.startswith("["):
            table = line.strip("[]")
            yield from said(table)
        elif table and "=" in line:
            yield from said(f"{table}.{line.partition('=')[0].strip()}")
        yield line


def rounded(value: float, digits: int = 15) -> str:
    """Write a number for people and machines: no more digits than it has."""
    return repr(float(f"{value:.{digits}g}"))


def newline_of(text: str) -> str:
    """Return the line end that a text uses."""
    return "\r\n" if "\r\n" in text else "\n"


def _string(text: str) -> str:
    """Write a TOML basic string; JSON's escapes are TOML's, except for DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml(value: object) -> str:
    """Write a plain value: text, number, truth value, list, or a mapping as pairs."""
    match value:
        case bool():
            return str(value).lower()
        case int():
            return str(value)
        case float():
            return rounded(value)
        case str() | Expression():
            return _string(str(value))
        case list() | tuple():
            return "[" + ", ".join(_toml(item) for item in value) + "]"
    return _string(str(value))


def _inline(entries: Iterable[tuple[str, object]]) -> str:
    """Write an inline table without the entries that are None or empty text."""
    given = [(key, value) for key, value in entries if value is not None and value != ""]
    return "{ " + ", ".join(f"{key} = {_toml(value)}" for key, value in given) + " }"


def _aligned(entries: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Write ``key = value`` lines with the signs below each other."""
    entries = [(key, value) for key, value in entries if value not in ("", '""')]
    width = max((len(key) for key, _ in entries), default=0)
    for key, value in entries:
        yield f"{key:<{width}} = {value}"


def _parameter(parameter: Parameter) -> str:
    sd = None if parameter.sd is None else float(rounded(parameter.sd, 6))
    return _inline(
        (
            ("value", parameter.value),
            ("sd", sd),
            ("unit", parameter.unit.text),
            ("about", parameter.about),
            ("was", parameter.was),
        )
    )


def element_lines(element: Element) -> Iterator[str]:
    """Write one element as its table, and its own parameters as another."""
    places: Mapping[str, object]
    match element.place:
        case On(coordinate):
            places = {"on": coordinate}
        case Between(first, second):
            places = {"between": [first, second]}
        case At(point):
            places = {"at": point}
        case Pair(first, second):
            places = {"pair": [first, second]}
    values = dict(element.values)
    for key in dict.fromkeys(key.split(".")[0] for key in values if "." in key):
        parts = [values.pop(f"{key}.{axis}") for axis in "xyz" if f"{key}.{axis}" in values]
        places = {**places, key: parts}
    entries = {"kind": element.kind, **places, **values, **dict(element.options)}
    lines = [(key, _toml(value)) for key, value in entries.items()]
    if element.network is not None:
        lines += _network_entries(element.network)
    if element.curve is not None:
        own = element.curve.owned
        lines += _curve_entries(element.curve) if own else [("curve", _toml(element.curve.name))]
    if element.by_stretch is not None:
        factor = element.by_stretch
        inner = ", ".join(f"{key} = {text}" for key, text in _curve_entries(factor))
        lines.append(("by_stretch", f"{{ {inner} }}" if factor.owned else _toml(factor.name)))
    if element.map is not None:
        own = element.map.owned
        lines += _map_entries(element.map) if own else [("map", _toml(element.map.name))]
    lines.append(("about", _toml(element.about)))
    if element.found:
        lines.append(("found", _inline(element.found)))
    yield f"[elements.{element.name}]"
    yield from _aligned(lines)
    if element.parameters:
        yield f"[elements.{element.name}.parameters]"
        yield from _aligned((own.name, _parameter(own)) for own in element.parameters)


def _lines(model: Model) -> Iterator[str]:
    """Write every section in the order of format 1."""
    gravity = _toml(model.gravity) if model.gravity else ""
    yield from _aligned(
        (
            ("symhyb", str(FORMAT)),
            ("title", _string(model.title)),
            ("about", _string(model.about)),
            ("gravity", gravity),
        )
    )
    if model.fmu is not None:
        yield from ("", *_fmu_lines(model.fmu))
    if model.mujoco is not None:
        yield from ("", *_mujoco_lines(model.mujoco))
    sections = {
        "coordinates": ((c.name, _coordinate(c)) for c in model.coordinates),
        "states": ((state.name, _state(state)) for state in model.states),
        "parameters": ((p.name, _parameter(p)) for p in model.parameters),
        "inputs": ((channel.name, _channel(channel)) for channel in model.inputs),
        "points": ((point.name, _point(point)) for point in model.points),
        "energy": (
            (key, _toml(value))
            for key in ("kinetic", "potential")
            if (value := getattr(model.energy, key)) is not None
        ),
        "sensors": ((channel.name, _channel(channel)) for channel in model.sensors),
        "limits": ((limit.name, _limit(limit, model)) for limit in model.limits),
    }
    for section, entries in sections.items():
        lines = list(_aligned(entries))
        if lines:
            yield from ("", f"[{section}]", *lines)
    for body in model.bodies:
        yield from ("", f"[bodies.{body.name}]", *_aligned(_body_entries(body)))
    for constraint in model.constraints:
        lines = list(_aligned(_constraint_entries(constraint)))
        yield from ("", f"[constraints.{constraint.name}]", *lines)
    for curve in model.curves:
        yield from ("", *curve_lines(curve))
    for item in model.maps:
        lines = list(_aligned([*_map_entries(item), ("about", _toml(item.about))]))
        yield from ("", f"[maps.{item.name}]", *lines)
    for element in model.elements:
        yield from ("", *element_lines(element))


def curve_lines(curve: Curve) -> Iterator[str]:
    """Write one curve of a model as its table."""
    yield f"[curves.{curve.name}]"
    yield from _aligned([*_curve_entries(curve), ("about", _toml(curve.about))])


def parameter_lines(parameter: Parameter) -> Iterator[str]:
    """Write one parameter of a model as a table of its own, which may stand at the end of a
    file."""
    yield f"[parameters.{parameter.name}]"
    entries = (("value", parameter.value), ("unit", parameter.unit.text), ("sd", parameter.sd))
    lines = [(key, _toml(value)) for key, value in entries if value is not None]
    yield from _aligned([*lines, ("about", _toml(parameter.about))])


def state_lines(state: State) -> Iterator[str]:
    """Write one state of a model as a table of its own, which may stand at the end of a file."""
    yield f"[states.{state.name}]"
    yield from _aligned((key, _toml(value)) for key, value in _stated_of(state))


def _fmu_lines(fmu: Fmu) -> Iterator[str]:
    yield from ("[fmu]", f"file = {_toml(fmu.file)}", "[fmu.coordinates]")
    yield from _aligned((place.coordinate, _inline(place.facts())) for place in fmu.places)
    for section, pairs in (("inputs", fmu.inputs), ("parameters", fmu.parameters)):
        if pairs:
            yield f"[fmu.{section}]"
            yield from _aligned((name, _toml(variable)) for name, variable in pairs)


def _mujoco_lines(mujoco: Mujoco) -> Iterator[str]:
    yield from ("[mujoco]", f"file = {_toml(mujoco.file)}", "[mujoco.coordinates]")
    yield from _aligned((name, _toml(joint)) for name, joint in mujoco.joints)
    if mujoco.inputs:
        yield "[mujoco.inputs]"
        yield from _aligned((one.input, _drive(one)) for one in mujoco.inputs)
    if mujoco.parameters:
        yield "[mujoco.parameters]"
        yield from _aligned(
            (one.parameter, _inline([(one.kind, one.part), ("field", one.field)]))
            for one in mujoco.parameters
        )


def _drive(one: Drive) -> str:
    if one.kind == "actuator":
        return _toml(one.part)
    along = f", along = [{', '.join(map(repr, one.along))}]" if one.along else ""
    return f"{{ {one.kind} = {_toml(one.part)}{along} }}"


def _network_entries(network: Network) -> list[tuple[str, str]]:
    """The trust box keeps every digit: whether the force fades must not depend on a rounding."""
    box = ", ".join(f"[{low!r}, {high!r}]" for low, high in network.trust)
    return [
        ("weights", _toml(network.weights)),
        ("sha256", _toml(network.sha256)),
        ("inputs", _toml(network.inputs)),
        ("trust", f"[{box}]"),
    ]


def _curve_entries(curve: Curve) -> list[tuple[str, str]]:
    """The keys of a curve; its points keep every digit."""
    points = ", ".join(f"[{x!r}, {y!r}]" for x, y in curve.points)
    if curve.file:
        entries = [("file", _toml(curve.file))]
        entries += [("columns", _toml(curve.columns))] if curve.columns else []
    else:
        entries = [("points", f"[{points}]")]
    entries.append(("units", _toml([unit.text for unit in curve.units])))
    if curve.interpolation != INTERPOLATIONS[0]:
        entries.append(("interpolation", _toml(curve.interpolation)))
    if curve.extrapolation != EXTRAPOLATIONS[0]:
        entries.append(("extrapolation", _toml(curve.extrapolation)))
    return entries


def _map_entries(item: Map) -> list[tuple[str, str]]:
    """The keys of a map; its grid keeps every digit."""
    if item.file:
        entries = [("file", _toml(item.file))]
    else:
        entries = [("x", _digits(item.x)), ("y", _digits(item.y))]
        entries.append(("values", f"[{', '.join(map(_digits, item.values))}]"))
    entries.append(("units", _toml([unit.text for unit in item.units])))
    if item.extrapolation != EXTRAPOLATIONS[0]:
        entries.append(("extrapolation", _toml(item.extrapolation)))
    return entries


def _digits(numbers: Iterable[float]) -> str:
    """A list of numbers with every digit."""
    return f"[{', '.join(map(repr, numbers))}]"


def _coordinate(coordinate: Coordinate) -> str:
    return _inline(
        (
            ("unit", coordinate.unit.text),
            ("start", _stated(coordinate, "start", coordinate.start)),
            ("start_rate", _stated(coordinate, "start_rate", coordinate.start_rate)),
            ("imposed", True if coordinate.imposed else None),
            ("about", coordinate.about),
        )
    )


def _stated(coordinate: Coordinate, key: str, value: float) -> float | None:
    """A start that the file does not give may move where a loop has to close."""
    return value if value or key in coordinate.stated else None


def _state(state: State) -> str:
    return _inline(_stated_of(state))


def _stated_of(state: State) -> Iterator[tuple[str, object]]:
    """The keys of a state that have values."""
    entries = (
        ("unit", state.unit.text),
        ("start", state.start or None),
        ("rate", None if state.next else state.rate),
        ("every", state.every or None),
        ("first", state.first or None),
        ("next", state.next),
        ("about", state.about or None),
    )
    return ((key, value) for key, value in entries if value is not None)


def _limit(limit: Limit, model: Model) -> str:
    moving = any(limit.name == coordinate.name for coordinate in model.coordinates)
    return _inline((("unit", limit.unit.text), *limit.entries(moving), ("about", limit.about)))


def _point(point: Point) -> str:
    """Write a point as a list, or as a table where it says more than its place."""
    if not point.body and not point.about:
        return _toml(point.at)
    return _inline((("body", point.body), ("at", point.at), ("about", point.about)))


def _body_entries(body: Body) -> Iterator[tuple[str, str]]:
    entries = (
        ("parent", body.parent or None),
        ("joint", body.joint),
        ("mass", body.mass),
        ("at", body.at),
        ("inertia", body.tensor or body.inertia),
        ("angle", body.angle),
        ("rotations", body.turned.steps if isinstance(body.turned, Rotations) else None),
        ("quaternion", body.turned.parts if isinstance(body.turned, Quaternion) else None),
        ("about", body.about),
    )
    yield from ((key, _toml(value)) for key, value in entries if value is not None)


def _constraint_entries(constraint: Constraint) -> Iterator[tuple[str, str]]:
    names = iter(constraint.names)
    yield "kind", _toml(constraint.kind)
    for key, count in CONSTRAINTS[constraint.kind].places:
        own = [next(names) for _ in range(count)]
        yield key, _toml(own if count > 1 else own[0])
    yield from ((key, _toml(value)) for key, value in constraint.values)
    yield from ((key, _toml(axis)) for key, axis in constraint.axes)
    yield "about", _toml(constraint.about)


def _channel(channel: Input | Sensor) -> str:
    """Write an input or a sensor as one line."""
    entries: list[tuple[str, object]] = []
    if isinstance(channel, Sensor):
        entries.append(("measures", channel.measures))
    entries += [("unit", channel.unit.text)]
    if isinstance(channel, Sensor):
        entries.append(("sd", channel.sd))
    elif channel.between:
        entries.append(("between", channel.between))
    text = _inline([*entries, ("about", channel.about)])
    for value in channel.numbers:
        text = text[:-2] + f", {value.name} = {_parameter(value)} }}"
    return text
