"""What is in a message of ROS 1 or ROS 2: its numbers by name, and its stamp.

rosbags parses definitions of messages, but writes a program out of each and runs it. Here the bytes
are walked along the parsed definition instead, so that nothing that stands in a file is executed.
Names are joined by dots and elements counted from 1 (``pose.position.x``, ``data.3``); the elements
of an array that stands beside one of as many names are called by them (``position.shoulder``), and
transforms by the frame that they place. Covariances and layouts are no channels.

ROS 1 packs values without gaps, little-endian. ROS 2 encodes as CDR (OMG formal/02-06-51, 15.3):
numbers aligned to their size behind a head of four bytes, of which the second says in which order.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from struct import Struct, error, unpack_from
from typing import Any

from symhyb.limits import STRUCTURES_DEEP

WIDEST = 64  # elements of an array that are channels; above that it is a picture or a map

HEADER = "std_msgs/msg/Header"
TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
_CODES = {
    "bool": "B",
    "byte": "B",
    "char": "B",
    "octet": "B",
    "int8": "b",
    "int16": "h",
    "int32": "i",
    "int64": "q",
    "uint8": "B",
    "uint16": "H",
    "uint32": "I",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
_NAMES = ("name", "names", "joint_names", "interface_names")  # fields that name other elements
_OWN_NAMES = ("child_frame_id",)  # fields that name the element they stand in

_NOTHING = "structure_needs_at_least_one_member"  # the byte that CDR has in place of no field

_TWIST = {"linear": "m/s", "angular": "rad/s"}
_MOTOR = dict.fromkeys(("position", "velocity", "effort"), "SI")
_POINT = {"positions": "SI", "velocities": "SI", "accelerations": "SI", "effort": "SI"}
UNITS: Mapping[str, Mapping[str, str]] = {
    "geometry_msgs/msg/Twist": _TWIST,
    "geometry_msgs/msg/Accel": {"linear": "m/s^2", "angular": "rad/s^2"},
    "geometry_msgs/msg/Wrench": {"force": "N", "torque": "N*m"},
    "geometry_msgs/msg/Pose": {"position": "m"},
    "geometry_msgs/msg/Transform": {"translation": "m"},
    "geometry_msgs/msg/PointStamped": {"point": "m"},
    "sensor_msgs/msg/Imu": {"angular_velocity": "rad/s", "linear_acceleration": "m/s^2"},
    "sensor_msgs/msg/JointState": _MOTOR,
    "sensor_msgs/msg/MagneticField": {"magnetic_field": "T"},
    "sensor_msgs/msg/FluidPressure": {"fluid_pressure": "Pa"},
    "sensor_msgs/msg/Temperature": {"temperature": "degC"},
    "sensor_msgs/msg/Range": {"range": "m"},
    "sensor_msgs/msg/BatteryState": {"voltage": "V", "current": "A"},
    "trajectory_msgs/msg/JointTrajectoryPoint": _POINT,
}
"""The units of fields, by the comments in their definitions (and REP 103); ``SI``: metres or
radians, as the joint turns or slides."""


class UnreadableError(Exception):
    """A message or its definition cannot be read; the text completes "topic x: …"."""


@dataclass(slots=True)
class Message:
    """The ``numbers`` of a message by name, behind some of which stands a unit in brackets; its
    ``stamp`` in ns, None without one; the names of arrays that are too ``wide``.

    ``called`` is the name that an element of an array gives itself, ``texts`` are the elements of
    the array of texts that was read last.
    """

    numbers: dict[str, float] = field(default_factory=dict)
    stamp: int | None = None
    wide: set[str] = field(default_factory=set)
    called: str = ""
    texts: Sequence[str] = ()


_Walk = Callable[[bytes, int, str, Sequence[str], Message], int]
"""Reads into a message what stands at a position of its bytes under a name, near names for the
elements of arrays; returns the position behind it."""


def decoder(msgtype: str, types: Mapping[str, Any], ros2: bool) -> Callable[[bytes], Message]:
    """What reads a message of type ``msgtype``, whose definition rosbags parsed into ``types``.

    Raises:
        UnreadableError: the definition is missing or cannot be read; the decoder, that a message
            does not fit it.
    """
    walks: dict[str, _Walk] = {}

    def decoded(data: bytes) -> Message:
        order = "<"
        if ros2:
            if len(data) < 4 or data[0] or data[1] not in (0, 1):
                raise UnreadableError("a message is not encoded as plain CDR")
            order, data = "><"[data[1]], data[4:]
        if order not in walks:
            walks[order] = _Definitions(types, order, ros2).walk(msgtype, "", 0)
        message = Message()
        try:
            walks[order](data, 0, "", (), message)
        except (error, IndexError, OverflowError):
            raise UnreadableError("a message is shorter than its definition says") from None
        return message

    walks["<"] = _Definitions(types, "<", ros2).walk(msgtype, "", 0)
    return decoded


@dataclass(frozen=True, slots=True)
class _Definitions:
    """Definitions by type, and how their values lie in memory."""

    types: Mapping[str, Any]
    order: str
    aligned: bool
    known: dict[tuple[str, str], _Walk] = field(default_factory=dict)

    def walk(self, msgtype: str, unit: str, depth: int) -> _Walk:
        """What walks through a message of that type, whose numbers have a ``unit``."""
        if depth > STRUCTURES_DEEP:
            raise UnreadableError("its type is nested too deeply")
        if msgtype in TIMES:
            return self._time(msgtype == TIMES[0])
        if msgtype not in self.types:
            raise UnreadableError(f"the file does not define its type {msgtype}")
        if (msgtype, unit) not in self.known:
            _, fields = self.types[msgtype]
            units = UNITS.get(msgtype, {})
            parts = []
            for name, description in fields:
                own = f" [{units[name]}]" if name in units else unit
                if name != _NOTHING:
                    walk = self._field(name, description, own, depth + 1)
                    parts.append((name, _aside(walk) if _describes(name, description) else walk))
            if self.aligned and not parts:
                parts.append((_NOTHING, _byte))
            made = _header(parts) if msgtype == HEADER else _structure(parts)
            self.known[msgtype, unit] = made
        return self.known[msgtype, unit]

    def _field(self, name: str, description: Any, unit: str, depth: int) -> _Walk:
        kind, inner = description[0].name, description[1]
        if kind == "BASE":
            return self._base(inner[0], unit, own=name in _OWN_NAMES)
        if kind == "NAME":
            return self.walk(inner, unit, depth)
        element, count = inner
        fixed = count if kind == "ARRAY" else None
        if element[0].name == "NAME":
            return self._structures(self.walk(element[1], unit, depth), fixed)
        if element[1][0] in ("string", "wstring"):
            return self._strings(element[1][0], fixed)
        return self._numbers(element[1][0], fixed, unit)

    def _base(self, kind: str, unit: str, own: bool) -> _Walk:
        if kind == "string":
            text = self._text()

            def read_text(
                data: bytes, at: int, name: str, near: Sequence[str], message: Message
            ) -> int:
                value, at = text(data, at)
                if own:
                    message.called = value
                return at

            return read_text
        size, unpack = self._number(kind)
        step = size if self.aligned else 1

        def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
            at += -at % step
            message.numbers[name + unit] = float(unpack(data, at)[0])
            return at + size

        return read

    def _number(self, kind: str) -> tuple[int, Callable[[bytes, int], tuple[Any, ...]]]:
        if kind not in _CODES:
            raise UnreadableError(f"it has a field of type {kind}, which is not read")
        struct = Struct(self.order + _CODES[kind])
        return struct.size, struct.unpack_from

    def _count(self) -> Callable[[bytes, int], tuple[int, int]]:
        _, unpack = self._number("uint32")
        step = 4 if self.aligned else 1

        def read(data: bytes, at: int) -> tuple[int, int]:
            at += -at % step
            return unpack(data, at)[0], at + 4

        return read

    def _text(self) -> Callable[[bytes, int], tuple[str, int]]:
        counted = self._count()

        def read(data: bytes, at: int) -> tuple[str, int]:
            size, at = counted(data, at)
            if at + size > len(data):
                raise IndexError
            return data[at : at + size].rstrip(b"\0").decode("utf-8", "replace"), at + size

        return read

    def _time(self, stamp: bool) -> _Walk:
        """A time in s; ROS 1 counts that of a clock without a sign."""
        struct = Struct(self.order + ("iI" if self.aligned or not stamp else "II"))
        step = 4 if self.aligned else 1

        def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
            at += -at % step
            seconds, rest = struct.unpack_from(data, at)
            message.numbers[f"{name} [s]"] = seconds + 1e-9 * rest
            if name == _STAMP:
                message.stamp = 1_000_000_000 * seconds + rest
            return at + struct.size

        return read

    def _numbers(self, kind: str, fixed: int | None, unit: str) -> _Walk:
        size, _ = self._number(kind)
        step = size if self.aligned else 1
        counted, code, order = self._count(), _CODES[kind], self.order

        def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
            count, at = (fixed, at) if fixed is not None else counted(data, at)
            if not count:
                return at
            at += -at % step
            end = at + size * count
            if end > len(data):
                raise IndexError
            if count > WIDEST:
                message.wide.add(name)
                return end
            values = unpack_from(f"{order}{count}{code}", data, at)
            headers = _headers(name, unit, count, tuple(near))
            message.numbers.update(zip(headers, map(float, values), strict=True))
            return end

        return read

    def _strings(self, kind: str, fixed: int | None) -> _Walk:
        if kind != "string":
            raise UnreadableError(f"it has a field of type {kind}, which is not read")
        counted, text = self._count(), self._text()

        def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
            count, at = (fixed, at) if fixed is not None else counted(data, at)
            if 4 * count > len(data) - at:
                raise IndexError
            texts = []
            for _ in range(count):
                value, at = text(data, at)
                texts.append(value)
            message.texts = texts
            return at

        return read

    def _structures(self, walk: _Walk, fixed: int | None) -> _Walk:
        counted = self._count()

        def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
            count, at = (fixed, at) if fixed is not None else counted(data, at)
            if count > len(data) - at:
                raise IndexError
            names = _elements(count, near)
            if count > WIDEST:
                message.wide.add(name)
            for index in range(count):
                element = Message()
                at = walk(data, at, "", (), element)
                if message.stamp is None:
                    message.stamp = element.stamp
                if count <= WIDEST:
                    called = element.called if _plain(element.called) else names[index]
                    message.wide |= {f"{name}.{called}.{one}" for one in element.wide}
                    for inner, value in element.numbers.items():
                        message.numbers[f"{name}.{called}.{inner}"] = value
            return at

        return read


_STAMP = "\0stamp"  # under this name the time of a header is walked, so that it is kept exactly


def _structure(parts: Sequence[tuple[str, _Walk]]) -> _Walk:
    """Walk one field after the other; a field of names calls the elements of those that follow."""
    named = [(name, f".{name}", walk, name in _NAMES) for name, walk in parts]

    def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
        for own, dotted, walk, names in named:
            if names:
                message.texts = ()
            at = walk(data, at, name + dotted if name else own, near, message)
            if names and message.texts:
                near = message.texts
        return at

    return read


def _describes(name: str, description: Any) -> bool:
    """Whether a field describes others, as covariances do, and is no channel."""
    return name.endswith("covariance") or description[1] == "std_msgs/msg/MultiArrayLayout"


def _aside(walk: _Walk) -> _Walk:
    """Walk over a field without a word about it."""

    def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
        return walk(data, at, name, (), Message())

    return read


def _byte(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
    return at + 1


def _header(parts: Sequence[tuple[str, _Walk]]) -> _Walk:
    """Walk a header, of which only the stamp is kept, and no number."""

    def read(data: bytes, at: int, name: str, near: Sequence[str], message: Message) -> int:
        inner = Message()
        for own, walk in parts:
            at = walk(data, at, _STAMP if own == "stamp" else own, (), inner)
        if message.stamp is None:
            message.stamp = inner.stamp
        return at

    return read


@lru_cache(maxsize=4096)
def _headers(name: str, unit: str, count: int, near: tuple[str, ...]) -> tuple[str, ...]:
    """What the channels of an array are called; the same from message to message."""
    return tuple(f"{name}.{called}{unit}" for called in _elements(count, near))


def _elements(count: int, near: Sequence[str]) -> Sequence[str]:
    """What the elements of an array are called: by as many names near it, else by numbers."""
    if len(near) == count and len(set(near)) == count and all(map(_plain, near)):
        return near
    return [str(number) for number in range(1, count + 1)]


def _plain(label: str) -> bool:
    """Whether a text can call a channel: no unit, and no more than a name."""
    return 0 < len(label) <= 64 and not set("[]()#@\n") & set(label)
