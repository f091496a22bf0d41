"""Tables of a parsed TOML file, read one typed entry at a time, with every fault noted.

A getter returns None where the entry is missing or wrong, and the fault goes to the list that all
tables of one reading share; so the reader goes on and finds the next mistake.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches

from symhyb.errors import did_you_mean, is_text, visible
from symhyb.model.expression import Expression, ExpressionError, parse_expression
from symhyb.model.source import Path
from symhyb.units import Unit, UnitError, parse_unit

Fault = tuple[Path, str]
"""Where something is wrong, as the parts of a dotted name, and what."""

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


@dataclass(frozen=True, slots=True)
class Table:
    """One table at ``path``. ``faults`` is the list of the whole reading; ``excused`` maps
    a missing key to the misspelt one that stands for it; it is not reported a second time."""

    path: Path
    entries: Mapping[str, object]
    faults: list[Fault]
    excused: Mapping[str, str] = field(default_factory=dict)

    def fault(self, text: str, *keys: str) -> None:
        """Note that something is wrong here, or at a key of this table."""
        self.faults.append(((*self.path, *keys), text))

    def checked(self, keys: Sequence[str]) -> "Table":
        """Report every entry that is not in ``keys``, with the nearest that is."""
        excused: dict[str, str] = {}
        for name in self.entries:
            if name in keys:
                continue
            missing = [key for key in keys if key not in self.entries]
            near = get_close_matches(name, missing, n=1, cutoff=0.6)
            excused.update(dict.fromkeys(near, name))
            cure = f"; did you mean '{near[0]}'?" if near else did_you_mean(name, keys)
            self.fault(f"'{shorten(name)}' is not a key here{cure}", name)
        return Table(self.path, self.entries, self.faults, excused)

    def lacks(self, key: str) -> bool:
        """Say whether a key is absent, without a misspelt one in its stead."""
        return key not in self.entries and key not in self.excused

    def declared(self, key: str) -> list[str]:
        """Return the names in the table under a key, or under the misspelt form of the key."""
        value = self.entries.get(key, self.entries.get(self.excused.get(key, "")))
        return list(value) if isinstance(value, dict) else []

    def text(self, key: str, required: bool = False) -> str | None:
        """Return a string."""
        value = self._get(key, required)
        if value is None:
            return None
        if not isinstance(value, str):
            self.fault(f"must be text in quotes, not {describe(value)}", key)
            return None
        strange = next((letter for letter in value if not is_text(letter)), None)
        if strange is not None:
            self.fault(f"holds {visible(strange)}, which is no letter of a text; leave it out", key)
        return value

    def about(self) -> str:
        """Return the explanation, empty if there is none."""
        return self.text("about") or ""

    def number(self, key: str, required: bool = False) -> float | None:
        """Return a finite number."""
        value = self._get(key, required)
        return None if value is None else self.as_number(value, key)

    def as_number(self, value: object, key: str) -> float | None:
        """Read a value of this table as a finite number."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            self.fault(f"must be a number, not {describe(value)}", key)
            return None
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            self.fault(f"must be finite, not {describe(value)}", key)
            return None
        return number

    def numbers(self, value: object, key: str, size: int, shape: str) -> list[float] | None:
        """Read a value of this table as a list of ``size`` numbers; ``shape`` is its picture."""
        if not isinstance(value, list) or len(value) != size:
            self.fault(f"must be {shape}, not {describe(value)}", key)
            return None
        found = [self.as_number(item, key) for item in value]
        return None if None in found else [item for item in found if item is not None]

    def truth(self, key: str) -> bool:
        """Return true or false; false if the entry is missing or wrong."""
        value = self.entries.get(key, False)
        if isinstance(value, bool):
            return value
        self.fault(f"must be true or false, not {describe(value)}", key)
        return False

    def deviation(self) -> float | None:
        """Return ``sd``, one standard deviation, which is positive."""
        value = self.number("sd")
        if value is not None and value <= 0:
            self.fault(f"must be positive, not {value:g}; without sd the value is held", "sd")
            return None
        return value

    def unit(self, required: bool = True) -> Unit | None:
        """Return the unit under ``unit``."""
        if required and self.lacks("unit"):
            self.fault("'unit' is missing; a plain number has the unit \"1\"")
            return None
        text = self.text("unit")
        if text is None:
            return None
        try:
            return parse_unit(text)
        except UnitError as error:
            self.fault(str(error), "unit")
            return None

    def expression(self, key: str, required: bool = False) -> Expression | None:
        """Return an expression: text in quotes, or a number."""
        return self.as_expression(self._get(key, required), key)

    def as_expression(self, value: object, key: str) -> Expression | None:
        """Read a value of this table as an expression."""
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, (str, int, float)):
            self.fault(f"must be an expression in quotes, not {describe(value)}", key)
            return None
        try:
            return parse_expression(value)
        except ExpressionError as error:
            self.fault(str(error), key)
            return None

    def vector(self, key: str) -> tuple[Expression, ...] | None:
        """Return the components of a vector: two expressions in the plane, three in space."""
        value = self.entries.get(key)
        if not isinstance(value, list) or len(value) not in (2, 3):
            text = "must be a list of two expressions, not"
            self.fault(f"{text} {describe(value)}; in space of three", key)
            return None
        return self.expressions(value, key)

    def expressions(self, values: Sequence[object], key: str) -> tuple[Expression, ...] | None:
        """Read the items of a list as expressions, None if one of them is none."""
        found = [self.as_expression(part, key) for part in values]
        return None if None in found else tuple(item for item in found if item is not None)

    def table(self, key: str) -> "Table | None":
        """Return the table under a key, None if there is none."""
        value = self.entries.get(key)
        if value is None:
            return None
        if isinstance(value, dict):
            return Table((*self.path, key), value, self.faults)
        self.fault(f"must be a table, not {describe(value)}", key)
        return None

    def tables(self, key: str) -> Iterator["Table"]:
        """Yield the named tables inside the table under a key (``coordinates.x``, …)."""
        for around, name in self.pairs(key):
            inner = around.table(name)
            if inner is not None:
                yield inner

    def pairs(self, key: str) -> Iterator[tuple["Table", str]]:
        """Yield the table under a key with each usable name in it."""
        around = self.table(key)
        for name in around.entries if around is not None else ():
            if around is not None and around.named(name):
                yield around, name

    def named(self, name: str) -> bool:
        """Say whether a name that the user chose can be used in expressions and paths."""
        if len(name) <= 60 and _NAME.fullmatch(name):
            return True
        self.fault(f"'{shorten(name)}' is not a name: letters, digits, _; no digit first", name)
        return False

    def _get(self, key: str, required: bool) -> object:
        if required and self.lacks(key):
            self.fault(f"'{key}' is missing")
        return self.entries.get(key)


def describe(value: object) -> str:
    """Quote a value of the file with its type, for sentences."""
    if isinstance(value, bool):
        return f"the truth value {str(value).lower()}"
    if isinstance(value, str):
        return f"the text '{shorten(value)}'"
    if isinstance(value, (int, float)):
        return f"the number {value:g}" if abs(value) < 1e300 or value != value else f"{value}"[:40]
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return "a table" if isinstance(value, dict) else "nothing" if value is None else "a date"


def shorten(text: str) -> str:
    """Cut a text for a sentence."""
    return text if len(text) <= 40 else text[:37] + "…"
