"""The page on URDF: its commands run as they stand, with the robot that it shows."""

import re
import shlex
import sys
from pathlib import Path

import pytest

from symhyb.cli import main

PAGE = (Path(__file__).parents[2] / "docs" / "from-a-urdf.md").read_text(encoding="utf-8")


def test_the_commands_of_the_page_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot,) = re.findall(r"^```xml\n(.*?)^```", PAGE, re.M | re.S)
    (tmp_path / "arm.urdf").write_text(robot)
    monkeypatch.chdir(tmp_path)
    commands = [line for line in re.findall(r"^    (symhyb .+)$", PAGE, re.M) if "[" not in line]
    assert len(commands) == 4
    for command in commands:
        monkeypatch.setattr(sys, "argv", shlex.split(command))
        with pytest.raises(SystemExit) as stop:
            main()
        assert stop.value.code in (0, None), command
    assert "no problem found" in capsys.readouterr().out
    assert (tmp_path / "fall.csv").is_file()
    forearm = (tmp_path / "forearm.toml").read_text()
    assert "Locked: shoulder at 0.5236." in forearm
    assert "rigid with it: tool" in forearm
