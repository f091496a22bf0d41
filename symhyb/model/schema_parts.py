"""Pieces of which the JSON Schemas of files that people write are made (draft 7, as editors read).

A schema knows shapes: which keys, of what type, which of them together. Units, names that must be
declared and what an expression holds are checked by the reader alone.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from symhyb.limits import EXPRESSION_LETTERS

Schema = dict[str, Any]

DIALECT = "http://json-schema.org/draft-07/schema#"
NAME = "^[A-Za-z_][A-Za-z0-9_]{0,59}$"
"""What a declared name looks like."""


def text(about: str, **more: Any) -> Schema:
    """A text in quotes."""
    return {"type": "string", "description": about, **more}


def word(about: str, words: Sequence[str]) -> Schema:
    """One of several words."""
    return {"type": "string", "enum": list(words), "description": about}


def number(about: str, **more: Any) -> Schema:
    """A number."""
    return {"type": "number", "description": about, **more}


def positive(about: str) -> Schema:
    """A number above 0."""
    return number(about, exclusiveMinimum=0)


def truth(about: str) -> Schema:
    """True or false."""
    return {"type": "boolean", "default": False, "description": about}


def expression(about: str, **more: Any) -> Schema:
    """An expression in quotes, or a number."""
    one = {"type": ["string", "number"], "maxLength": EXPRESSION_LETTERS, "minLength": 1}
    return {**one, "description": about, **more}


def listed(about: str, item: Schema, least: int, most: int | None = None, **more: Any) -> Schema:
    """A list of ``least`` to ``most`` items, None for any number."""
    size = {"minItems": least} if most is None else {"minItems": least, "maxItems": most}
    return {"type": "array", "items": item, **size, "description": about, **more}


def pair(about: str) -> Schema:
    """Two numbers, the smaller first."""
    return listed(about, {"type": "number"}, 2, 2)


def vector(about: str) -> Schema:
    """Two expressions in the plane, three in space."""
    return listed(about, expression("one component"), 2, 3)


def table(properties: Mapping[str, Schema], needs: Sequence[str] = (), **more: Any) -> Schema:
    """A table with these keys and no others, those in ``needs`` required."""
    head: Schema = {"type": "object", "properties": dict(properties)}
    if needs:
        head["required"] = list(needs)
    return {**head, "additionalProperties": False, **more}


def named(about: str, entry: Schema, **more: Any) -> Schema:
    """A table of entries under names that the file chooses."""
    inner = {"type": "object", "patternProperties": {NAME: entry}, "additionalProperties": False}
    return {**inner, "description": about, **more}


def refer(name: str) -> Schema:
    """What stands under ``definitions`` by this name."""
    return {"$ref": f"#/definitions/{name}"}


def one_given(keys: Sequence[str]) -> list[Schema]:
    """For ``oneOf`` and ``anyOf``: each of the keys by itself."""
    return [{"required": [key]} for key in keys]


def by_kind(prefix: str, kinds: Sequence[str], plain: Sequence[str] = ()) -> Schema:
    """An entry that its ``kind`` decides: each is defined as ``<prefix>_<kind>``. An entry of one
    of the ``plain`` kinds may leave the word out.

    The conditions give sentences on the keys of the kind that was meant. Editors do not follow
    conditions when they complete, so the kinds stand as alternatives too, the last of which is
    free. Each piece says that it allows further keys, without which Tombi warns of every key.
    """
    free: Schema = {"type": "object", "additionalProperties": True}
    refs = {kind: refer(f"{prefix}_{kind}") for kind in kinds}
    said: Schema = {"required": ["kind"]}
    rules = [
        {**free, "if": {**free, **said, "properties": {"kind": {"const": kind}}}, "then": ref}
        for kind, ref in refs.items()
    ]
    if plain:
        either = {"oneOf": [refs[kind] for kind in plain]}
        rules.append({**free, "if": {**free, "not": said}, "then": either})
    return {
        **free,
        "properties": {"kind": word("what it is", kinds)},
        **({} if plain else said),
        "anyOf": [*refs.values(), free],
        "if": free,
        "then": {**free, "allOf": rules},
    }


def written(schema: Schema) -> str:
    """A schema as the text of its file."""
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def write(schema: Schema, file: Path) -> None:
    """Write a schema file."""
    file.write_text(written(schema), encoding="utf-8")
