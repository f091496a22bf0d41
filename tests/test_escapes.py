"""Text of a file on its way into C, XML, HTML, TOML, LaTeX and a terminal: whatever its letters, it
comes out as that text or as nothing that is obeyed. Drawn at random, with a liking for letters that
mean something somewhere."""

import random
import re
import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from html.parser import HTMLParser

from jinja2 import Environment

from symhyb.errors import is_text, visible
from symhyb.export.c_code import comment as c_comment
from symhyb.mechanics.show_latex import _comment as latex_comment
from symhyb.model.render import _string

DRAWN = 3000
MEANING = (
    "\\",
    "/",
    "*",
    "*/",
    "/*",
    "//",
    "??/",
    "?",
    "\n",
    "\r",
    "\x0b",
    "\x0c",
    "\x85",
    "\u2028",
    "\x1b[2J",
    "\x9b",
    "\x00",
    "\x7f",
    "\u202e",
    "\ufeff",
    "\U000e0001",
    "<",
    ">",
    "&amp;",
    "&",
    "]]>",
    "'",
    '"',
    '"""',
    "%",
    "$",
    "{",
    "{{ 1 }}",
    "{% x %}",
    "#",
    "=",
    "@",
    "<script>",
    "é",
    "λ",
    "漢",
    "🜚",
    " ",
    "a",
)


def texts() -> Iterator[str]:
    chance = random.Random(18)
    for _ in range(DRAWN):
        yield "".join(chance.choice(MEANING) for _ in range(chance.randrange(1, 12)))
    for _ in range(DRAWN):
        codes = (chance.randrange(0x110000) for _ in range(chance.randrange(1, 12)))
        yield "".join(chr(code) for code in codes if not 0xD800 <= code < 0xE000)


def without_comments(code: str) -> str:
    """C after the first phases of translation: trigraphs, joined lines, comments."""
    joined = re.sub(r"\\[ \t]*(\r\n|\r|\n)", "", code.replace("??/", "\\"))
    return re.sub(r"/\*.*?\*/", " ", joined, count=1, flags=re.S)


def test_a_c_comment_ends_where_it_should() -> None:
    for text in texts():
        code = f"/* {c_comment(text)} */\nint after;\n"
        assert len(code.splitlines()) == 2
        assert without_comments(code).split() == ["int", "after;"], repr(text)


def test_a_line_of_a_latex_comment_stays_one() -> None:
    for text in texts():
        said = latex_comment(text)
        assert said.startswith("% ")
        assert len(said.splitlines()) == 1, repr(text)


def test_a_string_of_a_model_file_is_read_as_it_was() -> None:
    for text in texts():
        assert tomllib.loads(f"title = {_string(text)}\n")["title"] == text


def test_a_terminal_gets_letters_alone() -> None:
    for text in texts():
        shown = visible(text)
        assert all(is_text(letter) for letter in shown), repr(text)
        if all(is_text(letter) for letter in text):
            assert shown == text


def test_what_a_terminal_shows_is_the_same_in_xml() -> None:
    for text in texts():
        shown = visible(text)
        element = ET.Element("Tool", description=shown)
        assert ET.fromstring(ET.tostring(element)).attrib == {"description": shown}


class Words(HTMLParser):
    """The text of a page, and its tags."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.said: list[str] = []
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.said += [value or "" for _, value in attrs]

    def handle_data(self, data: str) -> None:
        self.said.append(data)


def test_a_page_shows_the_text_and_nothing_else() -> None:
    page = Environment(autoescape=True).from_string('<p title="{{ text }}">{{ text }}</p>')
    for text in texts():
        words = Words()
        words.feed(page.render(text=text))
        words.close()
        assert words.tags == ["p"], repr(text)
        assert words.said[0] == text
        assert "".join(words.said[1:]) == text
