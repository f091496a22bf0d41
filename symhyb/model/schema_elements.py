"""The schema of elements and constraints, from the vocabulary: a definition for each kind."""

from collections.abc import Iterator, Sequence

from symhyb.laws.base import Key, Law
from symhyb.limits import CURVE_POINTS, MAP_PLACES
from symhyb.model.constraints import CONSTRAINTS, ConstraintKind
from symhyb.model.curves import EXTRAPOLATIONS, INTERPOLATIONS
from symhyb.model.read_constraints import PLAIN
from symhyb.model.read_space import AXES, kind_in
from symhyb.model.schema_parts import (
    NAME,
    Schema,
    by_kind,
    expression,
    listed,
    named,
    one_given,
    pair,
    refer,
    table,
    text,
    vector,
    word,
)
from symhyb.model.types import Coordinate, Model, On
from symhyb.model.vocabulary import KINDS, key_unit
from symhyb.units import parse_unit

SPACE = 3  # there a torque may stand at a point, which is refused in the plane with its reason
PLACES = {
    "on": text("a coordinate, or an expression of coordinates: the stretch s"),
    "between": listed("two points: s = |b − a| − length; a tension pulls", text("a point"), 2, 2),
    "at": text("a point, where a force vector acts"),
    "pair": listed(
        "two stretches that act on each other", text("a coordinate, or an expression"), 2, 2
    ),
}
SURROUNDINGS = {
    "about": text("text for people"),
    "found": {"type": "object", "description": "how a found element came about"},
    "parameters": named("parameters of this element alone", refer("parameter")),
}
RIG = Model("", (Coordinate("x", parse_unit("m")), Coordinate("phi", parse_unit("rad"))))


def curve_keys() -> dict[str, Schema]:
    """The keys of a curve."""
    point = pair("x and F")
    return {
        "points": listed("[[x, F], …] with increasing x", point, 2, CURVE_POINTS),
        "file": text("a CSV file beside the model file"),
        "columns": listed("which columns of the file are x and F", text("a column"), 2, 2),
        "units": listed("the units of x and of F", text("a unit"), 2, 2),
        "interpolation": word("between the points", INTERPOLATIONS),
        "extrapolation": word("beyond the points", EXTRAPOLATIONS),
    }


def curve(*, named: bool = True) -> Schema:
    """A curve of ``[curves]``, or one inside an element, which is not ``named``."""
    keys = {**curve_keys(), **({"about": text("text for people")} if named else {})}
    return table(keys, oneOf=one_given(("points", "file")), dependencies={"columns": ["file"]})


def map_keys() -> dict[str, Schema]:
    """The keys of a map."""
    number = {"type": "number"}
    row = {"type": "array", "items": number, "minItems": 2, "maxItems": MAP_PLACES}
    return {
        "x": listed("increasing places along x: the stretch", number, 2, MAP_PLACES),
        "y": listed("increasing places along y: the rate", number, 2, MAP_PLACES),
        "values": listed("a row of values for each x", row, 2, MAP_PLACES),
        "file": text("a CSV file beside the model file, with the whole grid"),
        "units": listed("the units of x, y and the value", text("a unit"), 3, 3),
        "extrapolation": word("beyond the grid", EXTRAPOLATIONS),
    }


def grid() -> Schema:
    """A map of ``[maps]``."""
    keys = {**map_keys(), "about": text("text for people")}
    return table(keys, ("units",), oneOf=one_given(("values", "file")), dependencies=_WHOLE)


_WHOLE = {"x": ["values"], "y": ["values"], "values": ["x", "y"]}  # a grid is stated whole
NETWORK: dict[str, Schema] = {
    "weights": text("the file with the weights, beside the model file"),
    "sha256": text("the hash of that file", pattern="^[0-9a-fA-F]{64}$"),
    "inputs": listed("what the network sees, in SI", expression("one input"), 1),
    "trust": listed("[low, high] of each input in the training, SI", pair("low, high"), 1),
}


def elements() -> dict[str, Schema]:
    """The definitions of an element and of each of its kinds."""
    kinds = {f"element_{law.name}": _element(kind_in(law, SPACE)) for law in KINDS.values()}
    return {"element": by_kind("element", tuple(KINDS)), **kinds}


def _element(law: Law) -> Schema:
    head = {"const": law.name, "description": f"{law.words}: F = {law.law}"}
    keys: dict[str, Schema] = {"kind": {"type": "string", **head}}
    keys |= {place: PLACES[place] for place in law.placements}
    keys |= {key.name: _key(law, key) for key in law.keys}
    needs = ["kind", *law.needs]
    if any(key.vector for key in law.keys):
        keys["axes"] = text("in space: the body in whose axes the vector is given")
    if law.name == "network":
        keys |= NETWORK
        needs += NETWORK
    rules = _rules(law)
    if law.name == "curve":
        keys |= {**curve_keys(), "curve": text("the name of a curve of the model")}
        keys["by_stretch"] = {
            "description": "what a curve over the rate is multiplied by: one over the stretch",
            "oneOf": [curve(named=False), text("the name of a curve of the model")],
        }
        rules["anyOf"] = one_given(("points", "file", "curve"))
    if law.name == "map":
        keys |= {**map_keys(), "map": text("the name of a map of the model")}
        rules["anyOf"] = one_given(("values", "file", "map"))
        rules["dependencies"] = {**rules.get("dependencies", {}), **_WHOLE}
    return table({**keys, **SURROUNDINGS}, needs, title=law.name, **rules)


def _rules(law: Law) -> Schema:
    """Which keys stand together: one place, a strength, and what some keys need beside them."""
    signal = any(key.signal for key in law.keys if key.name in law.strengths)
    rules: Schema = {"oneOf": [_placed(law, place) for place in law.placements]}
    if law.strengths:
        rules["allOf"] = [{"oneOf" if signal else "anyOf": one_given(law.strengths)}]
    beside: Schema = {}
    for key in law.keys:
        if set(key.placements) < set(law.placements):
            beside[key.name] = {"anyOf": one_given(key.placements)}
    if law.key("static") and law.key("stribeck"):
        beside["static"] = ["stribeck"]
    if any(key.vector for key in law.keys):
        beside["axes"] = ["at"]
    return {**rules, **({"dependencies": beside} if beside else {})}


def _placed(law: Law, place: str) -> Schema:
    """A place that is stated; a vector stands at a point and nowhere else."""
    vectors = {
        key.name: {"type": "array" if place == "at" else ["string", "number"]}
        for key in law.keys
        if key.vector
    }
    beside = {"properties": vectors, "additionalProperties": True} if vectors else {}
    return {"required": [place], **beside}


def _key(law: Law, key: Key) -> Schema:
    if key.choices:
        return word(key.about, key.choices)
    about = "; ".join(_said(law, key))
    refused = {"not": {"const": 0}} if key.divides else {}
    if not key.vector:
        return expression(about, **refused)
    return {"anyOf": [expression(about, **refused), vector(about)], "description": about}


def _said(law: Law, key: Key) -> Iterator[str]:
    """What an editor shows of a key: noun, unit, default."""
    noun = key.noun or key.label
    yield from (part for part in (noun, key.about) if part)
    if key.spoken[1] or key.name == "torque":
        yield f"in {key.spoken[1] or 'N*m'}"
    else:
        unit, turning = (key_unit(RIG, law.name, key.name, On(name)).text for name in ("x", "phi"))
        power = " to the power of the exponent" if key.exponent else ""
        yield f"in {unit}{power} on a length" + (
            f", {turning} on an angle" if turning != unit else ""
        )
    if key.default is not None and key.name not in law.needs:
        yield f"unset: {key.default}"


def constraints() -> dict[str, Schema]:
    """The definitions of a constraint and of each of its kinds."""
    kinds = {f"constraint_{name}": _constraint(name, kind) for name, kind in CONSTRAINTS.items()}
    whole = by_kind("constraint", tuple(CONSTRAINTS), tuple(PLAIN.values()))
    return {"constraint": whole, **kinds}


def _constraint(name: str, kind: ConstraintKind) -> Schema:
    keys: dict[str, Schema] = {"kind": {"type": "string", "const": name}}
    keys |= {key: _names(kind.section, count) for key, count in kind.places}
    keys |= {key: expression("positions, parameters and the time") for key in kind.keys}
    keys |= {key: word("an axis", AXES) for key, _ in kind.axes}
    keys["about"] = text("text for people")
    needs = [key for key, _ in kind.places]
    needs += [*kind.needs, *(key for key, default in kind.axes if not default)]
    head = [] if name in PLAIN.values() else ["kind"]
    return table(keys, [*head, *needs], title=name)


def _names(section: str, count: int) -> Schema:
    one: Sequence[str] = {"points": ("a point", "two points")}.get(
        section, ("a coordinate", "two coordinates")
    )
    if count == 1:
        return text(one[0], pattern=NAME)
    return listed(one[1], text(one[0], pattern=NAME), count, count, uniqueItems=True)
