"""What two models say differently: in sentences first, then line by line."""

import hashlib
import re
from collections.abc import Iterator, Mapping
from difflib import unified_diff

from symhyb.asked import asked
from symhyb.model.constraints import Constraint
from symhyb.model.curves import Curve
from symhyb.model.expression import Name
from symhyb.model.limits import Limit
from symhyb.model.maps import Map
from symhyb.model.states import State
from symhyb.model.turned import Quaternion, Rotations
from symhyb.model.types import (
    Body,
    Coordinate,
    Element,
    Input,
    Model,
    Network,
    Parameter,
    Point,
    Sensor,
    Vector,
    place_text,
)
from symhyb.model.write import text_of
from symhyb.units import parse_unit

Part = (
    Coordinate
    | State
    | Parameter
    | Input
    | Point
    | Body
    | Constraint
    | Curve
    | Map
    | Element
    | Sensor
    | Limit
)
Facets = Mapping[str, str]


@asked
def diff(first: Model, second: Model) -> str:
    """Return what changed from the first model to the second: sentences, then a unified diff.

    A correction shows only ``+`` lines; a re-estimated parameter one ``-`` and one ``+`` line.
    """
    before, after = text_of(first), text_of(second)
    lines = unified_diff(
        before.splitlines(),
        after.splitlines(),
        first.file or "first model",
        second.file or "second model",
        lineterm="",
    )
    sentences = changes(first, second) or ("The two models say the same.",)
    return "\n".join((*sentences, "", *lines) if before != after else sentences)


def changes(first: Model, second: Model) -> tuple[str, ...]:
    """Return one sentence for each difference in meaning.

    ``+ element found_drag: drag on x, drag = 0.42 ± 0.03 N*s^2/m^2`` for what was added, ``-`` for
    what is gone, ``~ parameter k: 980 -> 1010 N/m`` for what has another value.
    """
    return tuple(_changes(first, second))


def _changes(first: Model, second: Model) -> Iterator[str]:
    yield from _changed("model", _whole(first), _whole(second))
    before, after = _parts(first), _parts(second)
    for name, facets in before.items():
        if name in after:
            yield from _changed(name, facets, after[name])
        else:
            yield f"- {name}: {_listed(facets)}"
    for name, facets in after.items():
        if name not in before:
            yield f"+ {name}: {_listed(facets)}"


def _changed(name: str, before: Facets, after: Facets) -> Iterator[str]:
    """Yield a sentence for each facet that differs."""
    for facet in {**before, **after}:
        old, new = before.get(facet, ""), after.get(facet, "")
        if old != new:
            label = f"{facet} " if facet else ""
            yield f"~ {name}: {label}{_without_unit(old, new) or 'unset'} -> {new or 'unset'}"


def _without_unit(old: str, new: str) -> str:
    """Drop the unit of a quantity that the next one repeats: ``980 -> 1010 N/m``."""
    quantity = re.compile(r"(-?[\d.]\S*(?: ± \S+)?) (\S+)")
    before, after = quantity.fullmatch(old), quantity.fullmatch(new)
    return before[1] if before and after and before[2] == after[2] else old


def _listed(facets: Facets) -> str:
    """Write facets one after the other, those without a name first."""
    return ", ".join(f"{facet} = {text}" if facet else text for facet, text in facets.items())


def _whole(model: Model) -> Facets:
    """What the model says of itself, apart from its parts."""
    facets = {"title": f"'{model.title}'"}
    if model.engine is not None:
        facets[model.engine.section] = f"'{model.engine.file}'"
    if model.gravity:
        facets["gravity"] = _pair(model.gravity)
    for name, energy in (("kinetic", model.energy.kinetic), ("potential", model.energy.potential)):
        if energy is not None:
            facets[name] = energy.text
    return facets


def _parts(model: Model) -> dict[str, Facets]:
    """Every part of a model under its kind and name, with what can be said of it."""
    sections: tuple[tuple[str, tuple[Part, ...]], ...] = (
        ("coordinate", model.coordinates),
        ("state", model.states),
        ("parameter", model.parameters),
        ("input", model.inputs),
        ("point", model.points),
        ("body", model.bodies),
        ("constraint", model.constraints),
        ("curve", model.curves),
        ("map", model.maps),
        ("element", model.elements),
        ("sensor", model.sensors),
        ("limits of", model.limits),
    )
    return {
        f"{section} {part.name}": _facets(part) for section, parts in sections for part in parts
    }


def _facets(part: Part) -> Facets:
    match part:
        case Parameter():
            return {"": _quantity(part)}
        case Coordinate():
            facets = {"unit": part.unit.text, "start": f"{part.start:.6g}"}
            facets["start_rate"] = f"{part.start_rate:.6g}"
            return {**facets, "imposed": "true"} if part.imposed else facets
        case State():
            facets = {"unit": part.unit.text, "start": f"{part.start:.6g}"}
            if part.next is None:
                return {**facets, "rate": part.rate.text}
            every = {"every": f"{part.every:.6g}", "first": f"{part.first:.6g}"}
            return {**facets, **every, "next": part.next.text}
        case Point():
            return {"": _pair(part.at), **({"body": part.body} if part.body else {})}
        case Body():
            facets = {"mass": part.mass.text, "at": _pair(part.at)}
            extra = (("inertia", part.inertia), ("angle", part.angle))
            facets |= {name: value.text for name, value in extra if value is not None}
            facets |= _in_space(part)
            if part.joint is not None:
                facets |= {"parent": part.parent or "the ground", "joint": _pair(part.joint)}
            return facets
        case Constraint():
            held = {key: value.text for key, value in part.values}
            return {"": " ".join((part.kind, ", ".join(part.names))).strip(), **held}
        case Curve():
            return _curve_facets(part)
        case Map():
            return _map_facets(part)
        case Element():
            return _element_facets(part)
        case Limit():
            return _limit_facets(part)
        case Input() | Sensor():
            return _channel_facets(part)


def _element_facets(element: Element) -> Facets:
    """The kind and the place, then every key; a key that is an own parameter shows its value."""
    facets = {"": f"{element.kind} {place_text(element.place)}"}
    own = {parameter.name: parameter for parameter in element.parameters}
    shown = set()
    for key, expression in element.values:
        tree = expression.tree
        if isinstance(tree, Name) and tree.name in own:
            facets[key] = _quantity(own[tree.name])
            shown.add(tree.name)
        else:
            facets[key] = expression.text
    facets |= dict(element.options)
    if element.network is not None:
        facets |= _network_facets(element.network)
    if element.curve is not None:
        curve = element.curve
        facets |= _curve_facets(curve) if curve.owned else {"curve": curve.name}
    if element.by_stretch is not None:
        factor = element.by_stretch
        said = _curve_facets(factor) if factor.owned else {"curve": factor.name}
        facets |= {f"by_stretch {key}": text for key, text in said.items()}
    if element.map is not None:
        item = element.map
        facets |= _map_facets(item) if item.owned else {"map": item.name}
    return {**facets, **{name: _quantity(own[name]) for name in own if name not in shown}}


def _network_facets(network: Network) -> Facets:
    return {
        "weights": network.weights,
        "sha256": network.sha256[:12],
        "inputs": ", ".join(seen.text for seen in network.inputs),
        "trust": ", ".join(f"{low:.6g} to {high:.6g}" for low, high in network.trust),
    }


def _curve_facets(curve: Curve) -> Facets:
    """How many points there are and how far they reach, with a hash of them; their file."""
    (first, _), (last, _) = curve.points[0], curve.points[-1]
    along, up = curve.units
    digest = hashlib.sha256(repr(curve.points).encode()).hexdigest()[:8]
    reach = f"{len(curve.points)} from {first:.6g} to {last:.6g} {along}, in {up}, hash {digest}"
    source = {"file": curve.file} if curve.file else {}
    return {
        "points": reach,
        **source,
        "interpolation": curve.interpolation,
        "extrapolation": curve.extrapolation,
    }


def _map_facets(item: Map) -> Facets:
    """How many places its grid has and how far they reach, with a hash of the whole; its file."""
    over_x, over_y, up = item.units
    digest = hashlib.sha256(repr((item.x, item.y, item.values)).encode()).hexdigest()[:8]
    spans = [
        f"{len(places)} from {places[0]:.6g} to {places[-1]:.6g} {unit}"
        for places, unit in ((item.x, over_x), (item.y, over_y))
    ]
    return {
        "grid": f"{' by '.join(spans)}, in {up}, hash {digest}",
        **({"file": item.file} if item.file else {}),
        "extrapolation": item.extrapolation,
    }


def _limit_facets(limit: Limit) -> Facets:
    unit, facets = limit.unit, {}
    if limit.between is not None:
        low, high = limit.between
        facets["between"] = f"{low:.6g} and {high:.6g} {unit}"
    if limit.rate is not None:
        facets["rate"] = f"{limit.rate:.6g} {unit / parse_unit('s')}"
    if limit.acceleration is not None:
        facets["acceleration"] = f"{limit.acceleration:.6g} {unit / parse_unit('s^2')}"
    return facets


def _channel_facets(channel: Input | Sensor) -> Facets:
    facets: dict[str, str] = {}
    if isinstance(channel, Sensor):
        facets["measures"] = channel.measures.text
    facets["unit"] = channel.unit.text
    if isinstance(channel, Sensor) and channel.sd is not None:
        facets["sd"] = f"{channel.sd:.6g}"
    if isinstance(channel, Input) and channel.between:
        facets["between"] = channel.between
    for value in channel.numbers:
        facets[value.name] = _quantity(value)
    return facets


def _quantity(parameter: Parameter) -> str:
    """Write a value with its deviation and unit: ``0.42 ± 0.03 N*s^2/m^2``."""
    band = "" if parameter.sd is None else f" ± {parameter.sd:.2g}"
    unit = "" if parameter.unit.text == "1" else f" {parameter.unit}"
    return f"{parameter.value:.6g}{band}{unit}"


def _in_space(body: Body) -> Facets:
    """How a body in space is turned, and its tensor of inertia."""
    facets = {"inertia": _pair(body.tensor)} if body.tensor else {}
    match body.turned:
        case Rotations(steps):
            facets["rotations"] = ", ".join(f"{axis} by {angle}" for axis, angle in steps)
        case Quaternion(parts):
            facets["quaternion"] = f"({', '.join(parts)})"
    return facets


def _pair(at: Vector) -> str:
    return f"({', '.join(map(str, at))})"
