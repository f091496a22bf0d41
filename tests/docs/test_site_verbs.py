"""The reference of the command line holds every verb and option that its help prints."""

import re

import typer
from _site.verbs import paragraphs, plain, section, verbs, verbs_text
from typer.main import get_command

from symhyb.cli.app import app


def test_every_verb_has_its_section() -> None:
    text = verbs_text()
    names = [path for path, _ in verbs(get_command(app), "symhyb")]
    assert "symhyb diagnose" in names
    assert any(name.startswith("symhyb data ") for name in names)
    assert re.findall(r"^## `(.+)`$", text, re.MULTILINE) == names


def test_every_option_is_told() -> None:
    for path, verb in verbs(get_command(app), "symhyb"):
        text = section(verb, path)
        flags = [flag for one in verb.params for flag in one.opts if flag.startswith("--")]
        assert [flag for flag in flags if flag not in text] == []


def test_an_example_keeps_its_lines() -> None:
    help_ = "Do it.\n\n\b\nExample:\n  tool a \\\n      --b"
    assert list(paragraphs(help_)) == ["Do it.", "Example:\n\n```console\ntool a \\\n    --b\n```"]


def test_signs_mean_nothing_to_markdown() -> None:
    assert plain("k_c <a|b> [1] --map-all") == r"k\_c \<a\|b\> \[1\] `--map-all`"


def test_a_hidden_verb_is_not_told() -> None:
    tool = typer.Typer()
    tool.command("seen")(lambda: None)
    tool.command("unseen", hidden=True)(lambda: None)
    assert [path for path, _ in verbs(get_command(tool), "tool")] == ["tool seen"]
