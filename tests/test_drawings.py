"""The drawings of signs: the files are what the script draws, and the page shows each in words."""

import re
import runpy
from pathlib import Path
from xml.etree import ElementTree

import pytest

HOW_TO = Path(__file__).parents[1] / "docs" / "how-to"
SCRIPT = runpy.run_path(str(HOW_TO / "drawings.py"))
PAGE = (HOW_TO / "signs.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", SCRIPT["DRAWINGS"])
def test_a_drawing_is_what_the_script_draws_and_is_on_the_page(name: str) -> None:
    text = (HOW_TO / "signs" / f"{name}.svg").read_text(encoding="utf-8")
    assert text == SCRIPT["drawing"](name), "run: python docs/how-to/drawings.py"
    (words,) = re.findall(rf"!\[([^]]+)\]\(signs/{name}\.svg\)", PAGE)
    assert len(words) > 20


@pytest.mark.parametrize("name", SCRIPT["DRAWINGS"])
def test_all_of_a_drawing_lies_within_its_frame(name: str) -> None:
    """Words as wide as a usual sans-serif makes them: 0.62 of the size of a letter."""
    root = ElementTree.fromstring(SCRIPT["drawing"](name))
    width, height = float(root.get("width", "0")), float(root.get("height", "0"))
    for each in root.iter("{http://www.w3.org/2000/svg}text"):
        long = 15 * 0.62 * len(each.text or "")
        x, y = float(each.get("x", "0")), float(each.get("y", "0"))
        left = x - {"start": 0.0, "middle": long / 2, "end": long}[each.get("text-anchor", "start")]
        assert left >= 0, each.text
        assert left + long <= width, each.text
        assert 12 <= y <= height - 4, each.text


def test_no_drawing_is_left_that_the_script_does_not_draw() -> None:
    files = {file.stem for file in (HOW_TO / "signs").iterdir()}
    assert files == set(SCRIPT["DRAWINGS"])
