"""The page of the model file: its examples are read, and it names the whole vocabulary."""

import re
from pathlib import Path
from textwrap import dedent

import pytest

from symhyb.model.expression import FUNCTIONS, READINGS
from symhyb.model.read import parse_model
from symhyb.model.vocabulary import KINDS

PAGE = (Path(__file__).parents[2] / "docs" / "model-file.md").read_text(encoding="utf-8")
KINDS_SECTION = PAGE.split("### Kinds\n")[1].split("\n### ")[0]
FENCED = re.findall(r"^```toml\n(symhyb.*?)^```", PAGE, re.M | re.S)
INDENTED = re.findall(r"^    symhyb .*?(?=^\S)", PAGE, re.M | re.S)
WHOLE = [dedent(text) for text in (*FENCED, *INDENTED)]


def test_the_page_has_whole_examples() -> None:
    assert len(WHOLE) == 6


@pytest.mark.parametrize("text", WHOLE, ids=range(len(WHOLE)))
def test_the_examples_of_the_page_are_read(text: str) -> None:
    assert parse_model(text).sensors


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_every_kind_is_in_the_table_with_its_places(kind) -> None:  # type: ignore[no-untyped-def]
    lines = KINDS_SECTION.splitlines()
    (row,) = [line for line in lines if line.startswith(f"| `{kind.name}`")]
    assert row.endswith(f"| {', '.join(kind.placements)} |")
    keys = {key.name for key in kind.keys} - {"length", "asymmetry", "phase"}
    law = row + ("force torque tension" if kind.name in ("force", "law") else "")
    assert {key for key in keys if key not in law} == set()
    for key in kind.keys:
        assert f"`{key.name}`" in PAGE or key.name in law
    for need in kind.needs:
        assert re.search(rf"`{kind.name}` needs\s[^.;]*`{need}`", PAGE)


def test_every_function_and_reading_is_named() -> None:
    words = set(re.findall(r"\w+", PAGE))
    assert set(FUNCTIONS) - words == set()
    for what, sections in READINGS.items():
        calls = set(re.findall(rf"^\|.*`{what}\((.*?)\)`", PAGE, re.M))
        assert {len(call.split(", ")) for call in calls} == {len(sections)}
