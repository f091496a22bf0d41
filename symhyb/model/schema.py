"""The JSON Schema of the model file: ``python -m symhyb.model.schema [FILE]`` writes it.

Editors complete and check model files with it (docs/editor.md). Kinds, keys and units come from the
vocabulary; a test makes the file anew, and holds its keys against those that the reader takes.
"""

import sys
from pathlib import Path

from symhyb.model.actuators import ACTUATOR_KEYS, MAY_BE_ZERO
from symhyb.model.fmu import VARIABLES
from symhyb.model.limits import COORDINATE_KEYS, INPUT_KEYS
from symhyb.model.mujoco import ACTING, FIELDS
from symhyb.model.read import BETWEEN
from symhyb.model.read_space import AXES
from symhyb.model.render import FORMAT
from symhyb.model.schema_elements import constraints, curve, elements, grid
from symhyb.model.schema_parts import (
    DIALECT,
    Schema,
    expression,
    listed,
    named,
    number,
    one_given,
    pair,
    positive,
    refer,
    table,
    text,
    truth,
    vector,
    word,
    write,
)

FILE = Path(__file__).with_name("model.schema.json")

ABOUT = text("text for people")
UNIT = text("a unit, such as N*s/m; a plain number has the unit 1", minLength=1)
SD = positive("one standard deviation, in the same unit")


def model_schema() -> Schema:
    """The schema of a model file, format 1."""
    return {
        "$schema": DIALECT,
        "title": "symhyb model file, format 1",
        **table(_sections(), ("symhyb", "coordinates")),
        "definitions": {
            "parameter": _parameter(),
            "coordinate": _coordinate(),
            "state": _state(),
            "input": _channel(
                {"between": word("how it runs between its samples", BETWEEN)},
                actuator=ACTUATOR_KEYS,
            ),
            "sensor": _channel(
                {"measures": expression("what it shows: coordinates, x', x'', readings"), "sd": SD},
                ("measures",),
            ),
            "point": _point(),
            "body": _body(),
            "curve": curve(),
            "map": grid(),
            "limit": _limit(),
            **constraints(),
            **elements(),
        },
    }


def _sections() -> dict[str, Schema]:
    version = {"type": "integer", "const": FORMAT, "description": "version of the file format"}
    energies = {key: expression(f"{key} energy") for key in ("kinetic", "potential")}
    return {
        "symhyb": version,
        "title": text("of the machine"),
        "about": ABOUT,
        "fmu": _fmu(),
        "mujoco": _mujoco(),
        "gravity": vector("acts on every body, in the inertial axes"),
        "coordinates": named("what moves", refer("coordinate"), minProperties=1),
        "states": named("what follows from a rate of first order, or is sampled", refer("state")),
        "parameters": named("numbers with units", refer("parameter")),
        "inputs": named("recorded signals that act", refer("input")),
        "points": named("named places", refer("point")),
        "bodies": named("what has mass", refer("body")),
        "energy": table(energies, description="what bodies and elements cannot say"),
        "constraints": named("what closes loops, or rolls", refer("constraint")),
        "curves": named("characteristics given by points", refer("curve")),
        "maps": named("functions of two variables given by grids", refer("map")),
        "elements": named("force laws at places", refer("element")),
        "sensors": named("recorded signals that measure", refer("sensor")),
        "limits": named("how far and how fast the machine may be driven", refer("limit")),
    }


def _fmu() -> Schema:
    variable = text("the name of a variable of the FMU")
    mass = text("what a force would move, with its unit, where the FMU has no input of force")
    place = table({**dict.fromkeys(VARIABLES, variable), "mass": mass}, ("position", "rate"))
    place |= {"oneOf": [{"required": ["force"]}, {"required": ["mass"]}]}
    keys = {
        "file": text("the FMU, beside this file or below it"),
        "coordinates": named("states and input of each coordinate", place, minProperties=1),
        "inputs": named("which variable an input sets", variable),
        "parameters": named("which variable a parameter sets", variable),
    }
    return table(keys, ("file", "coordinates"), description="an FMU that is the machine")


def _mujoco() -> Schema:
    parts = {kind: text(f"the name of a {kind} of MuJoCo") for kind in (*FIELDS, *ACTING)}
    along = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    along |= {"description": "direction of the force at a site, in the axes of the world"}
    acting = table({**{kind: parts[kind] for kind in ACTING}, "along": along}, ())
    fields = list(dict.fromkeys(field for known in FIELDS.values() for field in known))
    field = {"enum": fields, "description": "which number of the part"}
    setting = table({**{kind: parts[kind] for kind in FIELDS}, "field": field}, ("field",))
    keys = {
        "file": text("an MJCF, beside this file or below it"),
        "coordinates": named("the joint of a coordinate, if not that of its name", text("a joint")),
        "inputs": named("what an input acts by", {"anyOf": [text("an actuator"), acting]}),
        "parameters": named("which number a parameter sets", setting),
    }
    return table(keys, ("file",), description="a file of MuJoCo that is the machine")


def _parameter() -> Schema:
    keys = {
        "value": number("in its unit"),
        "unit": UNIT,
        "sd": positive("one standard deviation: the value may be estimated; without it it is held"),
        "about": ABOUT,
        "was": number("the value before it was re-estimated"),
    }
    return table(keys, ("value", "unit"))


def _coordinate() -> Schema:
    keys = {
        "unit": UNIT,
        "start": number("initial value of simulations, in its unit"),
        "start_rate": number("its initial rate, in its unit per s"),
        "about": ABOUT,
        "imposed": truth("true: the motion is given, not computed"),
    }
    return table(keys, ("unit",))


def _state() -> Schema:
    keys = {
        "unit": UNIT,
        "start": number("initial value of simulations, in its unit"),
        "rate": expression("its rate, in its unit per s"),
        "every": expression("sampled: from one sample to the next, in s or as in '10 ms'"),
        "first": expression("sampled: the time of a sample, in s or as in '3 ms'; default 0"),
        "next": expression("sampled: the value that it takes at each sample, in its unit"),
        "about": ABOUT,
    }
    either: list[Schema] = [{"required": ["rate"]}, {"required": ["every", "next"]}]
    return {**table(keys, ("unit",)), "oneOf": either}


def _channel(
    own: dict[str, Schema], needs: tuple[str, ...] = (), actuator: tuple[str, ...] = ()
) -> Schema:
    """An input or a sensor: its own keys, those of both, and those of an ``actuator``."""
    value = {
        "value": number("in its unit"),
        "sd": SD,
        "unit": UNIT,
        "was": number("the value before it was re-estimated"),
        "about": ABOUT,
    }
    either = {"gain": 1, "offset": 0, "delay": 0}
    stated: dict[str, Schema] = {
        key: {"anyOf": [number(f"{key}, unset: {usual}"), table(value, ("value",))]}
        for key, usual in either.items()
    }
    stated["gain"]["not"] = {"const": 0}
    for key in actuator:
        size = {"minimum": 0} if key in MAY_BE_ZERO else {"exclusiveMinimum": 0}
        sized = {**value, "value": number("in its unit", **size)}
        plain = number(f"{key.replace('_', ' ')} of the actuator, unset: none", **size)
        stated[key] = {"anyOf": [plain, table(sized, ("value",))]}
    return table({**own, "unit": UNIT, "about": ABOUT, **stated}, (*needs, "unit"))


def _point() -> Schema:
    own = {"body": text("the body to which it is fixed"), "at": vector("its place"), "about": ABOUT}
    return {"anyOf": [vector("its place in the inertial axes"), table(own, ("at",))]}


def _body() -> Schema:
    place = {"anyOf": [text("the name of a point"), vector("its components")]}
    step = {"type": "array", "items": [word("an axis", AXES), expression("an angle")]}
    tensor = listed("Jxx, Jyy, Jzz, and Jxy, Jxz, Jyz", expression("a moment"), 3, 6)
    tensor["not"] = {"minItems": 4, "maxItems": 5}
    keys = {
        "mass": expression("its mass"),
        "at": {**place, "description": "its centre of mass"},
        "inertia": {
            "anyOf": [expression("about the centre of mass"), tensor],
            "description": "about the centre of mass; in space one, three or six values",
        },
        "angle": expression("what turns it in the plane, counter-clockwise"),
        "about": ABOUT,
        "parent": text("the body on which it hangs"),
        "joint": {**place, "description": "where it hangs, in the axes of the parent"},
        "rotations": listed(
            "in space: [axis, angle], one after the other",
            {**step, "minItems": 2, "maxItems": 2},
            1,
        ),
        "quaternion": listed("in space: four coordinates", text("a coordinate"), 4, 4),
    }
    turns = ("angle", "rotations", "quaternion")
    hangs = one_given(("parent", "joint"))
    rules: Schema = {"inertia": {"anyOf": one_given(("parent", *turns))}}
    rules |= {key: {"anyOf": [{"required": ["inertia"]}, *hangs]} for key in turns}
    both = {"required": ["rotations", "quaternion"]}
    placed = [{"required": ["at"]}, *hangs]
    return table(keys, ("mass",), anyOf=placed, dependencies=rules, **{"not": both})


def _limit() -> Schema:
    """Limits of a coordinate, or of an input."""
    spans = {"travel": "lowest and highest value", "range": "lowest and highest value"}
    sizes = {
        "speed": "largest rate in either direction, per s",
        "rate": "largest rate in either direction, per s",
        "acceleration": "largest acceleration in either direction, per s²",
    }
    made = []
    for keys in (COORDINATE_KEYS, INPUT_KEYS):
        own = {key: pair(spans[key]) if key in spans else positive(sizes[key]) for key in keys}
        made.append(table({"unit": UNIT, **own, "about": ABOUT}, ("unit",), anyOf=one_given(keys)))
    return {"oneOf": made}


def main() -> None:
    """Write the schema to the file that is named, else to the one that is shipped."""
    write(model_schema(), Path(sys.argv[1]) if len(sys.argv) > 1 else FILE)


if __name__ == "__main__":
    main()
