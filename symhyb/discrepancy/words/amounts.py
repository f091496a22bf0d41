"""Numbers and units in print: a blank before a unit, ``±`` before one standard deviation, a true
minus sign. Plain text, so that the same words serve the terminal, JSON and the report.
"""

import math
import re
from collections.abc import Sequence

UNKNOWN = "not known"
_MINUS = "\N{MINUS SIGN}"
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_EXACT = 1e-6  # a standard deviation below this part of the value says nothing to a reader
_PLAIN_FROM = {"m": 1.0, "s": 0.1}  # drawings are in mm, time constants in s


def number_text(value: float | None, sd: float | None = None, digits: int = 4) -> str:
    """Write ``value ± sd`` with the digits that ``sd`` supports, else with ``digits`` digits.

    ``sd`` is shown with two digits if the first is 1, else with one, and the value ends at the same
    place: ``20.3 ± 0.2``, ``203.5 ± 1.3``. Below 1e-3 and from 1e6 on a power of ten stands apart.
    """
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if sd is None or not math.isfinite(sd) or sd <= _EXACT * abs(value):
        return _plain(value, digits)
    shift = _shift(max(abs(value), sd))
    value, sd = value / 10.0**shift, sd / 10.0**shift
    mantissa, exponent = f"{sd:.1e}".split("e")
    places = (1 if mantissa.startswith("1") else 0) - int(exponent)
    both = f"{_fixed(value, places)} ± {_fixed(sd, places)}"
    return f"({both})·{power_text(shift)}" if shift else both


def unit_text(unit: str) -> str:
    """Write a unit as in print: ``N*s^2/m^2`` becomes ``N·s²/m²``, ``1`` nothing."""
    if unit == "1":
        return ""
    raised = re.sub(r"\^(-?\d+)(?![\d.])", lambda found: _superscript(int(found[1])), unit)
    return raised.replace("*", "·")


def quantity_text(value: float | None, unit: str, sd: float | None = None, digits: int = 4) -> str:
    """Write a number with its unit: ``20.3 ± 0.2 N``, ``(1.23 ± 0.02)·10⁻⁵ m``."""
    number = number_text(value, sd, digits)
    return number if number == UNKNOWN else f"{number} {unit_text(unit)}".rstrip()


def power_text(exponent: int) -> str:
    """Write a power of ten: ``10⁻⁵``."""
    return f"10{_superscript(exponent)}"


def percent_text(share: float | None) -> str:
    """Write a share in percent with two digits; what is not all or nothing never reads so."""
    if share is None or not math.isfinite(share):
        return UNKNOWN
    if 0.995 <= share < 1.0:
        return "more than 99.9 %" if share > 0.999 else f"{math.floor(1000.0 * share) / 10.0:.1f} %"
    if 0.0 < abs(share) < 1e-4:
        return "less than 0.01 %"
    return f"{_plain(100.0 * share, 3 if abs(share) >= 1.0 else 2)} %"


def joined(parts: Sequence[str], last: str = "and") -> str:
    """Join parts as a sentence does: ``A``, ``A and B``, ``A, B and C``."""
    if len(parts) < 2:
        return "".join(parts)
    return f"{', '.join(parts[:-1])} {last} {parts[-1]}"


def small_text(value: float | None, unit: str, sd: float | None = None, digits: int = 4) -> str:
    """Write a length in m or a time in s with the prefix that reads best: ``50.0 ± 0.1 mm``.

    Any other unit is written as :func:`quantity_text` does, an angle also in degrees.
    """
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if unit == "rad":
        return f"{quantity_text(value, unit, sd, digits)} ({degrees_text(value, sd, digits)})"
    if unit not in _PLAIN_FROM or value == 0.0 or abs(value) >= _PLAIN_FROM[unit]:
        return quantity_text(value, unit, sd, digits)
    factor, prefix = (1e-3, "m") if abs(value) >= 1e-4 else (1e-6, "µ")
    return quantity_text(value / factor, prefix + unit, _scaled(sd, factor), digits)


def degrees_text(value: float, sd: float | None = None, digits: int = 4) -> str:
    """Write an angle in rad in degrees: ``15.00 ± 0.02°``."""
    return f"{number_text(math.degrees(value), _scaled(sd, math.pi / 180.0), digits)}°"


def _scaled(sd: float | None, factor: float) -> float | None:
    return None if sd is None else sd / factor


def _shift(size: float) -> int:
    """The power of ten to take out of numbers of this size, 0 where they read well as they are."""
    return 0 if size == 0.0 or 1e-3 <= size < 1e6 else math.floor(math.log10(size))


def _plain(value: float, digits: int) -> str:
    shift = _shift(abs(value))
    rounded = float(f"{value / 10.0**shift:.{digits - 1}e}")
    places = max(0, digits - 1 - (math.floor(math.log10(abs(rounded))) if rounded else 0))
    text = _fixed(rounded, places)
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{text}·{power_text(shift)}" if shift else text


def _fixed(value: float, places: int) -> str:
    text = f"{round(value, places):.{max(places, 0)}f}"
    return text.replace("-", _MINUS) if text.strip("-0.") else text.lstrip("-")


def _superscript(exponent: int) -> str:
    return str(exponent).translate(_SUPERSCRIPTS)


def capital(words: str) -> str:
    """Words as a sentence begins."""
    return words[:1].upper() + words[1:]
