"""Units as values: parsed once, then multiplied and divided as readable text. Names that are not
usual are looked up with pint.

Power is ``^`` and a product ``*``: ``N*s^2/m^2``; what data sheets print is read too (``m/s²``,
``N·m``, ``N s/m``, ``Nm``, ``°``), and what loggers write (``m/s2``, ``min-1``, ``N-m``). ``rad``
is a number (factor 1) but stays in the text. Scales with an offset (degC) are refused: a difference
of 1 degC is 1 K.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from symhyb.errors import did_you_mean
from symhyb.limits import UNIT_LETTERS
from symhyb.usual_units import USUAL

DIMENSIONS = (
    "[length]",
    "[mass]",
    "[time]",
    "[current]",
    "[temperature]",
    "[substance]",
    "[luminosity]",
)

# pint knows a thousand names, also constants (k, c, e) and yarn counts (Nm): those would turn a
# slip of the pen into a valid unit. These are the ones a model of a machine needs.
_KNOWN = {
    "meter": "m",
    "second": "s",
    "gram": "g",
    "newton": "N",
    "radian": "rad",
    "degree": "deg",
    "hertz": "Hz",
    "joule": "J",
    "watt": "W",
    "pascal": "Pa",
    "volt": "V",
    "ampere": "A",
    "ohm": "ohm",
    "coulomb": "C",
    "farad": "F",
    "henry": "H",
    "tesla": "T",
    "weber": "Wb",
    "siemens": "S",
    "kelvin": "K",
    "mole": "mol",
    "candela": "cd",
    "minute": "min",
    "hour": "h",
    "day": "d",
    "turn": "turn",
    "revolution": "revolution",
    "revolutions_per_minute": "rpm",
    "inch": "in",
    "foot": "ft",
    "yard": "yd",
    "mile": "mi",
    "nautical_mile": "nmi",
    "pound": "lb",
    "ounce": "oz",
    "slug": "slug",
    "force_pound": "lbf",
    "kip": "kip",
    "force_kilogram": "kgf",
    "pound_force_per_square_inch": "psi",
    "bar": "bar",
    "standard_atmosphere": "atm",
    "liter": "l",
    "metric_ton": "t",
    "knot": "knot",
    "mile_per_hour": "mph",
    "kilometer_per_hour": "kph",
    "metric_horsepower": "metric_horsepower",
    "arcminute": "arcmin",
    "arcsecond": "arcsec",
}
_OTHERWISE = {"Grad": "a degree in German, or 10^9 radians; write 'deg' or 'rad'"}
"""Names that mean two things, and how either is written."""
_ANGLES = frozenset({"radian", "degree", "turn", "revolution", "arcminute", "arcsecond"})
_USUAL = (*_KNOWN.values(), "kg", "mm", "um", "cm", "km", "ms", "us", "kN", "mN", "mV", "kHz", "mA")

# what print has and keyboards have not; and products of newtons that are written as one word
_PRINTED = str.maketrans({"·": "*", "⋅": "*", "×": "*", "∙": "*", "−": "-"})
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_POWER = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+")
_DEGREE = re.compile(r"°(?! ?[CFK]\b)")
_LETTERS = "A-Za-zµμΩ"
_ATTACHED = re.compile(rf"(?<=[{_LETTERS}])-?[1-9](?![\d.])")  # the power in m/s2 and min-1
_HYPHEN = re.compile(rf"(?<=[{_LETTERS}])-(?=[{_LETTERS}])")  # the product in N-m
_GLUED = re.compile(r"([kMm]?N)(mm|m|s)(s?)")

Atoms = tuple[tuple[str, Fraction], ...]


class UnitError(ValueError):
    """A text that is no unit; the message is a sentence with the nearest known one."""


@dataclass(frozen=True, slots=True, repr=False)
class Unit:
    """A unit of measurement: ``text`` for people, ``factor`` to coherent SI for numbers.

    ``dimension`` holds the exponents of length, mass, time, current, temperature, substance and
    luminosity. Two units may be equal in dimension and factor and still read differently.
    """

    text: str = "1"
    factor: float = 1.0
    dimension: tuple[Fraction, ...] = (Fraction(0),) * len(DIMENSIONS)

    def __mul__(self, other: "Unit") -> "Unit":
        return Unit(
            _text((*_atoms(self.text), *_atoms(other.text))),
            self.factor * other.factor,
            tuple(a + b for a, b in zip(self.dimension, other.dimension, strict=True)),
        )

    def __truediv__(self, other: "Unit") -> "Unit":
        return self * other**-1

    def __pow__(self, power: int | Fraction) -> "Unit":
        return Unit(
            _text((name, exponent * power) for name, exponent in _atoms(self.text)),
            self.factor ** float(power),
            tuple(exponent * power for exponent in self.dimension),
        )

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Unit {self.text}>"

    def same_dimension(self, other: "Unit") -> bool:
        """Say whether a value in one unit can be converted to the other."""
        return self.dimension == other.dimension

    @property
    def is_number(self) -> bool:
        """Whether the unit has no dimension (``1``, ``rad``, ``mm/m``)."""
        return not any(self.dimension)

    @property
    def is_angle(self) -> bool:
        """Whether the unit is that of an angle (``rad``, ``deg``, ``mrad``)."""
        atoms = _atoms(self.text)
        return len(atoms) == 1 and atoms[0][1] == 1 and _is_angle(atoms[0][0])


ONE = Unit()


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit:
    """Read a unit such as ``N*s^2/m^2``; ``1`` is the unit of a plain number.

    Raises:
        UnitError: an unknown name, a wrong sign, or a scale with an offset.
    """
    if len(text) > UNIT_LETTERS:
        raise UnitError(f"'{text[:40]}…' is too long for a unit")
    result = ONE
    atoms = _atoms(text)
    for name, exponent in atoms:
        result = result * _named(name) ** exponent
    return Unit(_text(atoms), result.factor, result.dimension)


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


@lru_cache(maxsize=256)
def _pint_name(name: str) -> str:
    """Return pint's name of a unit without its prefix, empty if it is not one of ours."""
    if name in USUAL:
        return USUAL[name][0]
    for _, base, plural in _registry().parse_unit_name(name):
        if base in _KNOWN and not plural:
            return str(base)
    return ""


def _is_angle(name: str) -> bool:
    return _pint_name(name) in _ANGLES


@lru_cache(maxsize=256)
def _named(name: str) -> Unit:
    """Look up one name without power."""
    if name in _OTHERWISE:
        raise UnitError(f"'{name}' may be {_OTHERWISE[name]}")
    if name in USUAL:
        _, factor, usual = USUAL[name]
        rest = len(DIMENSIONS) - len(usual)
        return Unit(name, factor, (*map(Fraction, usual), *(Fraction(0),) * rest))
    registry = _registry()
    if not _pint_name(name):
        raise UnitError(_unknown(name))
    si = registry.Quantity(1.0, name).to_base_units()
    dimensions = dict(si.dimensionality)
    exponents = (Fraction(dimensions.get(key, 0)).limit_denominator(12) for key in DIMENSIONS)
    return Unit(name, float(si.magnitude), tuple(exponents))


def _unknown(name: str) -> str:
    """Say that a name is no unit, with the likeliest cure."""
    if name in ("degC", "degF", "celsius", "fahrenheit"):
        cure = "write temperatures in K, a column x of degC as 'x + 273.15 [K]'"
        return f"'{name}' is a scale with an offset; {cure}"
    glued = r"kg|rad|mm|[NmsVAJ]"
    if re.fullmatch(f"(?:{glued}){{2,4}}", name):
        product = "*".join(re.findall(glued, name))
        return f"'{name}' is not a known unit; did you mean '{product}'?"
    return f"'{name}' is not a known unit{did_you_mean(name, (*_USUAL, *_KNOWN))}"


@lru_cache(maxsize=4096)
def _atoms(text: str) -> Atoms:
    """Split ``N*s^2/m^2`` into (N, 1), (s, 2), (m, -2), in the order met."""
    plain = _POWER.sub(lambda raised: "^" + raised[0].translate(_RAISED), text)
    plain = _DEGREE.sub(" deg ", plain.translate(_PRINTED)).replace("°", "deg")
    plain = _ATTACHED.sub(r"^\g<0>", _HYPHEN.sub("*", plain))
    tokens = re.findall(r"[A-Za-zµμΩ][A-Za-zµμΩ_]*|\d+\.\d+|\d+|\*\*|[^\s]", plain)
    atoms, rest = _product([part for token in tokens for part in _apart(token)], text)
    if rest:
        raise UnitError(_unreadable(text, rest[0]))
    return _merged(atoms)


def _product(tokens: list[str], text: str) -> tuple[list[tuple[str, Fraction]], list[str]]:
    """Read ``factor (*|/) factor …`` and return what is left of the tokens."""
    atoms, rest = _power(tokens, text)
    divided = False
    while rest and (rest[0] in ("*", "/") or rest[0][0].isalpha()):
        if rest[0][0].isalpha():  # a blank between two names is a product
            if divided:
                raise UnitError(f"'{text}' may be read in two ways; write '*', '/' or parentheses")
            rest = ["*", *rest]
        sign, divided = (1, divided) if rest[0] == "*" else (-1, True)
        more, rest = _power(rest[1:], text)
        atoms = atoms + [(name, sign * exponent) for name, exponent in more]
    return atoms, rest


def _apart(token: str) -> list[str]:
    """Split ``Nm``, ``Ns`` and ``Nms``, which are products and no names, into their parts."""
    found = _GLUED.fullmatch(token)
    if found is None or (found[2] == "s" and found[3]):
        return [token]
    parts = [part for part in found.groups() if part]
    return " * ".join(parts).split()


def _power(tokens: list[str], text: str) -> tuple[list[tuple[str, Fraction]], list[str]]:
    """Read a name, ``1`` or a group in parentheses, with its power."""
    if not tokens:
        raise UnitError(f"'{text}' ends too early for a unit" if text.strip() else "unit is empty")
    first, rest = tokens[0], tokens[1:]
    if first == "(":
        atoms, rest = _product(rest, text)
        if not rest or rest[0] != ")":
            raise UnitError(f"'{text}' lacks a ')'")
        rest = rest[1:]
    elif first == "1":
        atoms = []
    elif first[0].isalpha():
        atoms = [(first, Fraction(1))]
    else:
        raise UnitError(_unreadable(text, first))
    if rest and rest[0] == "^":
        exponent, rest = _exponent(rest[1:], text)
        atoms = [(name, power * exponent) for name, power in atoms]
    return atoms, rest


def _exponent(tokens: list[str], text: str) -> tuple[Fraction, list[str]]:
    """Read ``2``, ``-1``, ``0.5`` or ``(1/2)``."""
    found = re.match(r"\(-?\d+/\d+\)|-?\d+(\.\d+)?", "".join(tokens[:6]))
    if not found:
        raise UnitError(f"'{text}' needs a number after '^'")
    try:
        exponent = Fraction(found.group().strip("()"))
    except ZeroDivisionError:
        raise UnitError(f"'{text}' has a power over 0") from None
    if abs(exponent) > 20 or exponent.denominator > 12:
        raise UnitError(f"'{text}' has the power {exponent}, which no unit needs")
    used = 0
    while used < len(tokens) and len("".join(tokens[:used])) < len(found.group()):
        used += 1
    return exponent, tokens[used:]


def _unreadable(text: str, part: str) -> str:
    if part == "**":
        return f"'{text}' is not a unit: power is '^' in units"
    return f"'{text}' is not a unit: '{part}' is unexpected; write it like 'N*s^2/m^2'"


def _merged(atoms: Iterable[tuple[str, Fraction]]) -> Atoms:
    total: dict[str, Fraction] = {}
    for name, exponent in atoms:
        total[name] = total.get(name, Fraction(0)) + exponent
    return tuple((name, exponent) for name, exponent in total.items() if exponent)


def _text(atoms: Iterable[tuple[str, Fraction]]) -> str:
    """Write atoms with the numerators first: ``N*s^2/m^2``, ``1/s``."""
    merged = _merged(atoms)
    above = "*".join(_written(name, power) for name, power in merged if power > 0)
    below = "".join("/" + _written(name, -power) for name, power in merged if power < 0)
    return (above or "1") + below


def _written(name: str, power: Fraction) -> str:
    if power == 1:
        return name
    return f"{name}^{power}" if power.denominator == 1 else f"{name}^({power})"
