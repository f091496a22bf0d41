"""XML as a tree of plain values with line numbers, read so that a hostile file cannot hurt.

Entities, document types and whatever leads out of the file are refused by defusedxml; how large and
how deep a file may be is limited. Nothing is fetched and nothing is run.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any
from xml.sax import SAXException, SAXParseException
from xml.sax.handler import ContentHandler
from xml.sax.xmlreader import AttributesImpl, Locator

from symhyb.errors import InputError, Problem
from symhyb.limits import XML_DEEP

CURE = 'pip install "symhyb[urdf]"'


@dataclass(frozen=True, slots=True)
class Node:
    """An element of XML: its ``tag``, ``attributes``, ``children``, ``text`` and ``line``."""

    tag: str
    attributes: Mapping[str, str]
    line: int
    children: list["Node"] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The text directly inside."""
        return "".join(self.pieces).strip()

    def all(self, tag: str) -> list["Node"]:
        """The children of a tag."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> "Node | None":
        """The first child of a tag, None without one."""
        return next((child for child in self.children if child.tag == tag), None)


def parse_xml(data: bytes, file: str, ignored: frozenset[str] = frozenset()) -> Node:
    """The root of an XML file, without the elements in it whose tag is ``ignored``.

    Raises:
        InputError: no well-formed XML, or XML that declares a document type or entities, or lies
            deeper than ``XML_DEEP``; or defusedxml is not installed.
    """
    sax, common = _defused(file)
    handler = _Tree(ignored)
    problem = ""
    line = 0
    try:
        sax.parseString(data, handler, forbid_dtd=True)
    except common.DefusedXmlException:
        problem = "declares a document type or entities, which no robot needs; remove <!DOCTYPE …>"
        line = handler.line
    except _TooDeepError:
        problem = f"its elements lie more than {XML_DEEP} deep in each other"
        line = handler.line
    except SAXParseException as error:
        problem, line = f"is not well-formed XML: {error.getMessage()}", error.getLineNumber() or 0
    except (SAXException, ValueError, LookupError) as error:
        problem = f"is not readable as XML: {error}"
    if problem or handler.root is None:
        raise InputError(Problem(problem or "holds no element", file=file, line=line))
    return handler.root


def _defused(file: str) -> tuple[Any, Any]:
    try:
        return import_module("defusedxml.sax"), import_module("defusedxml.common")
    except ImportError:
        said = f"needs the package defusedxml, which is not installed; run: {CURE}"
        raise InputError(Problem(said, file=file)) from None


class _TooDeepError(Exception):
    """Elements lie deeper in each other than those of any robot."""


class _Tree(ContentHandler):
    """Collects the elements that are not ignored."""

    def __init__(self, ignored: frozenset[str]):
        super().__init__()
        self.root: Node | None = None
        self._ignored = ignored
        self._open: list[Node] = []
        self._skipped = 0
        self._place: Locator | None = None

    @property
    def line(self) -> int:
        return 0 if self._place is None else self._place.getLineNumber() or 0

    def setDocumentLocator(self, locator: Locator) -> None:
        self._place = locator

    def startElement(self, name: str, attrs: AttributesImpl) -> None:
        if len(self._open) + self._skipped >= XML_DEEP:
            raise _TooDeepError
        if self._skipped or (self._open and name in self._ignored):
            self._skipped += 1
            return
        node = Node(name, dict(attrs.items()), self.line)
        if self._open:
            self._open[-1].children.append(node)
        else:
            self.root = node
        self._open.append(node)

    def endElement(self, name: str) -> None:
        if self._skipped:
            self._skipped -= 1
        else:
            self._open.pop()

    def characters(self, content: str) -> None:
        if not self._skipped and self._open and not content.isspace():
            self._open[-1].pieces.append(content)
