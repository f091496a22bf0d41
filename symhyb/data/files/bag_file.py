"""Bags of ROS 1 (.bag) and ROS 2 (.mcap, .db3, and the folders they stand in), by rosbags.

A topic is a part of the file with times of its own; ``/arm/joint_states`` is called
``arm.joint_states``. Its channels are the numbers in its messages
(:mod:`symhyb.data.files.ros_message`), its times are chosen by :mod:`symhyb.data.files.stamps`, and
counted from the first message of the file.
"""

import io
import re
import zipfile
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.extras import first_line, needed
from symhyb.data.files.ros_message import WIDEST, Message, UnreadableError, decoder
from symhyb.data.files.stamps import CLOCKS, Times, time_notes, times_of
from symhyb.data.files.table import Column, Table, in_part, refusal
from symhyb.errors import InputError, Problem
from symhyb.limits import COLUMNS, RECORDING_BYTES

BAG, MCAP, DB3, FOLDER = b"#ROSBAG V", b"\x89MCAP0\r\n", b"SQLite format 3\0", b"PK\x03\x04"
STORED = (".mcap", ".db3")
RECOVER = {
    BAG: "; 'rosbag reindex' may recover it",
    MCAP: "; 'mcap recover' may recover it",
    DB3: "; 'ros2 bag reindex' may recover it",
}
ZSTD = b"\x28\xb5\x2f\xfd"
MOST_NOTES = 12


def files_of_bag(folder: Path) -> tuple[Path, ...]:
    """The files of a bag of ROS 2 in a folder, in their order; none if it is no such folder.

    Raises:
        InputError: they are packed.
    """
    if not (folder / "metadata.yaml").is_file():
        return ()
    inside = sorted((one for one in folder.iterdir() if one.is_file()), key=natural)
    packed = [one.name for one in inside if Path(one.stem).suffix.lower() in STORED]
    if packed:
        raise refusal(str(folder), f"its files are packed; unpack them: zstd -d {packed[0]}")
    return tuple(one for one in inside if one.suffix.lower() in STORED)


def folder_of_bag(folder: Path) -> bytes | None:
    """The files of a bag of ROS 2 in a folder, one behind the other in an archive that does not
    pack; None if it is no such folder.

    Raises:
        InputError: they are packed, or larger than a recording may be.
    """
    files = files_of_bag(folder)
    if not files:
        return None
    if sum(one.stat().st_size for one in files) > RECORDING_BYTES:
        raise refusal(str(folder), f"is larger than {RECORDING_BYTES >> 30} GiB")
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        for number, one in enumerate(files):
            archive.writestr(zipfile.ZipInfo(f"{number}{one.suffix.lower()}"), one.read_bytes())
    return stream.getvalue()


def natural(path: Path) -> list[int | str]:
    """By which files are sorted: a name with its numbers as numbers: part_2 before part_10."""
    return [int(one) if one.isdecimal() else one for one in re.split(r"(\d+)", path.name)]


def read_bag(content: bytes, file: str) -> Table:
    """Read the numbers (N,) in the messages of all topics; a topic of one message has numbers ().

    Raises:
        InputError: rosbags is not installed, the file is another format, damaged, cut off, packed
            in a way that is not read, or holds no number.
    """
    magic = magic_of(content, file)
    require_rosbags(file)
    topics: dict[str, Topic] = {}
    notes: dict[str, None] = {}
    try:
        with ExitStack() as stack, TemporaryDirectory() as place:
            for part in _written(content, magic, Path(place)):
                read_into(stack.enter_context(opened(part)), part, topics, notes, file)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # damaged bytes make rosbags raise errors of many kinds
        raise damaged(error, magic, file) from error
    return table_of(topics, tuple(notes), file)


def magic_of(content: bytes, file: str) -> bytes:
    """With what the content of a bag begins.

    Raises:
        InputError: it is no bag.
    """
    magic = next((one for one in (BAG, MCAP, DB3, FOLDER) if content.startswith(one)), None)
    if magic is None:
        raise refusal(file, "is not a bag of ROS, although its name says so")
    return magic


def damaged(error: Exception, magic: bytes, file: str) -> InputError:
    """What is said of an error that rosbags raises."""
    why = (first_line(error) or type(error).__name__)[:200]
    return refusal(file, f"is a damaged or cut off bag: {why}{RECOVER.get(magic, '')}")


def require_rosbags(file: str) -> None:
    """Refuse a bag where rosbags is not installed.

    Raises:
        InputError: how to install it.
    """
    for module in ("rosbags", "rosbags.rosbag1", "rosbags.rosbag2", "rosbags.typesys"):
        needed(module, "rosbag", file)


def _written(content: bytes, magic: bytes, place: Path) -> Iterator[Path]:
    """The files of a bag, written where rosbags can open them."""
    suffix = {BAG: ".bag", MCAP: ".mcap", DB3: ".db3"}
    if magic != FOLDER:
        path = place / f"0{suffix[magic]}"
        path.write_bytes(content)
        yield path
        return
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        for number, one in enumerate(archive.infolist()):
            if one.compress_type != zipfile.ZIP_STORED:
                raise ValueError("an archive is not read")
            path = place / f"{number}{Path(one.filename).suffix}"
            path.write_bytes(archive.read(one))
            yield path


def opened(path: Path) -> Any:
    """The reader of rosbags for a file."""
    from rosbags import rosbag1, rosbag2

    return rosbag1.Reader(path) if path.suffix == ".bag" else rosbag2.Reader(path)


@dataclass(slots=True)
class Topic:
    """What was read of a topic: when its messages were ``logged`` and their ``stamps`` in ns,
    ``missing`` counts those without one; the ``numbers`` by name; the names that are too wide."""

    msgtype: str
    logged: "array[int]" = field(default_factory=lambda: array("q"))
    stamps: "array[int]" = field(default_factory=lambda: array("q"))
    numbers: "dict[str, array[float]]" = field(default_factory=dict)
    wide: set[str] = field(default_factory=set)
    unstamped: int = 0

    def take(self, time: int, message: Message) -> None:
        """Append a message; what it lacks is NaN there."""
        rows = len(self.logged)
        for name, value in message.numbers.items():
            column = self.numbers.get(name)
            if column is None:
                column = self.numbers[name] = array("d")
            if len(column) < rows:
                column.extend([np.nan] * (rows - len(column)))
            column.append(value)
        self.logged.append(time)
        self.stamps.append(message.stamp or 0)
        self.unstamped += message.stamp is None
        self.wide |= message.wide

    def leave(self, count: int) -> None:
        """Drop the first messages, which are in a piece already."""
        del self.logged[:count], self.stamps[:count]
        for column in self.numbers.values():
            del column[:count]
        self.unstamped = min(self.unstamped, len(self.logged))


def read_into(
    reader: Any, path: Path, topics: dict[str, Topic], notes: dict[str, None], file: str
) -> None:
    """Take all messages of one file."""
    for _ in taken(reader, path, topics, notes, file):
        pass


def taken(
    reader: Any, path: Path, topics: dict[str, Topic], notes: dict[str, None], file: str
) -> Iterator[tuple[int, Topic]]:
    """Take the messages of one file one after the other; when each was logged, ns, and its topic.

    Raises:
        InputError: they are packed one by one, or of too many channels.
    """
    ros2 = path.suffix != ".bag"
    types, said = _types(reader.connections, ros2)
    notes |= dict.fromkeys(said)
    decoders: dict[tuple[str, str], Callable[[bytes], Message]] = {}
    left: set[str] = set()
    for connection, time, data in reader.messages():
        name, msgtype = connection.topic, connection.msgtype
        if name in left:
            continue
        topic = topics.setdefault(name, Topic(msgtype))
        encoded = str(getattr(connection.ext, "serialization_format", "ros1"))
        try:
            if topic.msgtype != msgtype:
                raise UnreadableError(f"has messages of the types {topic.msgtype} and {msgtype}")
            if encoded not in ("cdr", "ros1"):
                raise UnreadableError(f"its messages are encoded as '{encoded}', which is not read")
            if data[:4] == ZSTD and ros2:
                text = "has messages that are packed one by one; unpack the bag: ros2 bag convert"
                raise refusal(file, f"topic {name} {text}")
            if (msgtype, encoded) not in decoders:
                decoders[msgtype, encoded] = decoder(msgtype, types, encoded == "cdr")
            topic.take(time, decoders[msgtype, encoded](bytes(data)))
            yield time, topic
        except UnreadableError as error:
            left.add(name)
            notes[f"topic {called(name)}: {error}: left out"] = None
            topics[name] = Topic(msgtype)
        if sum(len(one.numbers) for one in topics.values()) > COLUMNS:
            raise refusal(file, f"has more than {COLUMNS} channels")


def _types(connections: Sequence[Any], ros2: bool) -> tuple[Mapping[str, Any], list[str]]:
    """The definitions in a file, parsed; those of ROS 2 Humble where it has none, and a note."""
    from rosbags.interfaces import MessageDefinitionFormat
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    types: dict[str, Any] = {}
    for one in connections:
        text, form = one.msgdef.data, one.msgdef.format
        if form == MessageDefinitionFormat.MSG:
            types |= get_types_from_msg(text, one.msgtype)
        elif form == MessageDefinitionFormat.IDL:
            for part in re.split(r"^={80}\nIDL: .*\n", text, flags=re.M):
                types |= get_types_from_idl(part) if part.strip() else {}
    if types or not ros2 or not connections:
        return types, []
    said = "the file defines no types of messages: those of ROS 2 Humble are taken"
    return get_typestore(Stores.ROS2_HUMBLE).fielddefs, [said]


def table_of(
    topics: Mapping[str, Topic],
    notes: Sequence[str],
    file: str,
    zero: int | None = None,
    *,
    in_part_only: bool = False,
) -> Table:
    """The numbers of topics as columns; times count from ``zero`` in ns, by default from the first
    message. The only message of a topic is a number, but for a topic that is there
    ``in_part_only``.

    Raises:
        InputError: no message has a number.
    """
    filled = {name: topic for name, topic in topics.items() if topic.numbers}
    if not filled:
        why = "".join(f"; {note}" for note in notes)
        raise refusal(file, f"holds no message with numbers{why}")
    logs = [time for topic in filled.values() for time in topic.logged[:1] + topic.logged[-1:]]
    zero = min(logs) if zero is None else zero
    lasting = max(logs, default=zero) - min(logs, default=zero)
    columns: list[Column] = []
    times: list[Times] = []
    said = _wide_notes(topics)
    for name, topic in sorted(filled.items()):
        part = called(name)
        rows = len(topic.logged)
        many = in_part_only or rows > 1
        if not rows:
            columns.append(in_part("t [s]", np.empty(0), part))
        elif many:
            logged, stamps = _int64(topic.logged), _int64(topic.stamps)
            given = stamps if topic.unstamped < rows else None
            times.append(times_of(part, logged, given, zero, lasting))
            columns += _clocks(times[-1], part)
        for header, values in topic.numbers.items():
            known = np.full(rows, np.nan)
            known[: len(values)] = values
            wanted = known if many else known.reshape(())
            columns.append(in_part(header, wanted, part, _clash(header, part, file)))
    return Table(file, tuple(columns), (*notes, *time_notes(times), *said))


def _wide_notes(topics: Mapping[str, Topic]) -> list[str]:
    """Say which arrays are too long for channels."""
    wide = [f"{called(name)}.{one}" for name in sorted(topics) for one in sorted(topics[name].wide)]
    said = [f"{one} has more than {WIDEST} elements: left out" for one in wide[:MOST_NOTES]]
    more = len(wide) - MOST_NOTES
    return [*said, f"{more} more arrays are as long: left out"] if more > 0 else said


def _clocks(times: Times, part: str) -> Iterator[Column]:
    yield in_part("t [s]", times.t, part)
    if times.others is not None:
        yield in_part(f"{times.unused} [s]", times.others, part)


def _clash(header: str, part: str, file: str) -> Problem | None:
    """What is wrong with a field that is called as the times of its topic are."""
    if header.partition(" ")[0] not in CLOCKS:
        return None
    return Problem("is called as the time of its topic is", f"channel '{part}.{header}'", file)


def called(topic: str) -> str:
    """What a topic is called as a part of the file."""
    return topic.strip("/").replace("/", ".") or "root"


def _int64(values: "array[int]") -> NDArray[np.int64]:
    return np.array(values, dtype=np.int64)
