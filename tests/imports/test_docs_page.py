"""The page on URDF: what its commands leave, with the robot that it shows."""

from pathlib import Path

from snippets import ROOT, run_page


def test_the_commands_of_the_page_leave_what_it_says(tmp_path: Path) -> None:
    ran = run_page(ROOT / "docs" / "from-a-urdf.md", tmp_path)
    assert len(ran) == 4
    assert "no problem found" in ran[1].printed
    assert (tmp_path / "fall.csv").is_file()
    point = 'tool = { body = "fore", at = ["tool_x", "0", "0"] }'
    assert point in (ROOT / "docs" / "from-a-urdf.md").read_text(encoding="utf-8")
    assert f"[points]\n{point}\n" in (tmp_path / "arm.toml").read_text()
    forearm = (tmp_path / "forearm.toml").read_text()
    assert "Locked: shoulder at 0.5236." in forearm
    assert "rigid with it: tool" in forearm
