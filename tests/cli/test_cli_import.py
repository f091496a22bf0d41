"""`symhyb import`: what it writes and prints, and its exit status."""

import subprocess
import sys
from pathlib import Path

import pytest
from robots import ARM, joint, link, robot

from symhyb.cli.app import main


def run(*words: str) -> int:
    sys.argv = ["symhyb", *words]
    with pytest.raises(SystemExit) as stop:
        main()
    return int(stop.value.code or 0)


@pytest.fixture(autouse=True)
def _words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["symhyb"])


def test_an_arm_is_imported_checked_and_simulated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "arm.urdf", tmp_path / "arm.toml"
    source.write_text(ARM)
    words = ("--joints", "shoulder, elbow", "--at", "reach=0.1", "--at", "elbow=0.5", "--rates")
    assert run("import", str(source), "-o", str(target), "--passive", "elbow", *words) == 0
    assert capsys.readouterr().out.startswith(f"{target}: 2 coordinates")
    assert run("check", str(target)) == 0
    assert "shoulder_rate [rad/s]" in capsys.readouterr().out
    rows = tmp_path / "run.csv"
    assert run("simulate", str(target), "-o", str(rows), "--end", "0.1", "--step", "0.05") == 0
    assert rows.read_text().startswith("t [s],shoulder_torque [N*m],shoulder [rad]")


def test_what_is_otherwise_is_noted_on_stderr(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "odd.urdf"
    source.write_text(robot(link("a"), link("b"), joint("t", "revolute", "a", "b")))
    assert run("import", str(source), "-o", str(tmp_path / "odd.toml")) == 0
    assert capsys.readouterr().err == "note: the joint 't' is called joint_t here\n"


def test_mistakes_end_with_status_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, target = tmp_path / "arm.urdf", tmp_path / "arm.toml"
    source.write_text("<robot>")
    assert run("import", str(source), "-o", str(target)) == 2
    assert "is not well-formed XML" in capsys.readouterr().err
    assert not target.exists()


def test_help_loads_no_numerics() -> None:
    code = (
        "import sys; from symhyb.cli.imports import import_; "
        "print(sorted({'numpy', 'sympy', 'defusedxml', 'xml.sax'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
