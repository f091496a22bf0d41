"""Numbers with their unit in place in expressions: ``2 kg``, ``9.81 m/s^2``, ``0.32 m + x``.

    quantity = number blank unit           unit = factor { ("*" | "/") factor }, no blank in it
    factor   = letters [ "^" whole ]       or 1/factor at the beginning: 5 1/s

What stands directly behind ``*`` or ``/`` belongs to the unit, what stands behind a blank does not:
``2 N*m`` is a torque, ``2 N * m`` a product with what is called m. A name with a prime or with
parentheses is no unit: ``2 N*x'``.
"""

import keyword
import re
from collections.abc import Callable, Sequence

from symhyb.model.trees import ExpressionError, Quantity, brief, show
from symhyb.units import UnitError, parse_unit

MARK = "\u02bc"  # a letter for Python's parser, and outside the characters a file may use
_NAME = r"[A-Za-z_]\w*(?![\w']|\s*\()"
_NUMBER = r"(?<![\w.'])(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_FOUND = re.compile(
    rf"({_NUMBER})[ \t\r\n]+((?:1/)?{_NAME}(?:\^-?\d+)?(?:[*/]{_NAME}(?:\^-?\d+)?)*)", re.ASCII
)
_FACTOR = re.compile(r"[A-Za-z_]+")


def quantities_out(text: str) -> tuple[str, tuple[Quantity, ...]]:
    """The text with a marked name in place of each number with a unit, and these numbers.

    Raises:
        ExpressionError: what follows a number is no unit, or a power of one is written ``**``.
    """
    found: list[Quantity] = []

    def taken(match: re.Match[str]) -> str:
        number, said = match[1], match[2]
        if keyword.iskeyword(said) and said != "in":  # Python's words, not ours
            return match[0]
        found.append(_read(number, said, text[match.end() :]))
        return f"{MARK}{len(found) - 1}{MARK}"

    return _FOUND.sub(taken, text), tuple(found)


def quantities_back(sentence: str, found: Sequence[Quantity]) -> str:
    """A sentence on a marked text with the numbers in place of their marks."""
    return re.sub(f"{MARK}(\\d+){MARK}", lambda match: show(found[int(match[1])]), sentence)


def beside_quantities(text: str, change: Callable[[str], str]) -> str:
    """A text in which what stands beside numbers with units is changed, and they are not."""
    parts, last = [], 0
    for match in _FOUND.finditer(text):
        parts += [change(text[last : match.start()]), match[0]]
        last = match.end()
    return "".join((*parts, change(text[last:])))


def factors_of(quantity: Quantity) -> frozenset[str]:
    """The names in a unit that stand behind ``*`` or ``/``, where a factor might be meant."""
    return frozenset(_FACTOR.findall("".join(re.findall(r"[*/].*", quantity.unit.text))))


def _read(number: str, said: str, after: str) -> Quantity:
    whole = brief(f"{number} {said}")
    if after.startswith(("**", "^")):
        raise ExpressionError(f"'{brief(whole + after)}': in a unit the power is '^', as in m^2")
    if re.match(r"[\w.']|\s*\(", after):  # only behind a power: a name takes all its letters
        raise ExpressionError(
            f"'{brief(whole + after)}': a power in a unit is a whole number, as in m^2, and what "
            "it is multiplied by stands behind '*'"
        )
    names = re.findall(r"[A-Za-z_]\w*", said)
    try:
        if any(not _FACTOR.fullmatch(name) for name in names):
            raise UnitError("a power is written with '^', as in m^2")
        unit = parse_unit(said)
    except UnitError as error:
        cure = f"a product is '{number}*{said}'"
        if len(names) > 1:
            cure = f"a product is '{number} {names[0]} * {names[1]}', with blanks, or '{number}*…'"
        raise ExpressionError(f"'{whole}' has no readable unit: {error}; {cure}") from None
    value = float(number) * unit.factor
    if not abs(value) < float("inf"):
        raise ExpressionError("a number is not finite")
    return Quantity(value, unit)
