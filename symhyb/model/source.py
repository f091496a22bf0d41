"""Where things stand in a TOML text: line and span of every dotted name.

``tomllib`` gives values without positions. Messages need the line, and a correction changes one
number in place and leaves every other byte alone. This scanner walks a text that ``tomllib`` has
already accepted, so it can trust the grammar.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass

Path = tuple[str, ...]

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"[ \t]*(\"(?:\\.|[^\"\\])*\"|'[^']*'|[A-Za-z0-9_-]+)[ \t]*")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?""""{0,2}'
    r"|'''.*?''''{0,2}"
    r'|"(?:\\.|[^"\\])*"'
    r"|'[^']*'",
    re.DOTALL,
)
_SCALAR = re.compile(r"[^,\]}#\r\n]+")
_DEEPEST = 8  # names in a model file have at most five parts


@dataclass(frozen=True, slots=True)
class Entry:
    """A name in the text: ``line`` counts from 1, offsets are in characters.

    ``key`` is where the (dotted) key begins, ``last`` where its last part begins, ``start`` to
    ``end`` is the value. A table header has an empty value at its end. ``inline`` says that the
    name stands inside braces.
    """

    line: int
    key: int
    last: int
    start: int
    end: int
    inline: bool = False


@dataclass(frozen=True, slots=True)
class Source:
    """A TOML text and where its names stand; the tables of an array ``[[name]]`` are ``name[1]``,
    ``name[2]``, …"""

    text: str
    entries: dict[Path, Entry]

    def line(self, *path: str) -> int:
        """The line of a name, else of the nearest table around it, else 0 (the whole file)."""
        for length in range(len(path), 0, -1):
            around, name = path[: length - 1], path[length - 1]
            for found in ((*around, name), (*around, name.partition("[")[0])):  # or an array
                if found in self.entries:
                    return self.entries[found].line
        return 0


def scan(text: str) -> Source:
    """Find every name of a valid TOML text; a table without a header stands where first named."""
    breaks = [match.start() for match in re.finditer("\n", text)]
    entries: dict[Path, Entry] = {}
    for path, key, last, start, end, inline in _statements(text):
        line = bisect_right(breaks, key - 1) + 1
        for length in range(1, min(len(path), _DEEPEST)):
            entries.setdefault(path[:length], Entry(line, key, key, end, end, inline))
        entries[path] = Entry(line, key, last, start, end, inline)
    return Source(text, entries)


_Found = tuple[Path, int, int, int, int, bool]


def _statements(text: str) -> Iterator[_Found]:
    """Walk table headers and ``key = value`` lines."""
    table: Path = ()
    counts: dict[Path, int] = {}
    position = _blank(text, 1 if text.startswith("\ufeff") else 0)
    while position < len(text):
        if text[position] == "[":
            start, one_of_many = position, text.startswith("[[", position)
            name, _, position = _key(text, position + 1 + one_of_many)
            position = text.index("]", position) + 1 + one_of_many
            table = _numbered(name, counts, one_of_many)
            yield table, start, start, position, position, False
        else:
            found = list(_pair(text, position, table, inline=False))
            yield from found
            position = found[0][4]
        position = _blank(text, position)


def _numbered(name: Path, counts: dict[Path, int], one_more: bool) -> Path:
    """The name of a table with the number of the last table of each array that it is in; the
    ``counts`` of these, by name, get the table if it is ``one_more`` of an array."""
    table: Path = ()
    for i, part in enumerate(name):
        inside = (*table, part)
        if one_more and i == len(name) - 1:
            counts[inside] = counts.get(inside, 0) + 1
        table = (*table, f"{part}[{counts[inside]}]" if inside in counts else part)
    return table


def _pair(text: str, position: int, table: Path, inline: bool) -> Iterator[_Found]:
    """Yield ``key = value`` and then what the value contains."""
    path, last, after = _key(text, position)
    start = _blank(text, after + 1)
    inner: list[_Found] = []
    end = _value(text, start, table + path, inner)
    yield table + path, position, last, start, end, inline
    yield from inner


def _key(text: str, position: int) -> tuple[Path, int, int]:
    """Read a dotted key: its parts, where the last begins, and the offset after it."""
    parts: list[str] = []
    while match := _KEY.match(text, position):
        parts.append(match[1][1:-1] if match[1][0] in "\"'" else match[1])
        position = match.end()
        if not text.startswith(".", position):
            return tuple(parts), match.start(1), position
        position += 1
    raise ValueError(f"no key at offset {position}")


def _value(text: str, position: int, path: Path, inner: list[_Found]) -> int:
    """Return the offset after a value; names inside braces are added to ``inner``."""
    first = text[position]
    if first in "\"'":
        match = _STRING.match(text, position)
        return match.end() if match else len(text)
    if first not in "[{":
        match = _SCALAR.match(text, position)
        return position + len(match[0].rstrip()) if match else len(text)
    close = "]" if first == "[" else "}"
    position = _blank(text, position + 1)
    while text[position] != close:
        if first == "{":
            found = list(_pair(text, position, path, inline=True))
            inner.extend(found)
            position = found[0][4]
        else:
            position = _value(text, position, path, [])
        position = _blank(text, position)
        position = _blank(text, position + 1) if text[position] == "," else position
    return position + 1


def _blank(text: str, position: int) -> int:
    match = _BLANK.match(text, position)
    return match.end() if match else position
