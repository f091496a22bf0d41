"""How far and how fast a machine may be driven: limits of coordinates and inputs, read and checked.

Advice on what to record next stays within them; the physics knows nothing of them.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from symhyb.errors import did_you_mean
from symhyb.model.tables import Fault, Table
from symhyb.units import Unit

COORDINATE_KEYS = ("travel", "speed", "acceleration")
INPUT_KEYS = ("range", "rate")
PAIR = "two numbers, as in [-0.05, 0.05]"


@dataclass(frozen=True, slots=True)
class Limit:
    """Limits of the coordinate or input ``name``, each None where the file states none.

    ``between`` are the least and the largest value in ``unit`` (``travel`` of a coordinate,
    ``range`` of an input), ``rate`` is the largest rate in it per s in either direction
    (``speed``, ``rate``), and ``acceleration`` of a coordinate the largest in it per s².
    """

    name: str
    unit: Unit
    between: tuple[float, float] | None = None
    rate: float | None = None
    acceleration: float | None = None
    about: str = ""

    def entries(self, coordinate: bool) -> Iterator[tuple[str, tuple[float, float] | float]]:
        """The limits that are stated, as key and value in ``unit``, of a coordinate or an input."""
        span, rate = ("travel", "speed") if coordinate else INPUT_KEYS
        pairs = ((span, self.between), (rate, self.rate), ("acceleration", self.acceleration))
        yield from ((key, value) for key, value in pairs if value is not None)


def read_limit(table: Table, root: Table) -> Limit | None:
    """Read the limits of one channel, None if they cannot be known; ``root`` is the whole file."""
    name = table.path[-1]
    known = {"coordinates": COORDINATE_KEYS, "inputs": INPUT_KEYS}
    section = next((key for key in known if name in root.declared(key)), None)
    if section is None:
        names = [*root.declared("coordinates"), *root.declared("inputs")]
        table.fault(f"'{name}' is neither a coordinate nor an input{did_you_mean(name, names)}")
        return None
    keys = known[section]
    table = table.checked(("unit", *keys, "about"))
    if all(table.lacks(key) for key in keys):
        table.fault(f"states no limit; give {', '.join(keys[:-1])} or {keys[-1]}")
    unit, about = table.unit(), table.about()
    between = _range(table, keys[0])
    rate, acceleration = (_size(table, key) for key in (keys[1], "acceleration"))
    return None if unit is None else Limit(name, unit, between, rate, acceleration, about)


def _range(table: Table, key: str) -> tuple[float, float] | None:
    """The least and the largest value, which must not be the same."""
    if key not in table.entries:
        return None
    pair = table.numbers(table.entries[key], key, 2, PAIR)
    if pair is None:
        return None
    low, high = pair
    if low >= high:
        table.fault(f"is from {low:g} to {high:g}; the first number must be the smaller", key)
        return None
    return low, high


def _size(table: Table, key: str) -> float | None:
    """A largest size, which is positive."""
    value = table.number(key)
    if value is not None and value <= 0:
        table.fault(f"must be positive, not {value:g}: it limits both directions", key)
        return None
    return value


def limit_faults(limit: Limit, units: dict[str, Unit]) -> Iterator[Fault]:
    """What is wrong with limits beside channels that have these ``units``."""
    own = units.get(limit.name)
    if own is not None and not limit.unit.same_dimension(own):
        yield ("limits", limit.name, "unit"), f"is {limit.unit}, but {limit.name} is in {own}"
