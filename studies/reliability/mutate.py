"""Inputs from a seed: mutations of bytes, of words, and of what a tree of values holds.

Everything follows from the random generator alone, so an input is known by its parser and number.
"""

import io
import json
import math
import tomllib
import zipfile
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

from grammar import expression, unit

Values = dict[str, Any]

NUMBERS = (0, 1, -1, 2, 0.5, -0.0, 1e-320, 1e308, -1e308, math.inf, math.nan, 2**63, 10**400)
TEXTS = (
    *("", " ", "x", "x'", "x''", "t", "pi", "nan", "1e999", "N*m", "m^-99999", "../../x", "/", "."),
    *(
        "*\\ */ ??/",
        "\x1b[31m",
        "\u202e",
        "\ud800",
        "\uffff",
        "\x00",
        "ß" * 50,
        "a" * 5000,
        "'" * 9,
    ),
    *("__import__('os')", "[0][0]", "x.y", "lambda: 0", "((" * 40, "-" * 300, "9**9**9", "1/0"),
    *("C:\\x", "<script>", "{{7*7}}", "%s%n", "=1+1", "k" * 101, "sin(" * 70 + "x" + ")" * 70),
)


def of_bytes(random: Random, data: bytes, words: Sequence[bytes]) -> bytes:
    """A few bytes or pieces changed, doubled, moved, left out, or replaced by ``words``."""
    result = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 3, 5, 12))):
        if not result:
            result = bytearray(random.randbytes(8))
        at, long = random.randrange(len(result)), random.choice((1, 1, 2, 4, 9, 40, 400))
        match random.randrange(8):
            case 0:
                result[at] ^= 1 << random.randrange(8)
            case 1:
                result[at] = random.choice((0, 9, 10, 34, 39, 127, 128, 255, random.randrange(256)))
            case 2:
                del result[at : at + long]
            case 3:
                result[at:at] = result[at : at + long]
            case 4:
                piece, to = result[at : at + long], random.randrange(len(result))
                result[to:to] = piece
            case 5:
                result[at : at + random.choice((0, long))] = random.choice(words)
            case 6:
                size = random.choice((2, 4, 8))
                number = random.choice(
                    (0, 1, 2**31 - 1, 2**32 - 1, 2**63 - 1, random.getrandbits(40))
                )
                result[at : at + size] = (number % 2 ** (8 * size)).to_bytes(size, "little")
            case 7:
                del result[at:]
    return bytes(result)


def of_zip(random: Random, data: bytes, words: Sequence[bytes]) -> bytes:
    """A ZIP archive with one of its files changed and its sums right again, or bytes of it."""
    if random.random() < 0.3:
        return of_bytes(random, data, words)
    written = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(written, "w") as new:
        names = old.namelist()
        chosen = random.choice(names)
        for name in names:
            content = old.read(name)
            new.writestr(
                zipfile.ZipInfo(name),  # of a fixed date: the input follows from its number
                of_bytes(random, content, words) if name == chosen else content,
                zipfile.ZIP_DEFLATED,
            )
    return written.getvalue()


def of_tree(random: Random, tree: Values) -> Values:
    """A few values of a tree changed: left out, renamed, exchanged, or replaced."""
    tree = json.loads(json.dumps(tree, default=str))
    for _ in range(random.choice((1, 1, 1, 2, 3, 6))):
        places = list(_places(tree))
        if not places:
            return tree
        holder, key = random.choice(places)
        match random.randrange(6):
            case 0:
                del holder[key]
            case 1 if isinstance(holder, dict):
                other = random.choice((*TEXTS, *holder, key + "_", key[:-1]))
                holder[other] = holder.pop(key)
            case 2:
                other, name = random.choice(places)
                holder[key] = json.loads(json.dumps(other[name]))
            case 3 if isinstance(holder, dict):
                holder[random.choice((*TEXTS, key + "2"))] = json.loads(json.dumps(holder[key]))
            case _:
                holder[key] = _value(random, holder[key])
    return tree


def _places(tree: Any) -> Any:
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
        yield tree, key
        if isinstance(value, dict | list):
            yield from _places(value)


def _value(random: Random, old: Any, depth: int = 0) -> Any:
    """Something that may stand where ``old`` stood."""
    if isinstance(old, str) and random.random() < 0.6:
        return random.choice((expression, unit, lambda r: r.choice(TEXTS)))(random)
    choices: tuple[Callable[[], Any], ...] = (
        lambda: random.choice(NUMBERS),
        lambda: random.choice(TEXTS),
        lambda: expression(random),
        lambda: unit(random),
        lambda: random.random() < 0.5,
        lambda: {} if depth > 3 else {random.choice(TEXTS): _value(random, old, depth + 1)},
        lambda: [] if depth > 3 else [_value(random, old, depth + 1)] * random.randrange(4),
        lambda: [old, old],
        lambda: round(random.gauss(0, 10), 3),
    )
    return random.choice(choices)()


def of_toml(random: Random, data: bytes, words: Sequence[bytes]) -> bytes:
    """A TOML text, its bytes or its values changed."""
    if random.random() < 0.3:
        return of_bytes(random, data, words)
    tree = of_tree(random, tomllib.loads(data.decode()))
    return "\n".join(f"{_quoted(k)} = {_toml(v)}" for k, v in tree.items()).encode(errors="replace")


def of_json(random: Random, data: bytes, words: Sequence[bytes]) -> bytes:
    """A JSON text, its bytes or its values changed."""
    if random.random() < 0.3:
        return of_bytes(random, data, words)
    return json.dumps(of_tree(random, json.loads(data))).encode()


def _toml(value: Any) -> str:
    match value:
        case dict():
            inside = ", ".join(f"{_quoted(k)} = {_toml(v)}" for k, v in value.items())
            return "{" + inside + "}"
        case list():
            return "[" + ", ".join(map(_toml, value)) + "]"
        case str():
            return _quoted(value)
        case bool():
            return str(value).lower()
        case None:
            return '""'
    return repr(value)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
