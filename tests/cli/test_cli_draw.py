"""``symhyb draw`` as a person calls it."""

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from command import Call

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("model", ["cartpole", "furuta_pendulum", "four_bar"])
def test_a_machine_is_drawn(symhyb: Call, tmp_path: Path, model: str) -> None:
    target = tmp_path / "machine.svg"
    done = symhyb("draw", ROOT / "models" / f"{model}.toml", "-o", target)
    assert done.status == 0, done.err
    assert ET.fromstring(target.read_bytes()).tag.endswith("svg")
    again = symhyb("draw", ROOT / "models" / f"{model}.toml", "-o", target)
    assert "--force replaces it" in again.err


def test_the_picture_is_named_as_the_model(
    symhyb: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = symhyb("draw", ROOT / "models" / "loudspeaker.toml", "--show", "surround")
    assert (done.status, done.out) == (0, "loudspeaker.svg: written\n")
    assert "charge moves nothing that has a place" in done.err


def test_what_cannot_be_drawn_is_said(symhyb: Call, tmp_path: Path) -> None:
    model = ROOT / "models" / "cartpole.toml"
    done = symhyb("draw", model, "-o", tmp_path / "a.svg", "--show", "bnad")
    assert (done.status, done.out) == (2, "")
    assert "did you mean 'band'" in done.err
    assert "end the name in .svg or .png" in symhyb("draw", model, "-o", "a.pdf").err
    assert list(tmp_path.iterdir()) == []
