"""JSON Schemas from types: ``python -m symhyb.report.schema`` writes those beside this file.

Needs pydantic, which nothing else of symhyb does: the schemas are kept, and a test makes them anew.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from symhyb.report.document import DiagnosisDocument
from symhyb.report.learned_document import LearnedDocument

SCHEMAS: Mapping[str, tuple[str, Any]] = {
    "diagnosis.schema.json": (
        "diagnosis.json, the output contract of DESIGN section 6",
        DiagnosisDocument,
    ),
    "learned.schema.json": ("learned.json, format 1", LearnedDocument),
}


def schema_of(title: str, document: Any) -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of a TypedDict."""
    from pydantic import TypeAdapter
    from pydantic.json_schema import GenerateJsonSchema

    class Plain(GenerateJsonSchema):
        """Keys speak for themselves: they get no titles."""

        def field_title_should_be_set(self, schema: Any) -> bool:
            return False

    made = TypeAdapter(document).json_schema(schema_generator=Plain)
    definitions = made.pop("$defs")
    _gather([made, definitions], definitions)
    whole = definitions.pop(_referred(made)) if "$ref" in made else made
    head = {"$schema": Plain.schema_dialect, "title": title}
    return {**head, **{key: whole[key] for key in whole if key not in head}, "$defs": definitions}


def _gather(node: Any, definitions: dict[str, Any]) -> None:
    """Move what stands beside a reference into what it refers to: ``additionalProperties`` is only
    of the properties that stand beside it."""
    for inner in node.values() if isinstance(node, dict) else node:
        if isinstance(inner, dict | list):
            _gather(inner, definitions)
    if isinstance(node, dict) and "$ref" in node:
        beside = {key: node.pop(key) for key in [*node] if key != "$ref"}
        definitions[_referred(node)].update(beside)


def _referred(node: dict[str, Any]) -> str:
    return str(node["$ref"].rpartition("/")[2])


def text_of(name: str) -> str:
    """A schema file as it is to be, by its name."""
    return json.dumps(schema_of(*SCHEMAS[name]), indent=1) + "\n"


def main() -> None:
    """Write the schemas."""
    for name in SCHEMAS:
        Path(__file__).with_name(name).write_text(text_of(name), encoding="utf-8")


if __name__ == "__main__":
    main()
