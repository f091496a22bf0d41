"""Where elements of XML stand in a text, and small changes of it that leave all else as it was."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from xml.sax.handler import ContentHandler
from xml.sax.xmlreader import AttributesImpl, Locator

_NAME = re.compile(r"[A-Za-z_:][\w:.-]*")


@dataclass(slots=True)
class Span:
    """An element: its ``tag`` and ``attributes``, where its start tag begins and ends in the text,
    where its end tag begins (at the end of the start tag if it has none), and its ``children``."""

    tag: str
    attributes: Mapping[str, str]
    begin: int
    inside: int
    end: int = 0
    children: list["Span"] = field(default_factory=list)

    def first(self, tag: str) -> "Span | None":
        """The first child of a tag, None without one."""
        return next((child for child in self.children if child.tag == tag), None)

    def every(self, tag: str) -> list["Span"]:
        """All elements of a tag in this one, at any depth."""
        found = [self] if self.tag == tag else []
        for child in self.children:
            found += child.every(tag)
        return found


def spans_of(text: str) -> Span:
    """The elements of a well-formed text that was read before, with their places."""
    handler = _Places(text)
    import_module("defusedxml.sax").parseString(text.encode(), handler, forbid_dtd=True)
    assert handler.root is not None  # a text without an element is not well-formed
    return handler.root


class _Places(ContentHandler):
    """Collects elements with their places. Expat gives a line, and a column in characters."""

    def __init__(self, text: str):
        super().__init__()
        self.root: Span | None = None
        self._text, self._open = text, list[Span]()
        self._lines = [0, *(match.end() for match in re.finditer(r"\r\n|\n|\r", text))]
        self._place: Locator | None = None

    def setDocumentLocator(self, locator: Locator) -> None:
        self._place = locator

    def _at(self) -> int:
        assert self._place is not None
        line, column = self._place.getLineNumber() or 1, self._place.getColumnNumber() or 0
        return self._lines[line - 1] + column

    def startElement(self, name: str, attrs: AttributesImpl) -> None:
        begin = self._at()
        inside = end_of_tag(self._text, begin)
        span = Span(name, dict(attrs.items()), begin, inside)
        if self._open:
            self._open[-1].children.append(span)
        else:
            self.root = span
        self._open.append(span)

    def endElement(self, name: str) -> None:
        span = self._open.pop()
        closed = self._text.startswith("/>", span.inside - 2)
        span.end = span.inside if closed else self._at()


def end_of_tag(text: str, begin: int) -> int:
    """The place behind the ``>`` of the tag that begins there; values may hold a ``>``."""
    quote = ""
    for i in range(begin, len(text)):
        letter = text[i]
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        elif letter == ">":
            return i + 1
    return len(text)


Change = tuple[int, int, str]
"""Replace the characters from one place to another by a text."""


def changed(text: str, changes: list[Change]) -> str:
    """The text with all changes, which do not overlap."""
    for begin, end, new in sorted(changes, key=lambda one: one[:2], reverse=True):
        text = text[:begin] + new + text[end:]
    return text


def with_attributes(
    text: str, span: Span, values: Mapping[str, str], without: Iterable[str] = ()
) -> Change:
    """The change of a start tag that gives attributes these values: in place where they are, else
    behind the last one; those it shall be ``without`` go."""
    tag = text[span.begin : span.inside]
    for name in without:
        tag = re.sub(rf"\s{re.escape(name)}\s*=\s*(\"[^\"]*\"|'[^']*')", "", tag)
    for name, value in values.items():
        known = re.search(rf"(\s{re.escape(name)}\s*=\s*)(\"[^\"]*\"|'[^']*')", tag)
        if known:
            tag = f'{tag[: known.start(2)]}"{value}"{tag[known.end(2) :]}'
        else:
            close = len(tag) - (2 if tag.endswith("/>") else 1)
            kept = tag[:close].rstrip()
            gap = " " if close > len(kept) and tag.endswith("/>") else ""
            tag = f'{kept} {name}="{value}"{gap}{tag[close:]}'
    return span.begin, span.inside, tag


def indent_of(text: str, place: int) -> str:
    """The white space before the first letter of the line of a place."""
    line = text[text.rfind("\n", 0, place) + 1 : place]
    return line[: len(line) - len(line.lstrip())]


def first_inside(text: str, span: Span, lines: Sequence[str]) -> list[Change]:
    """Lines behind the start tag of an element, each indented as its children are."""
    return _block(text, span, lines, span.inside)


def last_inside(text: str, span: Span, lines: Sequence[str]) -> list[Change]:
    """Lines before the end tag of an element, each indented as its children are."""
    return _block(text, span, lines, len(text[: span.end].rstrip()))


def _block(text: str, span: Span, lines: Sequence[str], place: int) -> list[Change]:
    if not lines:
        return []
    newline, pad = newline_of(text), indent_of(text, span.begin)
    step = indent_of(text, span.children[0].begin) if span.children else pad
    step = step if len(step) > len(pad) else pad + "  "
    block = "".join(f"{newline}{step}{line}" for line in lines)
    if span.inside < span.end or not text.startswith("/>", span.inside - 2):
        return [(place, place, block)]
    close = len(text[: span.inside - 2].rstrip())  # an element without an end tag gets one
    return [(close, span.inside, f">{block}{newline}{pad}</{span.tag}>")]


def before(text: str, span: Span, lines: Sequence[str]) -> list[Change]:
    """Lines before an element, indented as it is."""
    newline, pad = newline_of(text), indent_of(text, span.begin)
    block = "".join(f"{line}{newline}{pad}" for line in lines)
    return [(span.begin, span.begin, block)] if lines else []


def newline_of(text: str) -> str:
    """How lines end in a text."""
    return "\r\n" if "\r\n" in text else "\n"


def comment(text: str) -> str:
    """A comment of XML, in which two hyphens may not stand side by side."""
    plain = "".join(letter if letter.isprintable() else " " for letter in text)
    while "--" in plain:
        plain = plain.replace("--", "- -")
    return f"<!-- {plain.rstrip('-')} -->"
