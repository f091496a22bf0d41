"""Names of a robot as names of a model file: letters, digits and _, none twice, none reserved."""

import re
from collections.abc import Iterable, Sequence

from symhyb.model.expression import RESERVED

LONGEST = 40  # letters, so that a suffix still fits into the 60 of a name
_OTHER = re.compile(r"[^A-Za-z0-9_]+")


def stems(
    names: Iterable[str], suffixes: Sequence[str], taken: set[str], letter: str
) -> dict[str, str]:
    """A stem for each name, so that no stem with one of the ``suffixes`` is another's.

    ``taken`` holds what is given away already, and grows; ``letter`` begins what would begin with a
    digit or is a reserved word.
    """
    found: dict[str, str] = {}
    for name in names:
        plain = identifier(name, letter)
        stem, count = plain, 1
        while any(stem + suffix in taken or stem + suffix in RESERVED for suffix in suffixes):
            count += 1
            stem = f"{plain}_{count}"
        taken.update(stem + suffix for suffix in suffixes)
        found[name] = stem
    return found


def identifier(name: str, letter: str) -> str:
    """The nearest name that a model file takes."""
    plain = _OTHER.sub("_", name).strip("_") if _OTHER.search(name) else name
    plain = plain[:LONGEST].rstrip("_") if len(plain) > LONGEST else plain
    if not plain or plain[0].isdigit() or plain in RESERVED:
        return f"{letter}_{plain}" if plain else letter
    return plain
