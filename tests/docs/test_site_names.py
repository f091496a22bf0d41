"""Every public name stands on exactly one page of the reference."""

import re
from pathlib import Path

import pytest
from _site.names import defined, exported, home, names_text, within

import symhyb

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs" / "reference" / "python").glob("*.md"))
DIRECTIVE = re.compile(r"^```\{public-names\} ?(.*)\n((?::.*\n)*)```", re.MULTILINE)
OPTIMISATION = ("objective", "opti", "rollout", "sensitivities", "sweep")


def entries() -> list[str]:
    """What autodoc is told on all pages."""
    text = ""
    for page in PAGES:
        for rooms, options in DIRECTIVE.findall(page.read_text(encoding="utf-8")):
            given = dict(re.findall(r"^:(\w+): (.*)$", options, re.MULTILINE))
            modules, also = (given.get(key, "").split() for key in ("modules", "also"))
            text += names_text(rooms.split(), modules, also)
    return re.findall(r"^\.\. auto\w+:: (\S+)$", text, re.MULTILINE)


def test_every_exported_name_is_on_one_page() -> None:
    found = entries()
    assert {name: found.count(f"symhyb.{name}") for name in symhyb.__all__} == dict.fromkeys(
        symhyb.__all__, 1
    )


@pytest.mark.parametrize("module", OPTIMISATION)
def test_every_name_of_optimisation_is_on_a_page(module: str) -> None:
    path = f"symhyb.optimisation.{module}"
    assert {f"{path}.{name}" for name, _ in defined(path)} <= set(entries())


def test_what_the_pages_import_is_on_a_page() -> None:
    pages = [page for page in ROOT.rglob("docs/**/*.md") if page.name != "add-a-law.md"]
    text = "\n".join(page.read_text(encoding="utf-8") for page in (*pages, ROOT / "README.md"))
    named = [
        f"{module}.{name.strip()}"
        for module, names in re.findall(
            r"^ *from (symhyb[\w.]*) import ([\w, ]+)", text, re.MULTILINE
        )
        for name in names.split(",")
    ]
    assert named
    assert set(named) - set(entries()) == set()


def test_nothing_is_on_two_pages() -> None:
    found = entries()
    assert sorted(found) == sorted(set(found))


def test_a_room_is_not_another_with_a_longer_name() -> None:
    assert within("symhyb.model.read", "symhyb.model")
    assert not within("symhyb.models", "symhyb.model")
    assert home("read_model") == "symhyb.model.read"


def test_functions_come_before_classes() -> None:
    assert exported(["symhyb.data"]) == ["read_recording", "Recording"]
