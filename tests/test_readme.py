"""The README: its example runs as it stands, its commands exist, its opening is short."""

import re
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def example() -> str:
    (code,) = re.findall(r"^```python\n(.*?)^```", README, re.M | re.S)
    return str(code)


def test_the_opening_says_what_it_is_for_in_three_sentences() -> None:
    opening = README.split("\n\n")[1]
    assert opening.count(".") == 3


def test_the_example_has_fifteen_lines() -> None:
    assert len(example().splitlines()) <= 15


def test_the_files_that_the_commands_name_exist() -> None:
    commands = re.findall(r"^    (.+)$", README, re.M)
    named = re.findall(r"(?:models|studies)/[\w/.]+", "\n".join(commands))
    assert named
    assert [name for name in named if not (ROOT / name).is_file()] == []


def test_the_example_runs_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in ("models", "studies"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    exec(compile(example(), "README.md", "exec"), {})
    out = capsys.readouterr().out
    assert "structure, not noise" in out
    assert "+ element found_friction" in out
    assert "+ element found_drag" in out
    corrected = (tmp_path / "oscillator-corrected.toml").read_text(encoding="utf-8")
    assert corrected.startswith((ROOT / "models" / "oscillator.toml").read_text(encoding="utf-8"))
    assert (tmp_path / "oscillator.html").stat().st_size > 10_000
