"""The page on URDF: its commands run as they stand, with the robot that it shows."""

import re
import shlex
import sys
from pathlib import Path

import pytest

from symhyb.cli import main

PAGE = (Path(__file__).parents[2] / "docs" / "from-a-urdf.md").read_text(encoding="utf-8")

FOUND = """
[elements.found_friction]
kind = "friction"
on = "shoulder"
coulomb = "F"
[elements.found_friction.parameters]
F = { value = 1.5, sd = 0.1, unit = "N*m" }
"""


def test_the_commands_of_the_page_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot,) = re.findall(r"^```xml\n(.*?)^```", PAGE, re.M | re.S)
    (tmp_path / "arm.urdf").write_text(robot)
    monkeypatch.chdir(tmp_path)
    commands = [line for line in re.findall(r"^    (symhyb .+)$", PAGE, re.M) if "[" not in line]
    assert len(commands) == 5
    for command in commands:
        if "corrected.toml" in command:  # what a diagnosis would leave behind
            model = (tmp_path / "arm.toml").read_text()
            (tmp_path / "corrected.toml").write_text(model + FOUND)
        monkeypatch.setattr(sys, "argv", shlex.split(command))
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code in (0, None), command
    assert "no problem found" in capsys.readouterr().out
    assert (tmp_path / "fall.csv").is_file()
    forearm = (tmp_path / "forearm.toml").read_text()
    assert "Locked: shoulder at 0.5236." in forearm
    assert "rigid with it: tool" in forearm
    losses = (tmp_path / "arm-corrected.urdf").read_text()
    assert '<dynamics damping="0.8" friction="3"/>' in losses  # as much again as stood there
