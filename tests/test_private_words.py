"""No docstring and no page uses the private words of an early state; the field has words for
them."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest
from parsed import sources
from snippets import ROOT, snippets

# what was written -> what the field writes; a pattern may say in which sense a word is meant
PRIVATE = {
    r"dull": "nuisance, parametric",
    r"(?:channels?|sensors?|inputs?|recordings?) (?:that |which )?lies?|lying|liars?": "faulty",
    r"stranger recordings?|strangers? among": "outlier recording",
    r"kin": "variant of a law",
    r"twins?": "indistinguishable cause",
    r"luck|lucky": "sampling variance",
    r"winners?": "selected structure",
    r"earns?|earned": "passes the selection",
    r"believed|believable": "admissible, selected",
    r"hopes?|hoped|hopeful|hopeless": "expected gain",
    r"promis(?:es?|ed)": "screening gain, prediction",
    r"void": "empty, without a gain",
    r"la(?:y|ys|id) (?:of )?windows?|(?:are|is|were) laid(?! out)": "made, placed",
    r"suited": "adapted",
    r"sags?": "hold error",
    r"calm": "predictable",
    r"forgets?": "decays, decorrelates",
    r"desks?": "workspace",
    r"leaps?": "watched step",
    r"anchors? of (?:the )?(?:windows?|inner)|off-anchor": "prior of inner states",
    r"told|tells?": "reported, named, distinguished, determined",
}
# a page that lists them, and one that quotes what was printed
EXEMPT = {"docs/style.md", "docs/recordings.md"}
WORDS = {word: re.compile(rf"(?<![\w-])(?:{word})(?![\w-])", re.I) for word in PRIVATE}


@cache
def docstrings() -> list[tuple[str, str]]:
    """Where and what: every docstring of the package, without its code."""
    found = []
    for file, tree in sources().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                text = ast.get_docstring(node) or ""
                place = f"{file}:{getattr(node, 'lineno', 1)}"
                found.append((place, re.sub(r"``[^`]*``", "", " ".join(text.split()))))
    return found


@cache
def pages() -> list[tuple[str, str]]:
    """Where and what: every line of the pages for people, without code and what was printed."""
    found = []
    names = ("README.md", "CONTRIBUTING.md", "SECURITY.md")
    for page in (*(ROOT / name for name in names), *sorted(ROOT.glob("docs/**/*.md"))):
        name = page.relative_to(ROOT).as_posix()
        if name not in EXEMPT:
            found += [(f"{name}:{i}", line) for i, line in enumerate(prose(page).splitlines(), 1)]
    return found


def prose(page: Path) -> str:
    """A page without its blocks and code, line by line as it was."""
    text = page.read_text(encoding="utf-8")
    for one in snippets(page):
        text = text.replace(one.text, "\n" * one.text.count("\n"), 1)
    return re.sub(r"`[^`\n]*`", "", text)


@pytest.mark.parametrize("word", PRIVATE)
def test_no_docstring_has_a_private_word(word: str) -> None:
    assert uses(word, docstrings()) == [], f"write: {PRIVATE[word]}"


@pytest.mark.parametrize("word", PRIVATE)
def test_no_page_has_a_private_word(word: str) -> None:
    assert uses(word, pages()) == [], f"write: {PRIVATE[word]}"


def uses(word: str, texts: list[tuple[str, str]]) -> list[str]:
    return [
        f"{place}: …{text[max(0, m.start() - 40) : m.end() + 40]}…"
        for place, text in texts
        for m in WORDS[word].finditer(text)
    ]


def test_the_list_sees_its_words_and_leaves_others_alone() -> None:
    for text in (
        "the winner",
        "Channels that lie",
        "what the recording tells",
        "its twin",
        "The law earns its place",
        "they are laid on it",
    ):
        assert any(uses(word, [("here", text)]) for word in PRIVATE), text
    for text in (
        "the point lies on the line",
        "files from strangers",
        "laid out as arrays",
        "kinematics",
        "a voided warranty",
        "avoid",
        "over the settled periods",
    ):
        assert not any(uses(word, [("here", text)]) for word in PRIVATE), text
    assert len(docstrings()) > 2000
