"""What the check of a built site finds."""

from pathlib import Path

import pytest
from _site.check_site import faults

import symhyb


@pytest.fixture
def site(tmp_path: Path) -> Path:
    entries = "".join(f'<dt id="symhyb.{name}"></dt>' for name in symhyb.__all__)
    (tmp_path / "style.css").write_text("")
    (tmp_path / "b.html").write_text('<h1 id="top">B</h1>')
    (tmp_path / "a.html").write_text(
        f'<link rel="stylesheet" href="style.css?v=1">{entries}'
        '<a href="b.html#top">b</a><a href="https://example.org">out</a><a href="#x" id="x">x</a>'
    )
    return tmp_path


def test_a_sound_site_has_no_faults(site: Path) -> None:
    assert list(faults(site)) == []


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('<a href="c.html">', "c.html leads to no file of the site"),
        ('<a href="../c.html">', "../c.html leads to no file of the site"),
        ('<a href="b.html#down">', "b.html#down leads to no such place"),
        ('<a href="#y">', "#y leads to no such place"),
        ('<img src="p.png">', "loads p.png, which is not there"),
        ('<script src="https://cdn.example.org/x.js">', "from the network"),
        ('<link rel="stylesheet" href="//fonts.example.org/a.css">', "from the network"),
    ],
)
def test_a_fault_is_told(site: Path, more: str, said: str) -> None:
    with (site / "b.html").open("a") as page:
        page.write(more)
    (found,) = faults(site)
    assert said in found


def test_a_name_without_an_entry_is_told(site: Path) -> None:
    page = site / "a.html"
    page.write_text(page.read_text().replace('id="symhyb.diff"', ""))
    assert list(faults(site)) == ["symhyb.diff has no entry"]


def test_no_page_is_a_fault(tmp_path: Path) -> None:
    assert len(list(faults(tmp_path))) == 1
