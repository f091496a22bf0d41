"""The README: its example runs as it stands, its commands exist, its opening is short."""

import re
from pathlib import Path

import pytest
from snippets import ROOT, run_page, snippets

PAGE = ROOT / "README.md"
README = PAGE.read_text(encoding="utf-8")
LINES = 90  # of the source; rendered it is one screen and a half
WITHIN_A_SCREEN = 15  # lines of the example


def example() -> str:
    (code,) = (one.text for one in snippets(PAGE) if one.language == "python")
    return code


def test_the_opening_says_what_it_is_for_in_three_sentences() -> None:
    opening = README.split("\n\n")[1]
    assert opening.count(".") == 3


def test_it_is_short() -> None:
    assert len(README.splitlines()) <= LINES
    assert len(example().splitlines()) <= WITHIN_A_SCREEN


def test_the_files_that_the_commands_name_exist() -> None:
    commands = [one.text for one in snippets(PAGE) if one.language == "console"]
    named = re.findall(r"(?:models|studies)/[\w/.]+", "\n".join(commands))
    assert named
    assert [name for name in named if not (ROOT / name).is_file()] == []


def test_the_command_that_is_not_run_here_is_run_by_a_tutorial() -> None:
    (command,) = re.findall(r"^\$ \S*(symhyb diagnose .+)$", README, re.M)
    (tutorial,) = re.findall(r"not run: .*?; (\S+) runs the second command", README)
    page = (ROOT / tutorial).read_text(encoding="utf-8")
    assert command in re.sub(r" \\\n\s+", " ", page)


def test_figures_that_it_cites_are_those_of_the_long_page() -> None:
    long = (ROOT / "docs" / "when-not-to-believe-it.md").read_text(encoding="utf-8")
    cannot = README.split("## What it cannot do")[1].split("\n## ")[0]
    figures = re.findall(r"\d+(?: %)?", cannot)
    assert figures
    assert [figure for figure in figures if figure not in long] == []


@pytest.mark.slow
def test_the_example_runs_as_it_stands(tmp_path: Path) -> None:
    (ran,) = run_page(PAGE, tmp_path)
    assert "the model lacks" in ran.printed
    assert "+ element found_friction" in ran.printed
    assert "+ element found_drag" in ran.printed
    corrected = (tmp_path / "oscillator-corrected.toml").read_text(encoding="utf-8")
    assert corrected.startswith((ROOT / "models" / "oscillator.toml").read_text(encoding="utf-8"))
    assert (tmp_path / "oscillator.html").stat().st_size > 10_000
