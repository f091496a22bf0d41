"""Steps of what takes long, as they are said: a line, and how many of its equal pieces are done."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

Say = Callable[[str], None]
Item = TypeVar("Item")


class Counted(str):
    """A step of ``total`` equal pieces, of which ``done`` are done. Whoever gets it may take it for
    the line that it is, or say how much time is left."""

    __slots__ = ("done", "total")
    done: int
    total: int

    def __new__(cls, step: str, done: int, total: int) -> "Counted":
        self = super().__new__(cls, step)
        self.done, self.total = done, total
        return self


def counted(say: Say, step: str, items: Sequence[Item]) -> Iterator[Item]:
    """The items one after the other, each said as a piece of one step."""
    for done, item in enumerate(items):
        say(Counted(step, done, len(items)))
        yield item


def silent(step: str) -> None:
    """Say nothing."""
