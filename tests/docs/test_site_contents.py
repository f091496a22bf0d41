"""Tables of contents from the links of plain Markdown pages."""

from pathlib import Path, PurePosixPath

import pytest
from _site.contents import resolved, sections, titled, toctrees

ROOT = Path(__file__).parents[2]
INDEX = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")

PAGE = """# Home

- [Before](a.md)

## Start

- [In one page](../README.md): what it does
- [Part](a.md#part)
- [Elsewhere](picture.png)

## Evidence

- [A study](../studies/emps/README.md)
- [Before](a.md)
"""


def test_headings_with_lists_become_toctrees_with_captions() -> None:
    made = toctrees("docs/index", PAGE)
    assert made.count("{toctree}") == 3
    assert ":caption: Start\n\nIn one page </README>\n```" in made
    assert ":caption: Evidence\n\nA study </studies/emps/README>\n```" in made


def test_a_page_stands_in_one_toctree_only() -> None:
    assert toctrees("docs/index", PAGE).count("</docs/a>") == 1


def test_an_index_of_a_folder_gets_the_pages_that_it_does_not_list() -> None:
    beside = {"docs/how-to/index", "docs/how-to/b", "docs/how-to/a"}
    made = toctrees("docs/how-to/index", "# How to\n\n- [B](b.md)\n", beside)
    assert made.count("{toctree}") == 2
    assert "B </docs/how-to/b>" in made
    assert "\n/docs/how-to/a\n" in made
    assert "caption" not in made
    assert toctrees("docs/how-to/index", "# How to\n", {"docs/how-to/index"}) == ""


def test_a_page_with_a_toctree_of_its_own_is_left_alone() -> None:
    assert toctrees("docs/index", PAGE + "```{toctree}\n```\n") == ""


@pytest.mark.parametrize(
    ("target", "page"),
    [("a.md", "docs/how-to/a"), ("../b.md", "docs/b"), ("../../README.md", "README")],
)
def test_links_are_resolved(target: str, page: str) -> None:
    assert resolved(PurePosixPath("docs/how-to"), target) == page


def test_a_page_under_a_title_has_lower_headings() -> None:
    assert titled("# A\n\n## B\n", "T") == "# T\n\n## A\n\n### B\n"


def test_the_site_has_its_six_parts() -> None:
    parts = [heading for heading, _ in sections(INDEX)]
    six = ["Start", "Tutorials", "How to", "Explanation", "Reference", "Evidence"]
    assert parts[1:7] == six
    assert toctrees("docs/index", INDEX).count("{toctree}") >= len(six)


def test_every_study_is_listed() -> None:
    listed = (ROOT / "docs" / "evidence" / "index.md").read_text(encoding="utf-8")
    studies = {file.parent.name for file in ROOT.glob("studies/*/README.md")}
    assert {name for name in studies if f"studies/{name}/README.md" not in listed} == set()
