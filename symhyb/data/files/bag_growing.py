"""A bag of ROS 2 that is still being written: MCAP, whose records stand one behind the other.

What was written so far becomes a bag of its own: the head of the file, the definitions of its
topics, its last complete records, and an end. So the reader of whole bags reads it. Each piece
reaches back by some seconds, so that channels of different rates have neighbours at its ends.

Source: the MCAP format, version 0 (records, chunks, summary), mcap.dev/spec.
"""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from struct import Struct
from tempfile import TemporaryDirectory
from typing import Any

from symhyb.data.files.bag_file import (
    MCAP,
    Topic,
    natural,
    opened,
    read_into,
    require_rosbags,
    table_of,
)
from symhyb.data.files.extras import first_line
from symhyb.data.files.table import Table, refusal
from symhyb.errors import InputError
from symhyb.limits import RECORDING_BYTES

WAIT_S = 0.2  # until it is looked again for what was written
OVERLAP_NS = 5_000_000_000  # by which a piece reaches back
READ = 1 << 22  # bytes that are read at once
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 1, 2, 3, 4, 5, 6, 15
END = b"\x0f" + (4).to_bytes(8, "little") + bytes(4)  # of the data, then the footer
END += b"\x02" + (20).to_bytes(8, "little") + bytes(20) + MCAP
_HEAD = Struct("<BQ")


def growing_bag(path: str, file: str, rows: int) -> Iterator[Table]:
    """The pieces of a bag at a ``path`` as it grows, until it is complete; a table without columns
    where for a moment nothing was written. ``rows`` is not asked for.

    Raises:
        InputError: rosbags is not installed, or the file is no MCAP of ROS 2, or damaged.
    """
    yield from _pieces(Path(path), file, follow=True)


def bag_so_far(path: str, file: str, rows: int) -> Iterator[Table]:
    """The pieces of a bag as far as it was written; as :func:`growing_bag`."""
    yield from _pieces(Path(path), file, follow=False)


def _pieces(path: Path, file: str, *, follow: bool) -> Iterator[Table]:
    require_rosbags(file)
    made = _Made(file)
    for written in _written(path, file, follow=follow):
        if written is None:
            yield Table(file, ())
        elif (table := made.with_more(written)) is not None:
            yield table


def _written(path: Path, file: str, *, follow: bool) -> Iterator["_Records | None"]:
    """The records of the files of a bag, as they are written; None where there is none."""
    number, records = 0, None
    while True:
        files = mcap_files(path)
        if records is None and number < len(files):
            records = _Records(files[number], file)
        if records is not None and records.read():
            yield records
            continue
        later = records is None or number + 1 < len(files)
        if records is not None and (records.ended or later):
            number, records = number + 1, None
            if number < len(files):
                continue
        complete = number >= len(files) and (path.is_file() or (path / "metadata.yaml").is_file())
        if complete or not follow:
            return
        yield None
        time.sleep(WAIT_S)


def mcap_files(path: Path) -> list[Path]:
    """The files of a bag in MCAP in their order: the file itself, or those in a folder."""
    if path.is_file():
        return [path]
    return sorted(path.glob("*.mcap"), key=natural) if path.is_dir() else []


@dataclass(slots=True)
class _Records:
    """One file that grows: its ``head``, and the complete records since the last look."""

    path: Path
    file: str
    head: bytes = b""
    position: int = 0
    ended: bool = False
    fresh: list[tuple[int, bytes]] = field(default_factory=list)

    def read(self) -> bool:
        """Whether there is something new; it stands in ``fresh``, with its last time in ns."""
        self.fresh = []
        try:
            with self.path.open("rb") as stream:
                if stream.seek(0, 2) < self.position:
                    raise refusal(self.file, "has become shorter; begin the watch anew")
                stream.seek(self.position)
                content = stream.read(READ)
                if len(content) == READ:
                    content += stream.read(self._missing(content))
        except OSError as error:
            raise refusal(self.file, error.strerror or "cannot be read") from error
        at = 0
        if self.position == 0:
            if len(content) < len(MCAP):
                return False
            if not content.startswith(MCAP):
                raise refusal(self.file, "is not a bag in MCAP, although its name says so")
            at = len(MCAP)
        while not self.ended and at + _HEAD.size <= len(content):
            code, size = _HEAD.unpack_from(content, at)
            if size > RECORDING_BYTES:
                raise refusal(self.file, f"is damaged: a record of {size} bytes")
            if at + _HEAD.size + size > len(content):
                break
            self._take(code, content[at : at + _HEAD.size + size])
            at += _HEAD.size + size
        self.position += at
        return bool(self.fresh)

    def _missing(self, content: bytes) -> int:
        """What is left of a record that is longer than what was read."""
        at = len(MCAP) if self.position == 0 else 0
        while at + _HEAD.size <= len(content):
            _, size = _HEAD.unpack_from(content, at)
            at += _HEAD.size + min(size, RECORDING_BYTES)
        return max(at - len(content), 0)

    def _take(self, code: int, record: bytes) -> None:
        body = record[_HEAD.size :]
        if code == HEADER:
            self.head = MCAP + record
        elif code in (FOOTER, DATA_END):
            self.ended = True
        elif code in (SCHEMA, CHANNEL):
            self.fresh.append((-1, record))
        elif code == MESSAGE and len(body) >= 14:
            self.fresh.append((int.from_bytes(body[6:14], "little"), record))
        elif code == CHUNK and len(body) >= 16:
            self.fresh.append((int.from_bytes(body[8:16], "little"), record))


@dataclass(slots=True)
class _Made:
    """Pieces of a bag: the definitions of ``known`` topics, the records that are ``kept``, both of
    the file at ``path``, and the time from which the bag counts (``zero``, ns)."""

    file: str
    path: Path | None = None
    known: dict[int, bytes] = field(default_factory=dict)
    kept: list[tuple[int, bytes]] = field(default_factory=list)
    zero: int | None = None

    def with_more(self, written: _Records) -> Table | None:
        """A table of the last seconds; None as long as no message has a number."""
        if self.path != written.path:  # the next one of several files, with numbers of its own
            self.path, self.known, self.kept = written.path, {}, []
        first = min((end for end, _ in written.fresh if end >= 0), default=0)
        reached = [one for one in self.kept if one[0] >= first - OVERLAP_NS]
        self.kept = [*reached, *written.fresh]
        content = b"".join([written.head, *self.known.values(), *(r for _, r in self.kept), END])
        topics: dict[str, Topic] = {}
        notes: dict[str, None] = {}
        try:
            with ExitStack() as stack, TemporaryDirectory() as place:
                part = Path(place) / "0.mcap"
                part.write_bytes(content)
                reader = stack.enter_context(opened(part))
                read_into(reader, part, topics, notes, self.file)
                self._define(reader.connections)
        except (InputError, MemoryError):
            raise
        except Exception as error:  # damaged bytes make rosbags raise errors of many kinds
            why = (first_line(error) or type(error).__name__)[:200]
            text = f"cannot be followed: {why}; watch it when it is complete"
            raise refusal(self.file, text) from error
        self.kept = [one for one in self.kept if one[0] >= 0]  # definitions are known now
        if not any(topic.numbers for topic in topics.values()):
            return None
        firsts = [min(topic.logged) for topic in topics.values() if topic.numbers]
        self.zero = min(firsts) if self.zero is None else self.zero
        return table_of(topics, tuple(notes), self.file, self.zero)

    def _define(self, connections: Any) -> None:
        """Keep what topics are called and made of, for pieces in which that does not stand."""
        from rosbags.interfaces import MessageDefinitionFormat as Format

        words = {Format.MSG: "ros2msg", Format.IDL: "ros2idl"}
        for one in connections:
            if one.id in self.known:
                continue
            schema = _u16(one.id + 1) + _text(one.msgtype)
            schema += _text(words.get(one.msgdef.format, "")) + _text(one.msgdef.data)
            channel = _u16(one.id) + _u16(one.id + 1) + _text(one.topic)
            channel += _text(str(one.ext.serialization_format)) + _u32(0)
            self.known[one.id] = _record(SCHEMA, schema) + _record(CHANNEL, channel)


def _record(code: int, body: bytes) -> bytes:
    return _HEAD.pack(code, len(body)) + body


def _text(text: str) -> bytes:
    content = text.encode()
    return _u32(len(content)) + content


def _u16(number: int) -> bytes:
    return (number % 65536).to_bytes(2, "little")


def _u32(number: int) -> bytes:
    return number.to_bytes(4, "little")
