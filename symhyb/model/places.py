"""Where an element acts: on a coordinate or an expression of coordinates, between two points, at a
point, on a pair of stretches."""

from dataclasses import dataclass
from functools import lru_cache

from symhyb.model.expression import Expression, names, parse_expression


@dataclass(frozen=True, slots=True)
class On:
    """Placement on a coordinate, s = q, or on an expression of coordinates: On("q1 - q2")."""

    coordinate: str

    @property
    def plain(self) -> bool:
        """Whether the stretch is one coordinate itself."""
        return self.coordinate.isidentifier()

    @property
    def expression(self) -> Expression:
        """The stretch s.

        Raises:
            ExpressionError: a text that is no expression (a model that was read has none).
        """
        return _parsed(self.coordinate)

    @property
    def names(self) -> frozenset[str]:
        """The names in the stretch, those of coordinates, parameters and t."""
        return frozenset(name.name for name in names(self.expression))


@dataclass(frozen=True, slots=True)
class Between:
    """Placement between two points: the stretch is ``s = |b − a| − length``, a tension pulls."""

    first: str
    second: str


@dataclass(frozen=True, slots=True)
class At:
    """Placement at a point: a force vector acts there."""

    point: str


@dataclass(frozen=True, slots=True)
class Pair:
    """Placement on two stretches a and b that act on each other, each a coordinate or an
    expression of coordinates as in :class:`On`."""

    first: str
    second: str

    @property
    def each(self) -> tuple[On, On]:
        """The two stretches as places."""
        return On(self.first), On(self.second)


Place = On | Between | At | Pair


@lru_cache(maxsize=1024)
def _parsed(text: str) -> Expression:
    return parse_expression(text)


def place_text(place: Place) -> str:
    """Say a place as the model file does: ``on x − y``, ``between anchor and tip``, ``at tip``."""
    match place:
        case On(coordinate):
            return f"on {coordinate}".replace("-", "−")
        case Between(first, second):
            return f"between {first} and {second}"
        case At(point):
            return f"at {point}"
        case Pair(first, second):
            return f"on {first} and {second}".replace("-", "−")
