"""Bags of any length, piece by piece: the messages of all topics between two times.

Messages stand in a bag in the order in which they were logged, and a stamp says that one was
measured earlier. So a piece ends some seconds before the last message that was read.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from symhyb.data.files.bag_file import (
    Topic,
    called,
    damaged,
    files_of_bag,
    magic_of,
    opened,
    require_rosbags,
    table_of,
    taken,
)
from symhyb.data.files.bag_growing import OVERLAP_NS
from symhyb.data.files.stamps import CLOCKS, NS
from symhyb.data.files.table import Column, Table
from symhyb.errors import InputError, Problem

MAGIC_BYTES = 16


def bag_pieces(path: str, file: str, rows: int) -> Iterator[Table]:
    """The numbers (N,) in the messages of all topics, about so many ``rows`` of the fastest topic
    at a time; times count from the first message of the bag, in s.

    Raises:
        InputError: as :func:`.read_bag`.
    """
    parts = files_of_bag(Path(path)) if Path(path).is_dir() else (Path(path),)
    with parts[0].open("rb") as stream:
        magic = magic_of(stream.read(MAGIC_BYTES), file)
    require_rosbags(file)
    kept = _Kept(file)
    try:
        for part in parts:
            yield from kept.read(part, rows)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # damaged bytes make rosbags raise errors of many kinds
        raise damaged(error, magic, file) from error
    yield kept.piece(np.inf)


@dataclass(slots=True)
class _Kept:
    """The messages that are in no piece yet, the ``clocks`` of the topics that are not their time,
    the time of the first message (``zero``, ns), and how many rows the pieces had."""

    file: str
    topics: dict[str, Topic] = field(default_factory=dict)
    notes: dict[str, None] = field(default_factory=dict)
    clocks: dict[str, str] = field(default_factory=dict)
    zero: int | None = None
    rows: int = 0

    def read(self, part: Path, rows: int) -> Iterator[Table]:
        """The pieces that end in a file."""
        with opened(part) as reader:
            wanted = rows + self._most()
            for logged, topic in taken(reader, part, self.topics, self.notes, self.file):
                if self.zero is None and topic.numbers:
                    self.zero = logged
                if self.zero is not None and len(topic.logged) >= wanted:
                    piece = self.piece((logged - OVERLAP_NS - self.zero) / NS)
                    if any(column.values.size for column in piece.columns):
                        yield piece
                    wanted = rows + self._most()

    def piece(self, until: float) -> Table:
        """The messages before a time in s, which are dropped here."""
        table = table_of(self.topics, tuple(self.notes), self.file, self.zero, in_part_only=True)
        times = {c.part: c.values for c in table.columns if c.inside == f"{CLOCKS[0]} [s]"}
        counts = {part: int(np.searchsorted(t, until)) for part, t in times.items()}
        cut = tuple(replace(c, values=c.values[: counts[c.part]]) for c in table.columns)
        for name, topic in self.topics.items():
            topic.leave(counts.get(called(name), 0))
        first, self.rows = self.rows, self.rows + max(counts.values())
        return Table(self.file, self._with_one_clock(cut), table.notes, first=first)

    def _most(self) -> int:
        return max((len(topic.logged) for topic in self.topics.values()), default=0)

    def _with_one_clock(self, columns: tuple[Column, ...]) -> tuple[Column, ...]:
        """Columns, with a problem where the time of their topic is another clock than before."""
        named = ((c.part, c.inside.partition(" ")[0]) for c in columns)
        others = {part: name for part, name in named if name in CLOCKS[1:]}
        changed = {
            part for part, name in others.items() if self.clocks.setdefault(part, name) != name
        }
        return tuple(
            replace(c, problem=_two_clocks(c, self.file)) if c.part in changed else c
            for c in columns
        )


def _two_clocks(column: Column, file: str) -> Problem:
    text = (
        "belongs to a topic whose stamps can be used in one piece and not in another, so that its "
        "time is no one clock; take a span of the recording"
    )
    return Problem(text, f"channel '{column.header}'", file)
