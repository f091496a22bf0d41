"""Every snippet of the documentation runs as it stands, or its page says why not."""

import re
from pathlib import Path

import pytest
from snippets import ROOT, Ran, differs, of_the_whole, run_page, runs, snippets

PAGES = sorted({ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("docs/**/*.md")})
# pages that have a test of their own, which says more of what they print
OWN = {"README.md": "test_readme.py", "docs/from-a-urdf.md": "imports/test_docs_page.py"}
OTHERS = [
    page
    for page in PAGES
    if page.relative_to(ROOT).as_posix() not in OWN and any(map(runs, snippets(page)))
]


def paced(page: Path) -> object:
    """A page as a parameter of a test, with the marker of its pace."""
    whole = of_the_whole(page)
    pace = [getattr(pytest.mark, kind) for kind in ("slow", "thorough") if kind in whole]
    return pytest.param(page, marks=pace, id=page.relative_to(ROOT).as_posix())


@pytest.mark.parametrize("page", [paced(page) for page in OTHERS])
def test_the_snippets_of_a_page_run_and_print_what_it_shows(page: Path, tmp_path: Path) -> None:
    different = [text for text in map(differs, run_page(page, tmp_path)) if text]
    assert not different, "\n\n".join(different)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_no_command_of_a_page_escapes_being_run(page: Path) -> None:
    """Commands and Python stand in fenced blocks of their language, not in indented ones."""
    source = re.sub(r"^(`{3,}).*?^\1", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    verbs = r"(?:symhyb (?! *=)|python |pip |make |import |from )"
    indented = rf"^ {{4,}}(?:\$ )?(?:\.venv/bin/)?{verbs}.*"
    assert re.findall(indented, source, re.M) == []
    languages = {one.language for one in snippets(page)}
    assert languages & {"", "py", "bash", "sh", "shell"} == set()
    assert all(one.marks["not run"] for one in snippets(page) if "not run" in one.marks)


def shown(text: str, printed: str) -> str:
    page = ROOT / "README.md"
    return differs(Ran(snippets(page)[0], "symhyb", text, printed))


def test_a_transcript_is_held_to_its_words_and_about_to_its_numbers() -> None:
    printed = "On q the model lacks\n  drag (0.801 ± 0.004 N)\n  of 3 kinds\n"
    assert not shown("On q the model lacks drag (0.801 ± 0.004 N) of 3 kinds", printed)
    assert not shown("On q the model lacks drag (0.812 ± 0.004 N) of 3 kinds", printed)
    assert not shown("On q the model\n…\nof 3 kinds", printed)
    assert not shown("On q\n…\ndrag (0.801 ± 0.004 N)\n…\n", printed)
    assert shown("On q the model lacks drag (1.201 ± 0.004 N) of 3 kinds", printed)
    assert shown("On q the model lacks friction (0.801 ± 0.004 N) of 3 kinds", printed)
    assert shown("On q the model lacks drag (0.801 ± 0.004 N)", printed)
    assert shown("On q\n…\nof 4 kinds of springs", printed)


def test_a_snippet_that_fails_is_seen(tmp_path: Path) -> None:
    for text in (
        "```python\nassert 1 == 2\n```\n",
        "```console\n$ symhyb check nothing.toml\n```\n",
        "```console\n$ ls nowhere\n```\n",
        "<!-- exits with 3 -->\n```console\n$ symhyb --help\n```\n",
    ):
        with pytest.raises(AssertionError):
            run_text(text, tmp_path)


def test_files_setups_and_outputs_are_those_of_the_page(tmp_path: Path) -> None:
    text = (
        "<!-- setup:\nfirst = 2\n-->\n"
        "<!-- file: x.txt -->\n```text\nseven\n```\n"
        "```python\nfrom pathlib import Path\nprint(Path('x.txt').read_text() + str(first))\n```\n"
        "<!-- output -->\n```text\nseven\n2\n```\n"
        "```console\n$ cat x.txt\nseven\n$ ls \\\n    x.txt\n```\n"
        "<!-- not run: it would fail -->\n```python\nraise SystemExit\n```\n"
    )
    ran = run_text(text, tmp_path)
    assert [one.printed for one in ran] == ["seven\n2\n", "seven\n", "x.txt\n"]
    assert [one.shown.strip() for one in ran] == ["seven\n2", "seven", ""]
    assert list(filter(None, map(differs, ran))) == []


def run_text(text: str, folder: Path) -> list[Ran]:
    """Run a page that is not part of the documentation, in a folder beside it."""
    page, empty = folder / "page.md", folder / "run"
    page.write_text("<!-- begins in an empty folder -->\n" + text, encoding="utf-8")
    empty.mkdir(exist_ok=True)
    return run_page(page, empty)


@pytest.mark.parametrize("page", OWN)
def test_a_page_that_is_left_out_here_is_run_by_its_own_test(page: str) -> None:
    test = (ROOT / "tests" / OWN[page]).read_text(encoding="utf-8")
    assert "run_page" in test
    assert Path(page).name in test
