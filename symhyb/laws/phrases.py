"""How a law words an effect: the parts of a sentence, and the numbers it is made of."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Phrase:
    """An effect as the parts of a sentence: ``head`` [does something] ``tail``; ``terms`` are the
    keys whose numbers these words hold, ``resists`` what a resisting effect acts against,
    ``plural`` whether the head names several things."""

    head: str
    tail: str = ""
    terms: tuple[str, ...] = ()
    resists: str = ""
    plural: bool = False


class Numbers(Protocol):
    """The estimates of one effect by key, in the units of the model file, and how they are printed.

    A quantity that follows from two of them (a yield travel, a time constant) is printed without a
    deviation, for the two are correlated.
    """

    @property
    def turns(self) -> bool:
        """Whether the numbers belong to an angle."""

    def __contains__(self, term: str) -> bool: ...

    def value(self, term: str, default: float = 0.0) -> float:
        """The value under a key, ``default`` where it was not fitted."""

    def sd(self, term: str) -> float:
        """One standard deviation of the value under a key."""

    def unit(self, term: str) -> str:
        """The unit of the value under a key."""

    def symbol(self, term: str) -> str:
        """The letter of a key in the model file."""

    def amount(self, term: str) -> str:
        """The number under a key with deviation and unit."""

    def small(self, term: str) -> str:
        """The same of a length, an angle or a time, in the prefix that reads best."""

    def derived(self, value: float, unit: str) -> str:
        """A quantity that follows from several numbers."""

    def derived_small(self, value: float, unit: str) -> str:
        """The same of a length, an angle or a time, in the prefix that reads best."""

    def ratio(self, above: str, below: str) -> str:
        """The ratio of two numbers, such as a travel or a time, in the prefix that reads best."""

    def counted(self, value: float, sd: float) -> str:
        """A number that has no unit, with its deviation."""

    def degrees(self, term: str) -> str:
        """An angle in degrees with its deviation."""

    def place(self, term: str) -> tuple[float, str]:
        """Where the value of a curve under a key holds, and the unit of that."""

    def listed(self, parts: Sequence[str]) -> str:
        """Parts as a sentence joins them: ``A, B and C``."""
