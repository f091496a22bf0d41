"""What goes wrong, said once: where it is, what is wrong, and how to cure it.

User mistakes are collected as :class:`Problem` values and raised together in one
:class:`InputError`; numerical failure is not an exception but an outcome with a reason
(see :mod:`symhyb.numeric.runs.integrate`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from unicodedata import category

PLACE_MOST, TEXT_MOST = 200, 1000  # letters of a problem that are shown

# what turns the direction of writing: text that reads otherwise than it is
TURNING = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake in something a person gave.

    ``place`` is a dotted name inside the file (``elements.damper.dampin``), ``file`` and
    ``line`` say where it stands (``line`` 0: the whole file). ``text`` says what is wrong with the
    value quoted, and ends with the cure where there is one.
    """

    text: str
    place: str = ""
    file: str = ""
    line: int = 0

    def __str__(self) -> str:
        where = self.file + (f":{self.line}" if self.line else "")
        parts = (where, _cut(self.place, PLACE_MOST), _cut(self.text, TEXT_MOST))
        return visible(": ".join(part for part in parts if part))


class SymhybError(Exception):
    """Base of every error that symhyb raises on purpose."""


class InputError(SymhybError):
    """Something a person gave is wrong: all problems at once.

    Attributes:
        problems: every :class:`Problem` found, in the order of the file.
    """

    def __init__(self, problems: Problem | Iterable[Problem]):
        self.problems: tuple[Problem, ...] = (
            (problems,) if isinstance(problems, Problem) else tuple(problems)
        )
        super().__init__("\n".join(str(problem) for problem in self.problems))


class UnknownNameError(SymhybError, KeyError):
    """A name that nothing has; the message is the sentence with the nearest and with all names."""

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError would quote it


class NumericsError(SymhybError):
    """The numerics failed; the message is the sentence that says why (exit status 3)."""


def is_text(letter: str) -> bool:
    """Whether a letter is one of a text: no control character (a line's end and a tab are none
    here), none that turns the direction of writing, and none that Unicode keeps for no letter."""
    if letter in "\n\t" or letter.isprintable():
        return True
    code = ord(letter)
    noncharacter = code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF
    return not (noncharacter or letter in TURNING or category(letter) in ("Cc", "Cs", "Zl", "Zp"))


def visible(text: str) -> str:
    """Text that a terminal shows and does not obey: what is no letter of a text stands by its
    number (``\\u001b``)."""
    return "".join(letter if is_text(letter) else f"\\u{ord(letter):04x}" for letter in text)


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def did_you_mean(name: str, known: Sequence[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the nearest of ``known``, or what there is."""
    near = get_close_matches(name, known, n=1, cutoff=0.6)
    if near:
        return f"; did you mean '{near[0]}'?"
    if known:
        listed = ", ".join(list(known)[:12]) + (" …" if len(known) > 12 else "")
        return f"; known: {listed}"
    return ""
