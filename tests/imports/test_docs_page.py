"""The page on URDF: what its commands leave, with the robot that it shows."""

from pathlib import Path

from snippets import ROOT, run_page


def test_the_commands_of_the_page_leave_what_it_says(tmp_path: Path) -> None:
    ran = run_page(ROOT / "docs" / "from-a-urdf.md", tmp_path)
    assert len(ran) == 4
    assert "no problem found" in ran[1].printed
    assert (tmp_path / "fall.csv").is_file()
    forearm = (tmp_path / "forearm.toml").read_text()
    assert "Locked: shoulder at 0.5236." in forearm
    assert "rigid with it: tool" in forearm
