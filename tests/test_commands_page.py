"""docs/commands.md: every verb has a section with a run, and the runs print what stands there."""

import re
import shlex
import shutil
from pathlib import Path

import pytest
from command import Call
from test_cli import VERBS

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
SLOW = {"diagnose", "learn", "export", "run"}


def runs() -> list[tuple[str, str, list[str]]]:
    """The section, the command and the lines that it prints, of each run of the page."""
    found = []
    for section, text in re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S):
        for block in re.findall(r"^```console\n(.*?)^```", text, re.M | re.S):
            command, *lines = block.splitlines()
            found.append((section, command.removeprefix("$ symhyb "), lines))
    return found


def pattern(lines: list[str]) -> re.Pattern[str]:
    """What the output must match: ``...`` stands for any lines where it is a line, else letters."""
    parts = []
    for line in lines:
        if line == "...":
            parts.append(r"(?:.*\n)*?")
        else:
            parts.append(r".*".join(map(re.escape, line.split("..."))) + r"\n")
    return re.compile("".join(parts))


def carried_out(symhyb: Call, tmp_path: Path, wanted: set[str]) -> None:
    for folder in ("models", "studies"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("*.png"))
    (tmp_path / "pyproject.toml").touch()  # a study may name files of its project
    for section, command, lines in runs():
        if section in wanted:
            done = symhyb(*shlex.split(command))
            assert done.status == (section == "diagnose"), f"{command}: {done.err}"
            assert pattern(lines).fullmatch(done.out), f"{command}\n{done.out}"


def test_every_verb_has_a_section_with_a_run() -> None:
    assert {section for section, _, _ in runs()} == {*(verb.split()[0] for verb in VERBS), "export"}


def test_the_quick_runs_print_what_the_page_says(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    carried_out(symhyb, tmp_path, {section for section, _, _ in runs()} - SLOW)


@pytest.mark.slow
def test_the_long_runs_print_what_the_page_says(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    carried_out(symhyb, tmp_path, SLOW)


def test_lines_that_are_left_out_may_be_any() -> None:
    assert pattern(["a", "...", "b 1..."]).fullmatch("a\nx\ny\nb 12\n")
    assert pattern(["a", "...", "b"]).fullmatch("a\nb\n")
    assert not pattern(["a", "..."]).fullmatch("x\na\n")
