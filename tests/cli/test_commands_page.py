"""docs/commands.md has a run of every verb; tests/test_docs_snippets.py runs them."""

import re
from pathlib import Path

from test_cli import VERBS

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")


def test_every_verb_has_a_section_with_a_run() -> None:
    sections = re.findall(r"^## ([\w-]+)\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S)
    shown = {name for name, text in sections if f"$ symhyb {name}" in text}
    assert shown == {*(verb.split()[0] for verb in VERBS), "export"}
